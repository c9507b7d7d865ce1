#include <stroma/base/memory.h>
#include <stroma/base/text.h>
#include <stroma/grid/lattice_multigrid.h>
#include <stroma/mpm/size.h>
#include <stroma/scene/rheology.h>
#include <stroma/scene/size.h>

#include <cmath>

namespace Stroma::Mpm
{
  template <int dim>
  bool
  check_size(const Scene<dim> &scene, const Settings<dim> &settings, const GridBox<dim> &box, const bool drives_points,
             const double assembled_up_to)
  {
    constexpr double per_empty_cell = 600.;
    // With its nodes' vectors: with one stiffness for all that are alike 1600 bytes in all on 512 x 512 x 52 cells.
    constexpr double of_kept_cell = 850.;
    const bool       found        = settings.finds_points_in_images(scene, drives_points);
    const double     per_point    = found ? 16. : // of the quantiles of stress
                                     64. + sizeof(double) * n_history(scene);
    const double     per_axis     = settings.shape_functions().per_axis; // nodes of a cell
    double           n_cells = 1., cell = 1., in_cell = 1., in_voxel = 1., n_nodes = 1.;
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
    const double coarser = LatticeMultigrid<dim>::n_coarser_cells(box) / n_cells;
    const bool   is_kept = dim * n_nodes * filled / n_cells > assembled_up_to;
    const auto   bytes   = [&](const bool shared) {
      const double of_cell = is_kept ?
                                   of_kept_cell + (coarser + (shared ? 0. : 1.)) * n_pairs * dim * dim * sizeof(float) :
                                   Memory::per_cell - per_empty_cell + dim * row * Memory::per_nonzero;
      return n_cells * per_empty_cell + filled * of_cell + n_points * per_point;
    };
    const bool shares = is_kept && found && settings.is_as_fine_as_images(scene, box) &&
                        !Memory::has_room(scene.comm, bytes(false));
    Memory::require(scene.comm, bytes(shares), settings.where_cells, what);
    return shares;
  }

  template bool check_size(const Scene<2> &, const Settings<2> &, const GridBox<2> &, bool, double);
  template bool check_size(const Scene<3> &, const Settings<3> &, const GridBox<3> &, bool, double);
} // namespace Stroma::Mpm
