#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

#include <array>

namespace Stroma::Output
{
  /// A place in space, z = 0 in two dimensions [m].
  using Place = std::array<double, 3>;

  /**
   * What is known of a place in the material in the committed state of a method: a material point, a particle, a
   * quadrature point, or any place that was asked for. What a method does not know stays as it is here. Vectors and
   * gradients of plane scenes fill the first two components; stresses are those in space.
   */
  struct PointState
  {
    Place                         X{};                    ///< undeformed [m]; of fluids that now
    Place                         x{};                    ///< now [m]
    dealii::Tensor<1, 3>          u, v;                   ///< displacement since the start [m], velocity [m/s]
    dealii::Tensor<2, 3>          u_gradient, v_gradient; ///< over the undeformed place; over the place now [1/s]
    double                        stretch_z = 1.;         ///< F_33 of plane scenes; 1 in plane strain
    dealii::SymmetricTensor<2, 3> cauchy;                 ///< stress [Pa]
    double                        pressure   = 0.; ///< of solids -tr/3 of the stress, of fluids that of its state [Pa]
    double                        V0         = 0.; ///< undeformed volume that the point stands for [m^3]
    double                        J          = 1.; ///< volume now over V0
    double                        density    = 0.; ///< now [kg/m^3]
    double                        kernel_sum = 0.; ///< of particles
    double                        intact     = 1.; ///< degradation factor f: 1 solid, 0 fluid
    unsigned int                  material   = 0;  ///< index into the scene's materials
    unsigned int                  cell       = 0;  ///< active_cell_index of the grid's cell, where there is one
    bool                          is_fixed   = false; ///< a particle of a wall, which is no material
  };

  /// A vector or gradient of @p dim dimensions as PointState has it.
  template <int dim>
  dealii::Tensor<1, 3>
  in_space(const dealii::Tensor<1, dim> &a)
  {
    dealii::Tensor<1, 3> result;
    for (unsigned int i = 0; i < dim; ++i)
      result[i] = a[i];
    return result;
  }

  template <int dim>
  dealii::Tensor<2, 3>
  in_space(const dealii::Tensor<2, dim> &a)
  {
    dealii::Tensor<2, 3> result;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = 0; j < dim; ++j)
        result[i][j] = a[i][j];
    return result;
  }

  template <int dim>
  Place
  place_of(const dealii::Point<dim> &X)
  {
    Place place{};
    for (unsigned int d = 0; d < dim; ++d)
      place[d] = X[d];
    return place;
  }

  template <int dim>
  dealii::Point<dim>
  point_of(const Place &X)
  {
    dealii::Point<dim> point;
    for (unsigned int d = 0; d < dim; ++d)
      point[d] = X[d];
    return point;
  }
} // namespace Stroma::Output
