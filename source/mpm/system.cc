#include <stroma/grid/cell_scatter.h>
#include <stroma/mpm/system.h>

#include <deal.II/base/mpi.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/lac/trilinos_sparsity_pattern.h>

#include <limits>

namespace Stroma::Mpm
{
  namespace
  {
    template <int dim>
    double
    largest_component(const std::array<Solid::Lanes<dim>, dim> &u)
    {
      double largest = 0;
      for (const auto &lanes : u)
        for (unsigned int a = 0; a < (1u << dim); ++a)
          largest = std::max(largest, std::abs(lanes[a]));
      return largest;
    }
  } // namespace

  template <int dim>
  System<dim>::System(const Scene<dim> &scene, const Settings<dim> &settings, BackgroundGrid<dim> &grid,
                      Points<dim> &points, PrescribedMotion<dim> &motion, Timers &timers)
    : scene(scene)
    , settings(settings)
    , grid(grid)
    , points(points)
    , motion(motion)
    , timers(timers)
    , comm(scene.comm)
    , driven_reaction(scene.supports.size())
    , cell_points(points, grid, settings, scene.materials.size())
  {
    find_loads();
  }

  template <int dim>
  void
  System<dim>::rebuild()
  {
    const auto scope = timers.scope("unknowns");
    grid.distribute_unknowns(points.occupied_cells());
    motion.find_nodes(grid);
    list_cells();
    unbalanced.reinit(grid.owned, comm);
    if (!scene.loads.empty())
      external.reinit(grid.owned, comm);
    relevant_u.reinit(grid.owned, grid.relevant, comm);
    relevant_force.resize(grid.relevant.n_elements());
    grid.relevant.fill_index_vector(relevant_index);
    held_target.assign(motion.held().size(), 0.);
  }

  template <int dim>
  void
  System<dim>::list_cells()
  {
    cells.clear();
    std::vector<dealii::types::global_dof_index> dofs(dim * n_nodes);
    for (const auto &cell : grid.dofs.active_cell_iterators())
      if (cell->is_locally_owned() && grid.is_active(cell))
        {
          cell->get_dof_indices(dofs);
          ActiveCell active;
          active.cell    = cell;
          active.is_held = false;
          for (const auto dof : dofs)
            active.is_held |= motion.constraints().is_constrained(dof);
          for (unsigned int a = 0; a < n_nodes; ++a)
            active.node[a] = grid.relevant.index_within_set(dofs[a * dim]);
          cells.push_back(active);
        }
  }

  template <int dim>
  Vector
  System<dim>::new_vector() const
  {
    return Vector(grid.owned, comm);
  }

  template <int dim>
  void
  System<dim>::reinit_matrix(Matrix &K) const
  {
    dealii::TrilinosWrappers::SparsityPattern pattern(grid.owned, grid.owned, grid.relevant, comm);
    dealii::DoFTools::make_sparsity_pattern(grid.dofs, pattern, motion.constraints(), false,
                                            dealii::Utilities::MPI::this_mpi_process(comm));
    pattern.compress();
    K.reinit(pattern);
  }

  template <int dim>
  void
  System<dim>::find_loads()
  {
    const auto bodies = scene.bounding_box();
    for (const auto &load : scene.loads)
      {
        long double volume = 0; // resets change the order of the points and their ranks: no digit of a double may tell
        for (const auto &point : points.handler)
          {
            const auto numbers = point.get_properties();
            const auto X       = points.initial_place(point.get_location(), numbers.data());
            if (load.region.contains(X, points.material_of(numbers.data()), bodies))
              volume += numbers[points.volume.first];
          }
        volume = dealii::Utilities::MPI::sum(volume, comm);
        load_volume.push_back(volume);
        load_point.push_back(load.region.kind == Region<dim>::Kind::nearest ?
                               static_cast<long long>(points.nearest(load.region.first)) :
                               -1);
        if (load_point.back() < 0 && volume == 0)
          throw UserError(load.where, "load '" + load.name + "' (" + load.region.text +
                                        ") selects no material point; enlarge it or move it into the bodies");
      }
  }

