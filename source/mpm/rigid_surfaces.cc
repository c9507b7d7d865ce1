#include <stroma/base/log.h>
#include <stroma/mpm/rigid_surfaces.h>
#include <stroma/mpm/surface_places.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <limits>
#include <unordered_map>

namespace Stroma::Mpm
{
  namespace
  {
    /// Places on a surface along the side of a cell.
    constexpr double places_per_cell = 2.;

    /// Stiffness of the bond, over modulus times area over the side of a cell. Much more locks the cells that the surface cuts
    /// (of linear functions all their nodes then follow the body), much less lets the body slip.
    constexpr double bond = 100.;

    /// How far from the surface the material is looked for, over the side of a cell.
    constexpr double next_to = 1e-6;
  } // namespace

  template <int dim>
  RigidSurfaces<dim>::RigidSurfaces(const Scene<dim> &scene, const BackgroundGrid<dim> &grid, ActiveCells<dim> &cells)
    : scene(scene)
    , grid(grid)
    , cells(cells)
    , h(*std::min_element(grid.box().cell_size.begin_raw(), grid.box().cell_size.end_raw()))
    , force(scene.rigid_bodies.size())
    , torque(scene.rigid_bodies.size())
  {}

  template <int dim>
  void
  RigidSurfaces<dim>::rebuild()
  {
    springs.clear();
    if (scene.rigid_bodies.empty())
      return;
    const auto                                                &box = grid.box();
    std::unordered_map<std::uint64_t, const ActiveCell<dim> *> by_number;
    for (const auto &active : cells)
      by_number.emplace(box.cell_number(active.cell->center()), &active);
    std::vector<unsigned int> count(scene.rigid_bodies.size(), 0), n_beside(count); // of this rank; of all
    for (unsigned int b = 0; b < scene.rigid_bodies.size(); ++b)
      for (const auto &place : surface_places(scene.bodies[scene.rigid_bodies[b].body], h / places_per_cell))
        {
          const unsigned int       body     = scene.rigid_bodies[b].body;
          const dealii::Point<dim> outside  = place.X + next_to * h * place.normal;
          const dealii::Point<dim> inside   = place.X - next_to * h * place.normal;
          const auto               material = scene.material_at(outside);
          if (!material || scene.covered_by_later_body(body, inside))
            continue;
          ++n_beside[b];
          const auto found = box.contains(outside) ? by_number.find(box.cell_number(outside)) : by_number.end();
          if (found == by_number.end())
            continue;
          Spring spring{b, place.X, found->second, {}, 0.};
          spring.shapes    = cells.shapes(*spring.cell, box.place_in_cell(outside));
          spring.stiffness = bond * scene.materials[*material]->p_wave_modulus() * place.area *
                             (dim == 2 ? scene.thickness : 1.) / h;
          springs.push_back(spring);
          ++count[b];
        }
    dealii::Utilities::MPI::sum(count, scene.comm, count);
    for (unsigned int b = 0; b < scene.rigid_bodies.size(); ++b)
      if (count[b] == 0)
        throw UserError(scene.rigid_bodies[b].where,
                        "rigid body '" + scene.rigid_bodies[b].name + "' touches no material; move it or remove it");
      else if (count[b] < n_beside[b])
        Log::warning("rigid body '" + scene.rigid_bodies[b].name + "' is bonded to " + std::to_string(count[b]) +
                     " of " + std::to_string(n_beside[b]) +
                     " places of its surface that have material beside them: in the cells " +
                     "of the others there is no material point; use smaller 'MPM/Cells' or more 'MPM/Points per cell'");
  }

  /// Displacement of the material less that of the body; in stages that end before the step does from velocities, see
  /// Solvers::Stage.
  template <int dim>
  dealii::Tensor<1, dim>
  RigidSurfaces<dim>::gap(const Spring &spring, const Solvers::Motion &motion, const Solvers::Stage &stage) const
  {
    const auto &body = scene.rigid_bodies[spring.body];
    const auto  has  = cells.value(*spring.cell, spring.shapes, stage.is_last ? motion.u : motion.v);
    if (stage.is_last)
      return has - body.displacement(spring.X, stage.t);
    return (has - body.velocity(spring.X, stage.t, stage.dt / 1024.)) / stage.v_factor;
  }

