#include <stroma/base/text.h>
#include <stroma/mpm/points.h>

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/mapping_q1.h>

namespace Stroma::Mpm
{
  namespace
  {
    template <int dim>
    const dealii::MappingQ1<dim> &
    mapping()
    {
      static const dealii::MappingQ1<dim> linear;
      return linear;
    }

    /// A regular row of places along one axis, and for each grid cell the range of those it owns.
    struct LatticeAxis
    {
      std::vector<double>       place;
      std::vector<unsigned int> first_of_cell; ///< size n_cells + 1

      template <int dim>
      LatticeAxis(const double start, const double spacing, const unsigned int n, const GridBox<dim> &box,
                  const unsigned int d)
        : place(n)
        , first_of_cell(box.n_cells[d] + 1, n)
      {
        std::vector<int> cell(n);
        for (unsigned int i = 0; i < n; ++i)
          {
            place[i] = start + (i + .5) * spacing;
            cell[i]  = box.cell_index(place[i], d);
          }
        for (unsigned int c = 0, i = 0; c <= box.n_cells[d]; ++c)
          {
            while (i < n && cell[i] < static_cast<int>(c))
              ++i;
            first_of_cell[c] = i;
          }
      }
    };

    template <int dim>
    std::array<unsigned int, 3>
    lattice_index(const GridBox<dim> &box, const dealii::Point<dim> &centre)
    {
      std::array<unsigned int, 3> index{{0, 0, 0}};
      for (unsigned int d = 0; d < dim; ++d)
        index[d] = box.cell_index(centre[d], d);
      return index;
    }

    template <int dim>
    dealii::Point<dim>
    unit_place(const dealii::Point<dim> &X, const dealii::Point<dim> &corner, const dealii::Tensor<1, dim> &size)
    {
      dealii::Point<dim> xi;
      for (unsigned int d = 0; d < dim; ++d)
        xi[d] = (X[d] - corner[d]) / size[d];
      return xi;
    }
  } // namespace

  template <int dim>
  Points<dim>::Points(WithoutPoints, const Scene<dim> &scene, const Settings<dim> &settings, BackgroundGrid<dim> &grid,
                      const bool has_driven_points)
    : grid(grid)
    , grid_resets(settings.may_reset())
    , depth(dim == 2 ? scene.thickness : 1.)
  {
    declare_fields(scene, settings, has_driven_points);
    handler.initialize(grid.triangulation, mapping<dim>(), layout.size());
  }

  template <int dim>
  Points<dim>::Points(const Scene<dim> &scene, const Settings<dim> &settings, BackgroundGrid<dim> &grid,
                      const bool has_driven_points)
    : Points(WithoutPoints(), scene, settings, grid, has_driven_points)
  {
    for (unsigned int b = 0; b < scene.bodies.size(); ++b)
      {
        if (scene.bodies[b].shape == Body<dim>::Shape::image && !settings.gauss_points)
          seed_voxels(scene, b, settings);
        else
          seed_shape(scene, b, settings);
        handler.update_cached_numbers();
      }
    if (handler.n_global_particles() == 0)
      throw UserError(scene.bodies.front().where, "the bodies hold no material point; use more cells or more points a cell");
  }

  template <int dim>
  void
  Points<dim>::declare_fields(const Scene<dim> &scene, const Settings<dim> &settings, const bool has_driven_points)
  {
    volume = layout.declare("volume", "m^3", 1);
    if (scene.materials.size() > 1)
      material = layout.declare("material", "", 1);
    if (settings.is_rebased())
      {
        deformation  = layout.declare("deformation gradient", "", dim * dim);
        displacement = layout.declare("displacement", "m", dim);
      }
    if (has_driven_points)
      support = layout.declare("support", "", 1);
  }

  template <int dim>
  std::vector<double>
  Points<dim>::initial_values(const double V0, const unsigned int material_index) const
  {
    std::vector<double> values(layout.size(), 0.);
    values[volume.first] = V0;
    if (material.stored())
      values[material.first] = material_index;
    if (deformation.stored())
      for (unsigned int d = 0; d < dim; ++d)
        values[deformation.first + d * (dim + 1)] = 1.;
    return values;
  }