  template <int dim>
  void
  System<dim>::set_time(const double t, const double t_rebase)
  {
    time             = t;
    const auto &held = motion.held();
    for (std::size_t i = 0; i < held.size(); ++i)
      held_target[i] = motion.motion_of(held[i], t, t_rebase);
    if (!scene.loads.empty())
      assemble_loads(t);
  }

  template <int dim>
  template <typename Visit>
  void
  System<dim>::for_each_load(const double t, const Visit &visit) const
  {
    const auto bodies = scene.bounding_box();
    for (const auto &active : cells)
      for (const auto &point : points.handler.particles_in_cell(active.cell))
        {
          const auto             numbers = point.get_properties();
          const auto             X       = points.initial_place(point.get_location(), numbers.data());
          const double           V0      = numbers[points.volume.first];
          dealii::Tensor<1, dim> force;
          for (std::size_t l = 0; l < scene.loads.size(); ++l)
            {
              const auto &load = scene.loads[l];
              if (load_point[l] == static_cast<long long>(point.get_id()))
                force += load.total.value(X, t);
              else if (load.region.contains(X, points.material_of(numbers.data()), bodies))
                force += load.density.given() ? V0 * load.density.value(X, t) :
                                                (V0 / load_volume[l]) * load.total.value(X, t);
            }
          visit(active, point, force);
        }
  }

  template <int dim>
  void
  System<dim>::assemble_loads(const double t)
  {
    // F_ext,g = sum_p S_gp F_ext,p (1)
    std::fill(relevant_force.begin(), relevant_force.end(), 0.);
    for_each_load(t, [&](const ActiveCell &active, const auto &point, const dealii::Tensor<1, dim> &force) {
      const LinearShape<dim> shape(point.get_reference_location(), dealii::Tensor<1, dim>());
      for (unsigned int a = 0; a < n_nodes; ++a)
        for (unsigned int c = 0; c < dim; ++c)
          relevant_force[active.node[a] + c] += shape.value[a] * force[c];
    });
    external = 0.;
    external.add(relevant_index, relevant_force);
    external.compress(dealii::VectorOperation::add);
  }

  template <int dim>
  StepStatus
  System<dim>::evaluate_stress(const CellPoints<dim> &p)
  {
    if (tau.size() < p.size)
      tau.resize(p.size);
    if (psi.size() < p.size)
      psi.resize(p.size);
    StepStatus status = StepStatus::ok;
    for (const auto &run : p.runs)
      {
        const unsigned int n = run.end - run.begin;
        status = worse(status, scene.materials[run.material]->evaluate({{p.F.data() + run.begin, n}},
                                                                       {{tau.data() + run.begin, n},
                                                                        {},
                                                                        {psi.data() + run.begin, n},
                                                                        {}}));
      }
    for (unsigned int q = 0; q < p.size; ++q)
      energy += p.V[q] * psi[q];
    return status;
  }

  template <int dim>
  StepStatus
  System<dim>::evaluate_tangent(const CellPoints<dim> &p)
  {
    if (tau.size() < p.size)
      tau.resize(p.size);
    if (Jc.size() < p.size)
      Jc.resize(p.size);
    StepStatus status = StepStatus::ok;
    for (const auto &run : p.runs)
      {
        const unsigned int n = run.end - run.begin;
        status = worse(status, scene.materials[run.material]->evaluate({{p.F.data() + run.begin, n}},
                                                                       {{tau.data() + run.begin, n},
                                                                        {Jc.data() + run.begin, n},
                                                                        {},
                                                                        {}}));
      }
    return status;
  }

