#include <stroma/base/memory.h>
#include <stroma/scene/size.h>
#include <stroma/sph/size.h>

#include <cmath>

namespace Stroma::Sph
{
  template <int dim>
  void
  check_size(const Scene<dim> &scene, const Settings &settings, const bool inertial)
  {
    // Bytes of a particle with its pairs, and with inertia's lack the friction system with multigrid: measured on 2,500 to
    // 40,000 particles in 2D, 1,000 to 15,600 in 3D, with the default kernel.
    const double per_particle = dim == 2 ? (inertial ? 2100. : 4200.) : (inertial ? 6000. : 12500.);
    const double n            = estimated_volume(scene) / std::pow(settings.arrangement.spacing, dim);
    const auto  &where        = settings.arrangement.where_spacing;
    const auto   what         = "about " + Memory::about(n) + " particles";
    Memory::require_indices(dim * n, where, what);
    Memory::require(scene.comm, n * per_particle, where, what);
  }

  template void check_size(const Scene<2> &, const Settings &, bool);
  template void check_size(const Scene<3> &, const Settings &, bool);
} // namespace Stroma::Sph
