#pragma once

#include <stroma/materials/material.h>
#include <stroma/solid/moments.h>

#include <array>
#include <optional>
#include <vector>

namespace Stroma::Solid
{
  /// Where two materials meet inside a cell: a plane, by its undeformed normal, at which the deformation gradient jumps.
  template <int dim>
  struct Interface
  {
    dealii::Tensor<1, dim> normal; ///< N, of length 1
    /// s_m by material: F_m = F + s_m a (x) N, so that the mean of F over the cell is that of its nodes.
    std::vector<double> side;
  };

  /**
   * The interface in a cell, from the moments of each material's points there [m]; none if there are not two materials.
   *
   * N is the direction between the two materials' centroids or, where one lies around the other, the one along which they
   * spread most differently. Of more than two materials the two with the largest volumes are told apart, and each other one
   * goes to the side whose stiffness is nearer to its own.
   * @param size of the cell [m]
   */
  template <int dim>
  std::optional<Interface<dim>> find_interface(const std::vector<Moments<dim>>                &moments,
                                               const std::vector<const Materials::Material *> &laws,
                                               const dealii::Tensor<1, dim>                   &size);
} // namespace Stroma::Solid
