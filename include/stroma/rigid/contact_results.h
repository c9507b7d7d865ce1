#pragma once

#include <deal.II/base/tensor.h>

#include <mpi.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace Stroma::Rigid
{
  /// What is told of a body's contact, summed up over the points of this rank that touch it.
  template <int dim>
  struct ContactResults
  {
    dealii::Tensor<1, dim>             force;     ///< on the body [N]
    double                             area = 0.; ///< [m^2]
    std::vector<std::array<double, 2>> profile;   ///< place along the surface [m] and pressure [Pa], point by point

    /// Of all ranks, named after the @p body: the force, the largest pressure, the area and (in the plane) half the width along
    /// x, 0 of less than two points. Near its edges p^2 falls linearly (Hertz): an edge is where it would be 0, by the last
    /// two points. Collective.
    std::vector<std::pair<std::string, double>> named(const std::string &body, MPI_Comm comm) const;
  };
} // namespace Stroma::Rigid
