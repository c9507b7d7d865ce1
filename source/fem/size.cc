#include <stroma/base/memory.h>
#include <stroma/fem/size.h>
#include <stroma/scene/size.h>

#include <cmath>

namespace Stroma::Fem
{
  template <int dim>
  void
  check_size(const Scene<dim> &scene, const Settings<dim> &settings, const double n_cells, const std::string &where)
  {
    // Per cell p^dim nodes, of which each meets (p + 2)^dim on the average.
    const double p = settings.degree, unknowns = dim * n_cells * std::pow(p, dim), row = dim * std::pow(p + 2., dim);
    const auto   what = "a mesh of about " + Memory::about(n_cells) + " cells of degree " +
                      std::to_string(settings.degree) + " (" + Memory::about(unknowns) + " unknowns)";
    Memory::require_indices(unknowns, where, what);
    Memory::require(scene.comm, n_cells * Memory::per_cell + unknowns * row * Memory::per_nonzero, where, what);
  }

  template <int dim>
  void
  check_size(const Scene<dim> &scene, const Settings<dim> &settings)
  {
    double n_cells = 1.;
    for (const unsigned int n : settings.cells)
      n_cells *= n;
    bool drawn_to_fit = true; // rings and the like are filled by all cells
    for (const auto &body : scene.bodies)
      if (body.is_image() || body.is_box())
        drawn_to_fit = false;
    if (!drawn_to_fit)
      n_cells *= std::min(1., estimated_volume(scene) / scene.bounding_box().volume());
    for (unsigned int cycle = 0; cycle < settings.error_cycles && n_cells < 1e18; ++cycle)
      n_cells *= 1. + ((1 << dim) - 1) * settings.error_fraction;
    check_size(scene, settings, n_cells, settings.where_cells);
  }

  template void check_size(const Scene<2> &, const Settings<2> &, double, const std::string &);
  template void check_size(const Scene<3> &, const Settings<3> &, double, const std::string &);
  template void check_size(const Scene<2> &, const Settings<2> &);
  template void check_size(const Scene<3> &, const Settings<3> &);
} // namespace Stroma::Fem