  /// Internal forces of the points of a cell, from the stress evaluated last.
  template <int dim>
  void
  System<dim>::add_forces(const CellPoints<dim> &p)
  {
    if (!settings.projected)
      {
        for (unsigned int q = 0; q < p.size; ++q)
          kernel.add_force(p.V[q], tau[q], p.g[q]);
        return;
      }
    dilatation.begin(p.g_mean);
    for (unsigned int q = 0; q < p.size; ++q)
      {
        dilatation.take(p.V[q], tau[q]);
        kernel.add_force(p.V[q], dilatation.deviator(tau[q]), p.g[q]);
      }
    for (unsigned int c = 0; c < dim; ++c)
      kernel.add_nodal_force(1., c, dilatation.mean_force(c));
  }

  /// The same for the stiffness.
  template <int dim>
  void
  System<dim>::add_stiffness(const CellPoints<dim> &p)
  {
    if (settings.projected)
      {
        dilatation.begin(p.g_mean);
        for (unsigned int q = 0; q < p.size; ++q)
          dilatation.take(p.V[q], tau[q]);
        for (unsigned int q = 0; q < p.size; ++q)
          dilatation.split(p.V[q], p.g[q], tau[q], Jc[q]);
      }
    for (unsigned int q = 0; q < p.size; ++q)
      kernel.add_stiffness(p.V[q], tau[q], Jc[q], p.g[q]);
  }

  template <int dim>
  double
  System<dim>::spring(const CellPoints<dim> &p, const unsigned int q, const unsigned int material) const
  {
    const double h = smallest_side();
    return settings.penalty * scene.materials[material]->p_wave_modulus() * p.V[q] / (h * h);
  }

  template <int dim>
  double
  System<dim>::smallest_side() const
  {
    double h = grid.box().cell_size[0];
    for (unsigned int d = 1; d < dim; ++d)
      h = std::min(h, grid.box().cell_size[d]);
    return h;
  }

  /// Forces of a cell before anything in them cancels: of its modulus, since F = I + grad u is rounded to parts of I, of
  /// displacements whose differences make grad u, and of the stress. Round-off is a part of that.
  /// @param largest_u largest component of the displacement of its nodes [m]
  template <int dim>
  double
  System<dim>::summed_force(const CellPoints<dim> &p, const double largest_u) const
  {
    const double gradient = 2. / smallest_side(); // sum over nodes of |grad S|, at most
    double       sum      = 0;
    for (const auto &run : p.runs)
      {
        const double modulus = scene.materials[run.material]->p_wave_modulus() * (1. + gradient * largest_u);
        for (unsigned int q = run.begin; q < run.end; ++q)
          sum += p.V[q] * (modulus + tau[q].norm());
      }
    return gradient * sum;
  }

  template <int dim>
  dealii::Tensor<1, dim>
  System<dim>::driven_gap(const CellPoints<dim> &p, const unsigned int q, const unsigned int support,
                          const std::array<L, dim> &u) const
  {
    const auto  moved        = p.grid_displacement(q, u);
    const auto  X            = points.initial_place(p.location[q], p.values[q]);
    const auto &displacement = scene.supports[support].displacement;
    dealii::Tensor<1, dim> gap;
    for (unsigned int c = 0; c < dim; ++c)
      if (!displacement.is_free(c))
        {
          gap[c] = moved[c] - displacement.value(X, time, c);
          if (points.displacement.stored())
            gap[c] += p.values[q][points.displacement.first + c];
        }
    return gap;
  }

  template <int dim>
  template <typename Act>
  void
  System<dim>::for_driven(const CellPoints<dim> &p, const std::array<L, dim> &u, const Act &act) const
  {
    if (!points.support.stored())
      return;
    for (const auto &run : p.runs)
      for (unsigned int q = run.begin; q < run.end; ++q)
        if (const auto mask = static_cast<unsigned long long>(p.values[q][points.support.first]))
          for (unsigned int s = 0; s < scene.supports.size(); ++s)
            if (mask >> s & 1)
              act(q, s, spring(p, q, run.material), driven_gap(p, q, s, u));
  }

