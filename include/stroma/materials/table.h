#pragma once

#include <stroma/materials/material.h>

#include <memory>

namespace Stroma
{
  class Parameters;
}

namespace Stroma::Materials
{
  /**
   * Reads a material from the current section: the entry `Law` and the entries of the chosen law.
   * @param plane how a two-dimensional scene treats the third direction; PlaneModel::strain in three dimensions
   * Throws UserError for an unknown law or unusable constants.
   */
  std::unique_ptr<Material> create(Parameters &p, PlaneModel plane);
} // namespace Stroma::Materials
