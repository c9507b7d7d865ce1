#pragma once

#include <stroma/scene/scene.h>

#include <cstddef>

namespace Stroma::Scans
{
  /// The pieces that the material of an image falls into, all materials together: voxels that share faces.
  struct LoosePieces
  {
    std::size_t n = 0, n_loose = 0; ///< pieces, and those of them that touch no support
    double      share_loose = 0;    ///< of the material
  };

  /**
   * Counts the pieces of body @p b, an image, as a run sees them: with voxels merged. A piece touches a support if a corner
   * or the centre of one of its voxels lies in the support's region, or within half a voxel of its side or rim; or if it does so in
   * another body, which is taken to be held. Needs ITK. Local.
   */
  template <int dim>
  LoosePieces loose_pieces(const Scene<dim> &scene, unsigned int b);
} // namespace Stroma::Scans
