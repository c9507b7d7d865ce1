#include <stroma/mpm/voxel_lattice.h>

#include <cmath>

namespace Stroma::Mpm
{
  template <int dim>
  LatticeAxis::LatticeAxis(const double start, const double spacing, const unsigned int n, const GridBox<dim> &box,
                           const unsigned int d)
    : first_of_cell(box.n_cells[d] + 1)
  {
    std::vector<int> cell;
    const auto       add = [&](const unsigned int of, const double place, const double length) {
      interval.push_back({of, place, length});
      cell.push_back(box.cell_index(place, d));
    };
    const double least = .01 * spacing; // what a face cuts off at least
    for (unsigned int i = 0; i < n; ++i)
      {
        double       lower = start + i * spacing;
        const double upper = start + (i + 1) * spacing;
        bool         whole = true;
        for (double k = std::ceil((lower + least - box.lower[d]) / box.cell_size[d]);; ++k)
          {
            const double face = box.lower[d] + k * box.cell_size[d];
            if (!(face < upper - least))
              break;
            add(i, .5 * (lower + face), face - lower);
            lower = face;
            whole = false;
          }
        if (whole)
          add(i, start + (i + .5) * spacing, spacing);
        else
          add(i, .5 * (lower + upper), upper - lower);
      }
    for (unsigned int c = 0, i = 0; c <= box.n_cells[d]; ++c)
      {
        while (i < interval.size() && cell[i] < static_cast<int>(c))
          ++i;
        first_of_cell[c] = i;
      }
  }

  template <int dim>
  VoxelLattice<dim>::VoxelLattice(const Scene<dim> &scene, const unsigned int b, const Settings<dim> &settings,
                                  const GridBox<dim> &box, const double depth)
    : scene(scene)
    , b(b)
    , depth(depth)
    , voxels(scene.bodies[b].voxels)
    , is_last(b + 1 == scene.bodies.size())
  {
    for (unsigned int d = 0; d < dim; ++d)
      {
        per_voxel[d] = settings.points_per_voxel[d];
        axes.emplace_back(voxels.corner[d], voxels.voxel_size[d] / per_voxel[d], voxels.size[d] * per_voxel[d], box, d);
        n[d] = axes[d].interval.size();
      }
  }

  template <int dim>
  std::pair<dealii::Point<dim>, dealii::Point<dim>>
  VoxelLattice<dim>::part_of_cell(const dealii::Point<dim> &X, const dealii::Point<dim> &corner,
                                  const dealii::Tensor<1, dim> &cell_size) const
  {
    std::pair<dealii::Point<dim>, dealii::Point<dim>> part;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double spacing = voxels.voxel_size[d] / per_voxel[d];
        const double lower   = voxels.corner[d] + std::floor((X[d] - voxels.corner[d]) / spacing) * spacing;
        part.first[d]        = std::max(lower, corner[d]);
        part.second[d]       = std::min(lower + spacing, corner[d] + cell_size[d]);
      }
    return part;
  }

  template class VoxelLattice<2>;
  template class VoxelLattice<3>;
} // namespace Stroma::Mpm