  template <int dim>
  void
  Points<dim>::seed_voxels(const Scene<dim> &scene, const unsigned int b, const Settings<dim> &settings)
  {
    const VoxelMaterials       &voxels = scene.bodies[b].voxels;
    const auto                 &box    = grid.box();
    std::vector<LatticeAxis>    axes;
    std::array<unsigned int, 3> per_voxel{{1, 1, 1}}, n{{1, 1, 1}};
    double                      V0 = depth;
    for (unsigned int d = 0; d < dim; ++d)
      {
        per_voxel[d]         = settings.points_per_voxel[d];
        n[d]                 = voxels.size[d] * per_voxel[d];
        const double spacing = voxels.voxel_size[d] / per_voxel[d];
        axes.emplace_back(voxels.corner[d], spacing, n[d], box, d);
        V0 *= spacing;
      }

    // Visits the voxels of each owned cell: first to count them, then to insert them, so that memory is not doubled.
    const auto for_points_of_cell = [&](const std::array<unsigned int, 3> &c, const auto &visit) {
      const unsigned int z0 = dim == 3 ? axes[dim - 1].first_of_cell[c[2]] : 0;
      const unsigned int z1 = dim == 3 ? axes[dim - 1].first_of_cell[c[2] + 1] : 1;
      for (unsigned int z = z0; z < z1; ++z)
        for (unsigned int y = axes[1].first_of_cell[c[1]]; y < axes[1].first_of_cell[c[1] + 1]; ++y)
          for (unsigned int x = axes[0].first_of_cell[c[0]]; x < axes[0].first_of_cell[c[0] + 1]; ++x)
            {
              const auto m = voxels.at(x / per_voxel[0], y / per_voxel[1], z / per_voxel[2]);
              if (m == VoxelMaterials::empty)
                continue;
              const std::array<unsigned int, 3> index{{x, y, z}};
              dealii::Point<dim>                X;
              for (unsigned int d = 0; d < dim; ++d)
                X[d] = axes[d].place[index[d]];
              if (!scene.covered_by_later_body(b, X))
                visit(X, (std::size_t(z) * n[1] + y) * n[0] + x, m);
            }
    };

    std::size_t count = 0;
    for (const auto &cell : grid.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        for_points_of_cell(lattice_index(box, cell->center()), [&](const auto &, const auto, const auto) { ++count; });
    handler.reserve(handler.n_locally_owned_particles() + count);

    std::vector<std::vector<double>> values;
    for (unsigned int m = 0; m < scene.materials.size(); ++m)
      values.push_back(initial_values(V0, m));
    for (const auto &cell : grid.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          const dealii::Point<dim> corner = cell->vertex(0);
          for_points_of_cell(lattice_index(box, cell->center()),
                             [&](const dealii::Point<dim> &X, const std::size_t number, const unsigned int m) {
                               handler.insert_particle(X, unit_place(X, corner, box.cell_size),
                                                       static_cast<dealii::types::particle_index>(next_id + number),
                                                       cell, values[m]);
                             });
        }
    next_id += std::size_t(n[0]) * n[1] * n[2];
  }

  template <int dim>
  void
  Points<dim>::seed_shape(const Scene<dim> &scene, const unsigned int b, const Settings<dim> &settings)
  {
    const auto        &box = grid.box();
    unsigned long long n = 1, n_cells = 1;
    double             cell_volume = depth;
    std::vector<dealii::Quadrature<1>> axes;
    for (unsigned int d = 0; d < dim; ++d)
      {
        n *= settings.points_per_cell[d];
        n_cells *= box.n_cells[d];
        cell_volume *= box.cell_size[d];
        axes.push_back(settings.gauss_points ? dealii::Quadrature<1>(dealii::QGauss<1>(settings.points_per_cell[d])) :
                                               dealii::QIterated<1>(dealii::QMidpoint<1>(), settings.points_per_cell[d]));
      }
    for (const auto &cell : grid.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          const auto         index  = lattice_index(box, cell->center());
          unsigned long long number = index[2];
          for (int d = std::min(dim, 2) - 1; d >= 0; --d)
            number = number * box.n_cells[d] + index[d];
          for (unsigned int i = 0; i < n; ++i)
            {
              dealii::Point<dim> xi, X;
              unsigned int       rest = i;
              double             V0   = cell_volume;
              for (unsigned int d = 0; d < dim; ++d)
                {
                  xi[d] = axes[d].point(rest % axes[d].size())[0];
                  V0 *= axes[d].weight(rest % axes[d].size());
                  rest /= axes[d].size();
                  X[d] = cell->vertex(0)[d] + xi[d] * box.cell_size[d];
                }
              const auto m = scene.bodies[b].material_at(X);
              if (m && !scene.covered_by_later_body(b, X))
                handler.insert_particle(X, xi, static_cast<dealii::types::particle_index>(next_id + number * n + i),
                                        cell, initial_values(V0, *m));
            }
        }
    next_id += n_cells * n;
  }

  template <int dim>
  std::vector<bool>
  Points<dim>::occupied_cells() const
  {
    std::vector<bool> occupied(grid.triangulation.n_active_cells(), false);
    for (const auto &cell : grid.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        occupied[cell->active_cell_index()] = handler.n_particles_in_cell(cell) > 0;
    return occupied;
  }

  template <int dim>
  double
  Points<dim>::bytes_per_point() const
  {
    using Pool = dealii::Particles::PropertyPool<dim>;
    return 2 * sizeof(dealii::Point<dim>) + sizeof(dealii::types::particle_index) + sizeof(typename Pool::Handle) +
           layout.size() * sizeof(double);
  }

  template class Points<2>;
  template class Points<3>;
} // namespace Stroma::Mpm
