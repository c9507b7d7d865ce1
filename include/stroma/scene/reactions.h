#pragma once

#include <stroma/scene/scene.h>

#include <string>
#include <utility>
#include <vector>

namespace Stroma
{
  /**
   * The numbers of a series that follow from the supports, the same for every method: strain_y of a moved upper end,
   * reaction_NAME_y_N of each held component, and reaction_force_y_N, the magnitude at a held lower side.
   * @param reactions force by which each support holds the body, by support [N]
   */
  template <int dim>
  std::vector<std::pair<std::string, double>>
  reaction_scalars(const Scene<dim> &scene, const std::vector<dealii::Tensor<1, dim>> &reactions, double t);
} // namespace Stroma