  template <int dim>
  StepStatus
  System<dim>::residual(Vector &r, const Vector &u)
  {
    const auto scope = timers.scope("residual");
    std::fill(relevant_force.begin(), relevant_force.end(), 0.);
    std::fill(driven_reaction.begin(), driven_reaction.end(), dealii::Tensor<1, dim>());
    energy = driven_gap_norm = 0.;
    double squares           = 0.; // of what cells sum up
    StepStatus status = for_each_cell(u, [&](const ActiveCell &active, const CellPoints<dim> &p, const auto &u_cell) {
      const StepStatus evaluated = evaluate_stress(p);
      kernel.clear();
      add_forces(p);
      const double largest_u = largest_component<dim>(u_cell);
      double       summed    = evaluated == StepStatus::ok ? summed_force(p, largest_u) : 0.;
      for_driven(p, u_cell, [&](const unsigned int q, const unsigned int s, const double k, const auto &gap) {
        for (unsigned int c = 0; c < dim; ++c)
          kernel.add_nodal_force(k * gap[c], c, p.shape[q].value);
        // gap = displacement - target
        double before = 0; // displacement at the last rebase
        if (points.displacement.stored())
          for (unsigned int c = 0; c < dim; ++c)
            before = std::max(before, std::abs(p.values[q][points.displacement.first + c]));
        summed += 2. * k * (largest_u + before + gap.norm());
        driven_reaction[s] -= k * gap;
        driven_gap_norm = std::max(driven_gap_norm, gap.norm());
      });
      for (unsigned int a = 0; a < n_nodes; ++a)
        for (unsigned int c = 0; c < dim; ++c)
          relevant_force[active.node[a] + c] -= kernel.force_at(a, c);
      squares += summed * summed;
      return evaluated;
    });
    status = reduce(status, comm);
    if (status != StepStatus::ok)
      return status;
    find_round_off(squares);

    unbalanced = 0.;
    unbalanced.add(relevant_index, relevant_force);
    unbalanced.compress(dealii::VectorOperation::add);
    internal_force_norm = unbalanced.l2_norm();
    if (!std::isfinite(internal_force_norm))
      return StepStatus::not_finite;
    if (!scene.loads.empty())
      unbalanced += external;
    r = unbalanced;
    for (const auto &held : motion.held())
      if (grid.owned.is_element(held.dof))
        r(held.dof) = 0.;
    r.compress(dealii::VectorOperation::insert);
    return StepStatus::ok;
  }

  template <int dim>
  void
  System<dim>::find_round_off(const double squares)
  {
    double summed = std::sqrt(dealii::Utilities::MPI::sum(squares, comm));
    if (!scene.loads.empty())
      summed += external.l2_norm();
    round_off_norm = std::numeric_limits<double>::epsilon() * summed;
  }

  template <int dim>
  StepStatus
  System<dim>::tangent(Matrix &K, Vector &r, const Vector &u)
  {
    const auto scope = timers.scope("stiffness");
    K                = 0.;
    relevant_u       = u;

    // The jump of held unknowns that do not have their prescribed value yet is lifted as an inhomogeneity.
    dealii::AffineConstraints<double> lifted(motion.constraints());
    const auto                       &held = motion.held();
    for (std::size_t i = 0; i < held.size(); ++i)
      lifted.set_inhomogeneity(held[i].dof,
                               held_target[i] - relevant_u.begin()[grid.relevant.index_within_set(held[i].dof)]);

    CellScatter<dim>                             scatter(K, grid.relevant);
    dealii::FullMatrix<double>                   K_cell(dim * n_nodes);
    dealii::Vector<double>                       zero(dim * n_nodes);
    std::vector<dealii::types::global_dof_index> dofs(dim * n_nodes);
    StepStatus status = for_each_cell(u, [&](const ActiveCell &active, const CellPoints<dim> &p, const auto &u_cell) {
      const StepStatus evaluated = evaluate_tangent(p);
      kernel.clear();
      add_stiffness(p);
      for_driven(p, u_cell, [&](const unsigned int q, const unsigned int s, const double k, const auto &) {
        for (unsigned int c = 0; c < dim; ++c)
          if (!scene.supports[s].displacement.is_free(c))
            kernel.add_spring_stiffness(k, c, p.shape[q].value);
      });
      kernel.finish_stiffness();
      kernel.copy_stiffness(K_cell);
      if (settings.projected)
        dilatation.add_stiffness(K_cell);
      if (!active.is_held && scatter.add(active.node, K_cell))
        return evaluated;
      for (unsigned int a = 0; a < n_nodes; ++a)
        for (unsigned int c = 0; c < dim; ++c)
          dofs[a * dim + c] = relevant_index[active.node[a] + c];
      lifted.distribute_local_to_global(K_cell, zero, dofs, K, r, true);
      return evaluated;
    });
    K.compress(dealii::VectorOperation::add);
    r.compress(dealii::VectorOperation::add);
    return reduce(status, comm);
  }

