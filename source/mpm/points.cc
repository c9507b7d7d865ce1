#include <stroma/base/log.h>
#include <stroma/base/text.h>
#include <stroma/mpm/points.h>
#include <stroma/scene/rheology.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/mapping_q1.h>

#include <numeric>

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

    /// The places along one axis of a unit cell at which it gets points, and the edges between what they stand for.
    struct CellLattice
    {
      dealii::Quadrature<1> rule;
      std::vector<double>   edge{0.};

      CellLattice(const unsigned int n, const bool gauss)
        : rule(gauss ? dealii::Quadrature<1>(dealii::QGauss<1>(n)) : dealii::QIterated<1>(dealii::QMidpoint<1>(), n))
      {
        for (const double weight : rule.get_weights())
          edge.push_back(edge.back() + weight);
      }
    };

    /// A part of a cell below this part of what it could be holds no point of its own; the body's others make up for it.
    constexpr double sliver = 1e-3;

    /// Point @p i of a cell: its places, and the box that it stands for.
    template <int dim>
    struct CellSite
    {
      dealii::Point<dim> xi, X, lower, upper;
      double             V0; ///< [m^3]

      CellSite(const std::vector<CellLattice> &axes, unsigned int i, const dealii::Point<dim> &corner,
               const dealii::Tensor<1, dim> &cell_size, const double cell_volume)
        : V0(cell_volume)
      {
        for (unsigned int d = 0; d < dim; ++d)
          {
            const unsigned int k = i % axes[d].rule.size();
            i /= axes[d].rule.size();
            xi[d] = axes[d].rule.point(k)[0];
            V0 *= axes[d].rule.weight(k);
            X[d]     = corner[d] + xi[d] * cell_size[d];
            lower[d] = corner[d] + axes[d].edge[k] * cell_size[d];
            upper[d] = corner[d] + axes[d].edge[k + 1] * cell_size[d];
          }
      }
    };

    /// The whole of a site if it lies in an image's material, as finite elements take it, else nothing. Sets the material.
    template <int dim>
    BodyPart<dim>
    whole_site(const Scene<dim> &scene, const unsigned int b, const dealii::Point<dim> &X, const double size,
               std::optional<unsigned int> &m)
    {
      BodyPart<dim> part;
      m = scene.covered_by_later_body(b, X) ? std::nullopt : scene.bodies[b].material_at(X);
      if (m)
        part.whole = part.visible = size;
      return part;
    }
  } // namespace

  template <int dim>
  Points<dim>::Points(WithoutPoints, const Scene<dim> &scene, const Settings<dim> &settings, BackgroundGrid<dim> &grid,
                      const bool has_driven_points)
    : grid(grid)
    , grid_resets(settings.may_reset())
    , depth(dim == 2 ? scene.thickness : 1.)
  {
    if (!settings.finds_points_in_images(scene, has_driven_points))
      declare_fields(scene, settings, has_driven_points);
    handler.initialize(grid.triangulation, mapping<dim>(), layout.size());
  }

  template <int dim>
  Points<dim>::Points(const Scene<dim> &scene, const Settings<dim> &settings, BackgroundGrid<dim> &grid,
                      const bool has_driven_points)
    : Points(WithoutPoints(), scene, settings, grid, has_driven_points)
  {
    if (settings.finds_points_in_images(scene, has_driven_points))
      {
        find_in_images(scene, settings);
        return;
      }
    for (unsigned int b = 0; b < scene.bodies.size(); ++b)
      {
        if (scene.bodies[b].rigid)
          continue;
        const auto first_id  = next_id;
        const bool by_voxels = scene.bodies[b].is_image() && !settings.gauss_points;
        const auto filling   = by_voxels ? seed_voxels(scene, b, settings) : seed_shape(scene, b, settings);
        fill_exactly(scene, b, filling, first_id);
        check_filled(scene, b, count_by_material(scene, first_id));
      }
    handler.update_cached_numbers();
  }

  template <int dim>
  void
  Points<dim>::find_in_images(const Scene<dim> &scene, const Settings<dim> &settings)
  {
    occupied.assign(grid.triangulation.n_active_cells(), false);
    for (unsigned int b = 0; b < scene.bodies.size(); ++b)
      {
        if (scene.bodies[b].rigid)
          continue;
        images.emplace_back(scene, b, settings, grid.box(), depth);
        std::vector<std::size_t> n_points(scene.materials.size(), 0);
        grid.for_owned_cells([&](const auto &cell, const auto &index) {
          images.back().for_points_of_cell(index, [&](const auto &, const auto, const unsigned int m, const double) {
            ++n_points[m];
            occupied[cell->active_cell_index()] = true;
          });
        });
        n_in_images += std::accumulate(n_points.begin(), n_points.end(), std::size_t(0));
        check_filled(scene, b, n_points);
      }
  }

  template <int dim>
  unsigned long long
  Points<dim>::n_global() const
  {
    return are_found_in_images() ? dealii::Utilities::MPI::sum(static_cast<unsigned long long>(n_in_images),
                                                               grid.triangulation.get_communicator()) :
                                   handler.n_global_particles();
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
        if (is_viscous(scene))
          velocity_gradient = layout.declare("velocity gradient", "1/s", dim * dim);
      }
    if (settings.weighs_points())
      {
        sides  = layout.declare("sides", "m", dim);
        weight = layout.declare("weight", "", 1);
        if (!scene.loads.empty())
          load = layout.declare("load", "", 1);
      }
    if (const unsigned int n = n_history(scene); n > 0)
      history = layout.declare("history", "", n);
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
    if (weight.stored())
      values[weight.first] = 1.;
    return values;
  }

  /// A part of the box that a body's side cuts off leaves the point in the middle of the rest.
  template <int dim>
  void
  Points<dim>::set_sides(std::vector<double> &values, const dealii::Point<dim> &X, const dealii::Point<dim> &lower,
                         const dealii::Point<dim> &upper) const
  {
    for (unsigned int d = 0; d < dim && sides.stored(); ++d)
      values[sides.first + d] = 2. * std::min(X[d] - lower[d], upper[d] - X[d]);
  }

  /// Scales the body's points so that their volumes add up to its own: slivers and what sampling missed are made up for.
  template <int dim>
  void
  Points<dim>::fill_exactly(const Scene<dim> &scene, const unsigned int b, Filling filling,
                            const unsigned long long first_id)
  {
    for (double *volume : {&filling.whole, &filling.visible, &filling.held})
      *volume = dealii::Utilities::MPI::sum(*volume, scene.comm);
    if (!(filling.held > 0))
      return;
    const bool   is_image = scene.bodies[b].is_image();
    const double measured = is_image ? 1. : volume_of(scene.bodies[b]) / filling.whole;
    const double scale    = measured * filling.visible / filling.held;
    if (std::abs(scale - 1) < 1e-12)
      return;
    for (auto &point : handler)
      if (point.get_id() >= first_id)
        point.get_properties()[volume.first] *= scale;
  }

  template <int dim>
  std::vector<std::size_t>
  Points<dim>::count_by_material(const Scene<dim> &scene, const unsigned long long first_id) const
  {
    std::vector<std::size_t> n_points(scene.materials.size(), 0);
    for (const auto &point : handler)
      if (point.get_id() >= first_id)
        ++n_points[material_of(point.get_properties().data())];
    return n_points;
  }

  /// Every material of the body must hold points. A drawn body thinner than a cell is worth a word: it does not get lost, but
  /// its stiffness is mixed with that of its neighbours.
  template <int dim>
  void
  Points<dim>::check_filled(const Scene<dim> &scene, const unsigned int b,
                            const std::vector<std::size_t> &n_points) const
  {
    const Body<dim> &body     = scene.bodies[b];
    const bool       is_image = body.is_image();
    for (unsigned int m = 0; m < n_points.size(); ++m)
      {
        const bool must_be_there = is_image ? std::find(body.voxels.material.begin(), body.voxels.material.end(), m) !=
                                                body.voxels.material.end() :
                                              m == body.material;
        if (must_be_there && dealii::Utilities::MPI::max(n_points[m], scene.comm) == 0)
          throw UserError(body.where,
                          "body '" + body.name + "' holds no material point of '" + scene.material_names[m] +
                            "': later bodies cover it, or it lies between 'Gauss points'; change the order of "
                            "the bodies, or use more cells ('MPM/Cells') or points a cell");
      }
    const auto box = body.bounding_box();
    for (unsigned int d = 0; d < dim && !is_image && scene.bodies.size() > 1; ++d)
      if (const double h = grid.box().cell_size[d]; box.side_length(d) < (1 - 1e-9) * h)
        Log::warning("body '" + body.name + "' is " + brief(box.side_length(d)) + " m thick along " + "xyz"[d] +
                     ", less than a cell (" + brief(h) +
                     " m): cells mix its stiffness with that of its neighbours; use " + "at least " +
                     brief(std::ceil(2 * grid.box().n_cells[d] * h / box.side_length(d) - 1e-9)) +
                     " 'MPM/Cells' along " + "xyz"[d]);
  }

  template <int dim>
  typename Points<dim>::Filling
  Points<dim>::seed_voxels(const Scene<dim> &scene, const unsigned int b, const Settings<dim> &settings)
  {
    const auto             &box = grid.box();
    const VoxelLattice<dim> lattice(scene, b, settings, box, depth);
    Filling                 filling;
    std::size_t             count = 0; // first, so that memory is not doubled
    grid.for_owned_cells(
      [&](const auto &, const auto &index) { lattice.for_points_of_cell(index, [&](const auto &...) { ++count; }); });
    handler.reserve(handler.n_locally_owned_particles() + count);

    std::vector<std::vector<double>> values;
    for (unsigned int m = 0; m < scene.materials.size(); ++m)
      values.push_back(initial_values(0., m));
    grid.for_owned_cells([&](const auto &cell, const auto &index) {
      const dealii::Point<dim> corner = cell->vertex(0);
      lattice.for_points_of_cell(index, [&](const dealii::Point<dim> &X, const std::size_t number, const unsigned int m,
                                            const double V0) {
        values[m][volume.first] = V0;
        const auto part         = lattice.part_of_cell(X, cell->vertex(0), box.cell_size);
        set_sides(values[m], X, part.first, part.second);
        filling.held += V0 / depth;
        handler.insert_particle(X, unit_place(X, corner, box.cell_size),
                                static_cast<dealii::types::particle_index>(next_id + number), cell, values[m]);
      });
    });
    next_id += lattice.n_points();
    filling.whole = filling.visible = filling.held;
    return filling;
  }

  template <int dim>
  typename Points<dim>::Filling
  Points<dim>::seed_shape(const Scene<dim> &scene, const unsigned int b, const Settings<dim> &settings)
  {
    const auto              &box      = grid.box();
    const bool               is_image = scene.bodies[b].is_image();
    unsigned long long       n = 1, n_cells = 1;
    double                   cell_volume = depth;
    std::vector<CellLattice> axes;
    Filling                  filling;
    const double             body_volume = is_image ? 0. : volume_of(scene.bodies[b]);
    for (unsigned int d = 0; d < dim; ++d)
      {
        n *= settings.points_per_cell[d];
        n_cells *= box.n_cells[d];
        cell_volume *= box.cell_size[d];
        axes.emplace_back(settings.points_per_cell[d], settings.gauss_points);
      }
    grid.for_owned_cells([&](const auto &cell, const auto &) {
      const unsigned long long first = next_id + n * box.cell_number(cell->center());
      for (unsigned int i = 0; i < n; ++i)
        {
          CellSite<dim>               site(axes, i, cell->vertex(0), box.cell_size, cell_volume);
          const double                size = site.V0 / depth;
          std::optional<unsigned int> m    = scene.bodies[b].material;
          const auto                  part = is_image ? whole_site(scene, b, site.X, size, m) :
                                                        part_in(scene, b, site.lower, site.upper);
          filling.whole += part.whole;
          filling.visible += part.visible;
          if (!(part.visible > sliver * std::min(size, body_volume)))
            continue;
          if (part.visible < (1 - 1e-9) * size)
            {
              site.V0 = depth * part.visible;
              site.X  = part.centroid;
              site.xi = unit_place(site.X, dealii::Point<dim>(cell->vertex(0)), box.cell_size);
            }
          filling.held += part.visible;
          auto values = initial_values(site.V0, *m);
          set_sides(values, site.X, site.lower, site.upper);
          handler.insert_particle(site.X, site.xi, static_cast<dealii::types::particle_index>(first + i), cell, values);
        }
    });
    next_id += n_cells * n;
    return filling;
  }

  template <int dim>
  dealii::types::particle_index
  Points<dim>::nearest(const dealii::Point<dim> &X) const
  {
    const double tolerance = 1e-6 * grid.box().cell_size.norm();
    const auto   distance  = [&](const auto &point) {
      return initial_place(point.get_location(), point.get_properties().data()).distance(X);
    };
    const MPI_Comm comm  = grid.triangulation.get_communicator();
    double         least = std::numeric_limits<double>::max();
    for (const auto &point : handler)
      least = std::min(least, distance(point));
    least                               = dealii::Utilities::MPI::min(least, comm);
    dealii::types::particle_index found = nobody;
    for (const auto &point : handler)
      if (distance(point) <= least + tolerance)
        found = std::min(found, point.get_id());
    return dealii::Utilities::MPI::min(found, comm);
  }

  template <int dim>
  std::vector<bool>
  Points<dim>::occupied_cells() const
  {
    if (are_found_in_images())
      return occupied;
    std::vector<bool> holds_points(grid.triangulation.n_active_cells(), false);
    for (const auto &cell : grid.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        holds_points[cell->active_cell_index()] = handler.n_particles_in_cell(cell) > 0;
    return holds_points;
  }

  template <int dim>
  double
  Points<dim>::bytes_per_point() const
  {
    if (are_found_in_images())
      return sizeof(std::uint8_t);
    using Pool = dealii::Particles::PropertyPool<dim>;
    return 2 * sizeof(dealii::Point<dim>) + sizeof(dealii::types::particle_index) + sizeof(typename Pool::Handle) +
           layout.size() * sizeof(double);
  }

  template class Points<2>;
  template class Points<3>;
} // namespace Stroma::Mpm
