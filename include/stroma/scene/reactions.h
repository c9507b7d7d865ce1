#pragma once

#include <stroma/scene/scene.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace Stroma
{
  /**
   * The numbers of a series that follow from the supports, the same for every method: strain_y of a moved upper end,
   * reaction_NAME_y_N of each held component, and reaction_force_y_N, the magnitude at a held lower side.
   *
   * Of an upper end that moves with time along y also nominal_stress_y_Pa, the force by which it is held over the section of
   * the specimen's box at rest, positive in tension, and apparent_modulus_y_Pa, that over the strain (not a number where that is
   * 0). Of one that moves along x, across its axis y, the same in shear: shear_strain_xy, shear_stress_xy_Pa and
   * apparent_modulus_xy_Pa.
   * @param reactions force by which each support holds the body, by support [N]
   */
  template <int dim>
  std::vector<std::pair<std::string, double>>
  reaction_scalars(const Scene<dim> &scene, const std::vector<dealii::Tensor<1, dim>> &reactions, double t);

  /// The support that moves the upper end along @p axis in direction @p component with time; nullptr: none.
  template <int dim>
  const Support<dim> *driving_support(const Scene<dim> &scene, unsigned int axis, unsigned int component);

  /// Whether an upper end moves with time, so that there are an apparent modulus and a nominal stress.
  template <int dim>
  bool has_driven_end(const Scene<dim> &scene);

  /// Whether a number of reaction_scalars() has no value because nothing is strained: no result then, and nothing to warn of.
  bool is_modulus_at_rest(const std::string &name, double value);

  /// The specimen: edges of the box around all bodies that are not rigid, box_x_m and so on, and its section across
  /// each axis, section_x_m2, which in plane scenes is of their thickness.
  template <int dim>
  std::map<std::string, double> specimen_results(const Scene<dim> &scene);
} // namespace Stroma