  template <int dim>
  std::vector<dealii::Tensor<1, dim>>
  System<dim>::reactions() const
  {
    auto total = driven_reaction;
    for (const auto &held : motion.held())
      if (grid.owned.is_element(held.dof))
        total[held.support][held.component] -= unbalanced(held.dof);
    for (auto &force : total)
      force = dealii::Utilities::MPI::sum(force, comm);
    return total;
  }

  template <int dim>
  double
  System<dim>::strain_energy() const
  {
    return dealii::Utilities::MPI::sum(energy, comm);
  }

  template <int dim>
  double
  System<dim>::largest_driven_gap() const
  {
    return dealii::Utilities::MPI::max(driven_gap_norm, comm);
  }

  template <int dim>
  bool
  System<dim>::stays_on_grid(const Vector &u)
  {
    int        outside = 0;
    const auto lower = grid.box().lower, upper = grid.box().upper();
    for_each_cell(u, [&](const ActiveCell &, const CellPoints<dim> &p, const auto &u_cell) {
      for (unsigned int q = 0; q < p.size; ++q)
        {
          const auto x = p.location[q] + p.grid_displacement(q, u_cell);
          for (unsigned int d = 0; d < dim; ++d)
            if (!(x[d] >= lower[d] && x[d] <= upper[d]))
              outside = 1;
        }
      return StepStatus::ok;
    });
    return dealii::Utilities::MPI::max(outside, comm) == 0;
  }

  template <int dim>
  double
  System<dim>::distortion(const Vector &u)
  {
    double largest = 0;
    for_each_cell(u, [&](const ActiveCell &, const CellPoints<dim> &p, const auto &) {
      for (unsigned int q = 0; q < p.size; ++q)
        largest = std::max(largest, (.5 * (transpose(p.F_D[q]) * p.F_D[q] -
                                           dealii::Tensor<2, dim>(dealii::unit_symmetric_tensor<dim>()))).norm());
      return StepStatus::ok;
    });
    return dealii::Utilities::MPI::max(largest, comm);
  }

  template <int dim>
  FreeParts<dim>
  System<dim>::free_parts(const ConnectedParts<dim> &parts, const double end_time) const
  {
    FreeParts<dim> free(scene, parts);
    for (const auto &active : cells)
      for (const auto &point : points.handler.particles_in_cell(active.cell))
        {
          free.add_cell(active.cell, points.material_of(point.get_properties().data()));
          break; // the cell's first stands for it
        }
    motion.hold(free.motions, parts, grid, points);
    free.find();
    free.check_loads(end_time, [&](const double t, const auto &add_force) {
      for_each_load(t, [&](const ActiveCell &active, const auto &point, const dealii::Tensor<1, dim> &force) {
        add_force(parts.piece_of(active.cell), point.get_location(), force);
      });
    });
    return free;
  }

