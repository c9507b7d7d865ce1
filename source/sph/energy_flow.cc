#include <stroma/sph/energy_flow.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace Stroma::Sph
{
  using dealii::Tensor;

  template <int dim>
  EnergyFlow<dim>::EnergyFlow(const System<dim> &system)
    : system(system)
  {
    for (unsigned int m = 0; m < system.movers.size(); ++m)
      is_given.push_back(moves_as_given(m));
    any_given = std::find(is_given.begin(), is_given.end(), 1) != is_given.end();
  }

  template <int dim>
  bool
  EnergyFlow<dim>::moves_as_given(const unsigned int m) const
  {
    const auto &mover = system.movers[m];
    if (!mover.rigid)
      return mover.moves;
    return mover.rigid->drive.any(Rigid::DrivenBy::displacement) || mover.rigid->drive.any(Rigid::DrivenBy::velocity);
  }

  template <int dim>
  void
  EnergyFlow<dim>::take_state(const Velocities &force, const Velocities &v)
  {
    of_state = force;
    before   = v;
    if (!any_given)
      return;
    of_walls.clear();
    for (unsigned int i = 0; i < force.size(); ++i)
      system.visit_state_forces_of_walls(i, [&](const std::size_t p, const Tensor<1, dim> &stress) {
        if (is_given[system.mover_of(p)])
          of_walls.push_back(stress);
      });
  }

  template <int dim>
  void
  EnergyFlow<dim>::take_bodies(const std::vector<double> &loads, const std::vector<double> &resisting,
                               const std::vector<double> &q_before, const std::vector<double> &q_after, const double dt)
  {
    if (dealii::Utilities::MPI::this_mpi_process(system.scene.comm) != 0) // all ranks know the same
      return;
    for (unsigned int u = 0; u < resisting.size(); ++u)
      {
        const double way = .5 * dt * (q_before[u] + q_after[u]);
        in_step.heat -= way * resisting[u];
        in_step.work += way * loads[u];
      }
  }

  template <int dim>
  void
  EnergyFlow<dim>::take_part(const Velocities &force, const Velocities &v, const double dt)
  {
    const auto &loads = system.loads->last_force();
    for (unsigned int i = 0; i < force.size(); ++i)
      {
        const Tensor<1, dim> way = .5 * dt * (before[i] + v[i]);
        in_step.heat -= (force[i] - of_state[i]) * way;
        in_step.work += loads[i] * way;
      }
    for (const auto &held : system.loads->held())
      for (unsigned int c = 0; c < dim; ++c)
        if (const unsigned int i = held.particle; held.holds(c))
          in_step.work += .5 * (before[i][c] + v[i][c]) *
                          (system.mass(i) * (v[i][c] - before[i][c]) - dt * force[i][c]);
    if (any_given)
      add_walls(dt, v);
    if (system.contacts)
      add_forces_of_contacts(v, dt);
  }

  /// The work of walls that move as given, and what of their friction is heat.
  template <int dim>
  void
  EnergyFlow<dim>::add_walls(const double dt, const Velocities &v)
  {
    given.assign(system.movers.size(), {});
    system.add_given(given);
    auto stress = of_walls.begin();
    for (unsigned int i = 0; i < of_state.size(); ++i)
      for (std::size_t p = system.pairs.row_fixed[i]; p < system.pairs.row_start[i + 1]; ++p)
        if (is_given[system.mover_of(p)])
          {
            const Tensor<1, dim> way      = dt * given_velocity(p, v);
            const double         friction = system.friction_of_pair(i, p, before) * way;
            in_step.heat += friction;
            in_step.work += friction + *stress++ * way;
          }
  }

  template <int dim>
  Tensor<1, dim>
  EnergyFlow<dim>::given_velocity(const std::size_t p, const Velocities &v) const
  {
    const unsigned int m = system.mover_of(p);
    if (!system.bodies || !system.bodies->moves(m))
      return v[system.pairs.j[p]];
    return given[m].at(system.pairs_poses[m].arm(system.pairs.place_on_wall(system.particles, p)));
  }

  /// Friction and repulsion.
  template <int dim>
  void
  EnergyFlow<dim>::add_forces_of_contacts(const Velocities &v, const double dt)
  {
    for (const auto &[where, acting] : system.contacts->forces())
      {
        const auto way = .5 * dt * (before[where.first] + v[where.first]) -
                         dt * system.wall_velocity(acting.mover, acting.X);
        in_step.heat -= acting.force * way;
        if (is_given[acting.mover])
          in_step.work += acting.force * (dt * given[acting.mover].at(system.pairs_poses[acting.mover].arm(acting.X)));
      }
  }

  template <int dim>
  void
  EnergyFlow<dim>::end_step()
  {
    const auto &comm = system.scene.comm;
    total.work += system.thickness() * dealii::Utilities::MPI::sum(in_step.work, comm);
    total.heat += system.thickness() * dealii::Utilities::MPI::sum(in_step.heat, comm);
  }

  template class EnergyFlow<2>;
  template class EnergyFlow<3>;
} // namespace Stroma::Sph