  template <int dim>
  StepStatus
  RigidSurfaces<dim>::add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage)
  {
    std::fill(force.begin(), force.end(), dealii::Tensor<1, dim>());
    std::fill(torque.begin(), torque.end(), Rigid::Axial<dim>());
    squares = 0.;
    if (scene.rigid_bodies.empty())
      return StepStatus::ok;
    cells.add_nodal(r, [&](std::vector<double> &nodal) {
      for (const auto &spring : springs)
        {
          const auto   d = gap(spring, motion, stage);
          const double k = spring.stiffness;
          for (unsigned int a = 0; a < cells.n_nodes; ++a)
            for (unsigned int c = 0; c < dim; ++c)
              nodal[spring.cell->node[a] + c] -= k * d[c] * spring.shapes.value[a];
          force[spring.body] -= k * d;
          torque[spring.body] += Rigid::moment<dim>(scene.rigid_bodies[spring.body].pose(stage.t).arm(spring.X),
                                                    -k * d);
          squares += std::pow(2. * k * (cells.largest(*spring.cell, motion.u) + d.norm()), 2);
        }
    });
    return StepStatus::ok;
  }

  template <int dim>
  StepStatus
  RigidSurfaces<dim>::add_tangent(Matrix &K, Vector &r, const Solvers::Motion &, const Solvers::Stage &,
                                  const Solvers::Constraints &constraints)
  {
    if (scene.rigid_bodies.empty())
      return StepStatus::ok;
    typename ActiveCells<dim>::Assembly assembly(cells, K, r, constraints);
    dealii::FullMatrix<double>          K_cell(dim * cells.n_nodes);
    for (const auto &spring : springs)
      {
        for (unsigned int a = 0; a < cells.n_nodes; ++a)
          for (unsigned int b = 0; b < cells.n_nodes; ++b)
            for (unsigned int c = 0; c < dim; ++c)
              K_cell(a * dim + c, b * dim + c) = spring.stiffness * spring.shapes.value[a] * spring.shapes.value[b];
        assembly.add(*spring.cell, K_cell);
      }
    return StepStatus::ok;
  }

  template <int dim>
  double
  RigidSurfaces<dim>::round_off() const
  {
    return std::numeric_limits<double>::epsilon() * std::sqrt(dealii::Utilities::MPI::sum(squares, scene.comm));
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  RigidSurfaces<dim>::results(const double t) const
  {
    std::vector<std::pair<std::string, double>> all;
    for (unsigned int b = 0; b < scene.rigid_bodies.size(); ++b)
      {
        const auto &body = scene.rigid_bodies[b];
        for (const auto &result : body.results(body.pose(t), dealii::Utilities::MPI::sum(force[b], scene.comm),
                                               dealii::Utilities::MPI::sum(torque[b], scene.comm)))
          all.push_back(result);
      }
    return all;
  }

  template <int dim>
  void
  RigidSurfaces<dim>::add_reactions(std::vector<dealii::Tensor<1, dim>> &of_supports) const
  {
    for (unsigned int b = 0; b < scene.rigid_bodies.size(); ++b)
      if (const int support = scene.rigid_bodies[b].drive.support; support >= 0)
        of_supports[support] += force[b];
  }

  template <int dim>
  void
  RigidSurfaces<dim>::hold(RigidMotions<dim> &motions, const ConnectedParts<dim> &parts) const
  {
    for (const auto &spring : springs)
      for (unsigned int c = 0; c < dim; ++c)
        motions.hold(parts.piece_of(spring.cell->cell), spring.X, c);
  }

  template class RigidSurfaces<2>;
  template class RigidSurfaces<3>;
} // namespace Stroma::Mpm