  template <int dim>
  void
  System<dim>::rebase_points(const Vector &u, const bool move_locations)
  {
    for_each_cell(u, [&](const ActiveCell &active, const CellPoints<dim> &p, const auto &u_cell) {
      for (unsigned int q = 0; q < p.size; ++q)
        {
          const auto moved = p.grid_displacement(q, u_cell);
          for (unsigned int i = 0; i < dim; ++i)
            {
              p.values[q][points.displacement.first + i] += moved[i];
              for (unsigned int k = 0; k < dim; ++k)
                p.values[q][points.deformation.first + i * dim + k] = p.F[q][i][k];
            }
        }
      if (move_locations)
        for (auto &point : points.handler.particles_in_cell(active.cell))
          {
            const LinearShape<dim> shape(point.get_reference_location(), dealii::Tensor<1, dim>());
            auto                   x = point.get_location();
            for (unsigned int d = 0; d < dim; ++d)
              x[d] += Solid::sum<dim>(u_cell[d] * shape.value);
            point.set_location(x);
          }
      return StepStatus::ok;
    });
  }

  template <int dim>
  double
  System<dim>::emptiest_inner_cell() const
  {
    double cell_volume = dim == 2 ? scene.thickness : 1.;
    for (unsigned int d = 0; d < dim; ++d)
      cell_volume *= grid.box().cell_size[d];
    double least = 1;
    for (const auto &active : cells)
      {
        bool is_inner = true;
        for (const unsigned int f : active.cell->face_indices())
          is_inner &= !active.cell->at_boundary(f) && grid.is_active(active.cell->neighbor(f));
        double volume = 0;
        if (is_inner)
          for (const auto &point : points.handler.particles_in_cell(active.cell))
            {
              const auto             numbers = point.get_properties();
              dealii::Tensor<2, dim> F;
              for (unsigned int i = 0; i < dim; ++i)
                for (unsigned int k = 0; k < dim; ++k)
                  F[i][k] = numbers[points.deformation.first + i * dim + k];
              volume += numbers[points.volume.first] * determinant(F);
            }
        least = is_inner ? std::min(least, volume / cell_volume) : least;
      }
    return dealii::Utilities::MPI::min(least, comm);
  }

  template <int dim>
  std::vector<Vector>
  System<dim>::rigid_motions() const
  {
    constexpr unsigned int n_rotations = dim == 2 ? 1 : 3;
    std::vector<Vector>    motions(dim + n_rotations, new_vector());
    const auto             box    = grid.box();
    const auto             centre = box.lower + .5 * (box.upper() - box.lower);
    double                 length = 0;
    for (unsigned int d = 0; d < dim; ++d)
      length = std::max(length, box.upper()[d] - box.lower[d]);
    std::vector<dealii::types::global_dof_index> dofs(dim * n_nodes);
    for (const auto &active : cells)
      {
        active.cell->get_dof_indices(dofs);
        for (unsigned int a = 0; a < n_nodes; ++a)
          if (grid.owned.is_element(dofs[a * dim]))
            {
              const dealii::Tensor<1, dim> x = (active.cell->vertex(a) - centre) / length;
              for (unsigned int c = 0; c < dim; ++c)
                if (!motion.constraints().is_constrained(dofs[a * dim + c]))
                  motions[c](dofs[a * dim + c]) = 1.;
              for (unsigned int axis = 0; axis < n_rotations; ++axis)
                {
                  const unsigned int i = dim == 2 ? 0 : (axis + 1) % 3, j = dim == 2 ? 1 : (axis + 2) % 3;
                  if (!motion.constraints().is_constrained(dofs[a * dim + i]))
                    motions[dim + axis](dofs[a * dim + i]) = -x[j];
                  if (!motion.constraints().is_constrained(dofs[a * dim + j]))
                    motions[dim + axis](dofs[a * dim + j]) = x[i];
                }
            }
      }
    for (auto &m : motions)
      m.compress(dealii::VectorOperation::insert);
    return motions;
  }

  template class System<2>;
  template class System<3>;
} // namespace Stroma::Mpm
