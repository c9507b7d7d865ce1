#pragma once

#include <stroma/scene/scene.h>

#include <string>
#include <vector>

namespace Stroma
{
  /// What a scene may say but is rarely meant, a sentence each: materials of no body, bodies apart from each other in a specimen
  /// that is strained, densities in other units than those of the file. The same on all ranks.
  template <int dim>
  std::vector<std::string> doubts(const Scene<dim> &scene);
} // namespace Stroma
