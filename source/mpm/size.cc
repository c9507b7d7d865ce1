#include <stroma/base/memory.h>
#include <stroma/base/text.h>
#include <stroma/mpm/size.h>
#include <stroma/scene/rheology.h>
#include <stroma/scene/size.h>

#include <cmath>

namespace Stroma::Mpm
{
  template <int dim>
  void
  check_size(const Scene<dim> &scene, const Settings<dim> &settings, const GridBox<dim> &box, const bool drives_points,
             const double assembled_up_to)
  {
    constexpr double per_empty_cell = 600.;
    constexpr double of_kept_cell   = 1400.; // with its nodes' vectors
    constexpr double coarser        = 1.9;   // grids of a hierarchy together over the finest, where cells are flat
    const double per_point = settings.finds_points_in_images(scene, drives_points) ? 16. : // of the quantiles of stress
                               64. + sizeof(double) * n_history(scene);
    const double per_axis  = settings.shape_functions().per_axis; // nodes of a cell
    double       n_cells = 1., cell = 1., in_cell = 1., in_voxel = 1., n_nodes = 1.;
    for (unsigned int d = 0; d < dim; ++d)
      {
        n_cells *= box.n_cells[d];
        n_nodes *= box.n_cells[d] + per_axis - 1.;
        cell *= box.cell_size[d];
        in_cell *= settings.points_per_cell[d];
        in_voxel *= settings.points_per_voxel[d];
      }
    const double filled   = std::min(n_cells, estimated_volume(scene) / cell);
    double       n_points = filled * in_cell;
    for (const auto &body : scene.bodies)
      if (body.is_image() && !settings.gauss_points)
        n_points = static_cast<double>(body.voxels.material.size()) * in_voxel;
    const std::string what = "a grid of " + brief(n_cells) + " cells with about " + Memory::about(n_points) +
                             " material points";
    Memory::require_indices(dim * n_nodes, settings.where_cells, what);
    const double row     = dim * std::pow(2. * per_axis - 1., dim),
                 n_pairs = std::pow(2., dim) * (std::pow(2., dim) - 1.) / 2.;
    const double of_cell = dim * n_nodes * filled / n_cells > assembled_up_to ?
                             of_kept_cell + coarser * n_pairs * dim * dim * sizeof(float) :
                             Memory::per_cell - per_empty_cell + dim * row * Memory::per_nonzero;
    Memory::require(scene.comm, n_cells * per_empty_cell + filled * of_cell + n_points * per_point,
                    settings.where_cells, what);
  }

  template void check_size(const Scene<2> &, const Settings<2> &, const GridBox<2> &, bool, double);
  template void check_size(const Scene<3> &, const Settings<3> &, const GridBox<3> &, bool, double);
} // namespace Stroma::Mpm
