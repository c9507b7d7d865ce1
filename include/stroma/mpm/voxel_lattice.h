#pragma once

#include <stroma/mpm/settings.h>
#include <stroma/scene/body_part.h>

namespace Stroma::Mpm
{
  /// A regular row of intervals along one axis, cut where faces of grid cells pass through them, and for each cell the
  /// range of those it owns. Each stands for a point in its middle.
  struct LatticeAxis
  {
    struct Interval
    {
      unsigned int of; ///< number in the row before it was cut
      double       place, length;
    };
    std::vector<Interval>     interval;
    std::vector<unsigned int> first_of_cell; ///< size n_cells + 1

    template <int dim>
    LatticeAxis(double start, double spacing, unsigned int n, const GridBox<dim> &box, unsigned int d);
  };

  /// The places of an image's points: some a voxel, those that faces of cells cut doubled.
  template <int dim>
  class VoxelLattice
  {
  public:
    /// @param depth thickness of plane scenes, else 1
    VoxelLattice(const Scene<dim> &scene, unsigned int b, const Settings<dim> &settings, const GridBox<dim> &box,
                 double depth);

    std::size_t
    n_points() const
    {
      return std::size_t(n[0]) * n[1] * n[2];
    } ///< those in empty voxels included

    /// Corners of the part of a cell, from @p corner on, that the point at @p X stands for.
    std::pair<dealii::Point<dim>, dealii::Point<dim>> part_of_cell(const dealii::Point<dim>     &X,
                                                                   const dealii::Point<dim>     &corner,
                                                                   const dealii::Tensor<1, dim> &cell_size) const;

    /// Calls @p visit(place, number, material, volume) for those in cell @p c that hold material.
    template <typename Visit>
    void for_points_of_cell(const std::array<unsigned int, dim> &c, const Visit &visit) const;

  private:
    template <typename Visit>
    void visit_row(const std::array<unsigned int, dim> &c, unsigned int y, unsigned int z, const Visit &visit) const;
    template <typename Visit>
    void visit_covered(const dealii::Point<dim> &X, const std::array<unsigned int, 3> &index, unsigned int m, double V0,
                       const Visit &visit) const;

    /// A part of a voxel below this part of it holds no point of its own; the body's others make up for it.
    static constexpr double sliver = 1e-3;

    const Scene<dim>           &scene;
    const unsigned int          b;
    const double                depth;
    const VoxelMaterials       &voxels;
    const bool                  is_last;
    std::vector<LatticeAxis>    axes;
    std::array<unsigned int, 3> per_voxel{{1, 1, 1}}, n{{1, 1, 1}};
  };

  template <int dim>
  template <typename Visit>
  void
  VoxelLattice<dim>::for_points_of_cell(const std::array<unsigned int, dim> &c, const Visit &visit) const
  {
    const unsigned int z0 = dim == 3 ? axes[dim - 1].first_of_cell[c[dim - 1]] : 0;
    const unsigned int z1 = dim == 3 ? axes[dim - 1].first_of_cell[c[dim - 1] + 1] : 1;
    for (unsigned int z = z0; z < z1; ++z)
      for (unsigned int y = axes[1].first_of_cell[c[1]]; y < axes[1].first_of_cell[c[1] + 1]; ++y)
        visit_row(c, y, z, visit);
  }

  template <int dim>
  template <typename Visit>
  void
  VoxelLattice<dim>::visit_row(const std::array<unsigned int, dim> &c, const unsigned int y, const unsigned int z,
                               const Visit &visit) const
  {
    std::array<unsigned int, 3> index{{0, y, z}}, voxel{{0, 0, 0}};
    dealii::Point<dim>          X;
    std::array<double, 3>       length{{1., 1., 1.}};
    for (unsigned int d = 1; d < dim; ++d)
      {
        const auto &interval = axes[d].interval[index[d]];
        voxel[d]             = interval.of / per_voxel[d];
        X[d]                 = interval.place;
        length[d]            = interval.length;
      }
    const std::uint8_t *const row = &voxels
                                       .material[(std::size_t(voxel[2]) * voxels.size[1] + voxel[1]) * voxels.size[0]];
    for (unsigned int x = axes[0].first_of_cell[c[0]]; x < axes[0].first_of_cell[c[0] + 1]; ++x)
      {
        const auto        &interval = axes[0].interval[x];
        const std::uint8_t m        = row[interval.of / per_voxel[0]];
        if (m == VoxelMaterials::empty)
          continue;
        const double V0 = depth * interval.length * length[1] * length[2];
        index[0]        = x;
        X[0]            = interval.place;
        if (is_last)
          visit(X, (std::size_t(z) * n[1] + y) * n[0] + x, static_cast<unsigned int>(m), V0);
        else
          visit_covered(X, index, m, V0, visit);
      }
  }

  /// Where later bodies may cover a part of it.
  template <int dim>
  template <typename Visit>
  void
  VoxelLattice<dim>::visit_covered(const dealii::Point<dim> &X, const std::array<unsigned int, 3> &index,
                                   const unsigned int m, const double V0, const Visit &visit) const
  {
    dealii::Tensor<1, dim> half; // of its edges
    for (unsigned int d = 0; d < dim; ++d)
      half[d] = .5 * axes[d].interval[index[d]].length;
    const auto part = part_in(scene, b, dealii::Point<dim>(X - half), X + half);
    if (part.visible > sliver * part.whole)
      visit(X, (std::size_t(index[2]) * n[1] + index[1]) * n[0] + index[0], m,
            part.visible < (1 - 1e-9) * part.whole ? depth * part.visible : V0);
  }
} // namespace Stroma::Mpm
