// Held sides and rigid bodies of System: how they move, and the forces on them.

#include <stroma/sph/system.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Sph
{
  using dealii::Tensor;

  template <int dim>
  void
  System<dim>::set_step(const double from, const double to)
  {
    t      = from;
    t_next = to;
    for (unsigned int m = 0; m < movers.size(); ++m)
      if (movers[m].rigid)
        steps[m].emplace(*movers[m].rigid, poses[m], from, to);
    prescribed.assign(particles.n_owned - particles.n_free, {});
    for (unsigned int i = particles.n_free; i < particles.n_owned; ++i)
      {
        const unsigned int m             = particles.mover[i];
        prescribed[i - particles.n_free] = wall_velocity(m, settings.published() ? particles.X[i] :
                                                                                   movers[m].foot(particles.X[i]));
      }
  }

  template <int dim>
  void
  System<dim>::restore_step(const double from, const double to)
  {
    set_step(from, to);
    for (unsigned int m = 0; m < movers.size(); ++m)
      if (steps[m])
        poses[m] = steps[m]->to;
  }

  /// In the step, of what was at @p X at the start.
  template <int dim>
  Tensor<1, dim>
  System<dim>::wall_velocity(const unsigned int m, const dealii::Point<dim> &X) const
  {
    return steps[m] ? steps[m]->velocity(X) : movers[m].velocity(scene, X, t, t_next);
  }

  /// Those of the step; 0 before the first one.
  template <int dim>
  void
  System<dim>::find_wall_velocities()
  {
    of_walls.assign(pairs.walls.size(), {});
    if (!(t_next > t))
      return;
    std::vector<Tensor<1, dim>> of_mover;
    for (unsigned int m = 0; m < movers.size(); ++m)
      of_mover.push_back(movers[m].varies_in_space ? Tensor<1, dim>() : wall_velocity(m, {}));
    for (unsigned int w = 0; w < of_walls.size(); ++w)
      {
        const auto &wall = pairs.walls[w];
        of_walls[w] = movers[wall.mover].varies_in_space ? wall_velocity(wall.mover, wall.X) : of_mover[wall.mover];
      }
  }

  template <int dim>
  void
  System<dim>::impose(Velocities &v)
  {
    v.resize(particles.size());
    std::copy(prescribed.begin(), prescribed.end(), v.begin() + particles.n_free);
    for (const auto &held : loads->held())
      {
        const auto target = loads->velocity(held, particles, t, t_next);
        for (unsigned int c = 0; c < dim; ++c)
          if (held.holds(c))
            v[held.particle][c] = target[c];
      }
    neighbours->update_ghosts(v);
    find_wall_velocities();
    v = with_walls(std::move(v));
  }

  template <int dim>
  typename System<dim>::Velocities
  System<dim>::with_walls(Velocities v) const
  {
    Assert(v.size() == particles.size(), dealii::ExcDimensionMismatch(v.size(), particles.size()));
    v.insert(v.end(), of_walls.begin(), of_walls.end());
    return v;
  }

  template <int dim>
  std::vector<Rigid::Pose<dim>>
  System<dim>::poses_before() const
  {
    auto before = poses;
    for (unsigned int m = 0; m < movers.size(); ++m)
      if (steps[m])
        before[m] = steps[m]->from;
    return before;
  }

  /// To the end of the step. Hourglass forces turn with them.
  template <int dim>
  void
  System<dim>::move_bodies()
  {
    for (unsigned int m = 0; m < movers.size(); ++m)
      {
        if (!steps[m])
          continue;
        poses[m] = steps[m]->to;
        if (!movers[m].rigid->drive.turns())
          continue;
        const Tensor<2, dim> turn = Rigid::rotation_matrix<dim>(steps[m]->to.rotation) *
                                    transpose(Rigid::rotation_matrix<dim>(steps[m]->from.rotation));
        mover_hourglass_force[m].force = turn * mover_hourglass_force[m].force;
        if constexpr (dim == 3)
          mover_hourglass_force[m].torque = turn * mover_hourglass_force[m].torque;
      }
  }

  /// The @p force of pair @p p, one with a wall.
  template <int dim>
  void
  System<dim>::add_to_mover(std::vector<Rigid::Wrench<dim>> &wrenches, const std::size_t p,
                            const Tensor<1, dim> &force) const
  {
    const bool         at_point = pairs.meets_wall_point(p); // published pairs meet the fixed particle
    const unsigned int m        = at_point ? pairs.wall(p).mover : particles.mover[pairs.j[p]];
    if (movers[m].rigid)
      wrenches[m].add(poses[m].arm(at_point ? pairs.wall(p).X : particles.X[pairs.j[p]]), force);
    else
      wrenches[m].force += force;
  }

  template <int dim>
  typename System<dim>::Reactions
  System<dim>::reactions()
  {
    const auto                      v = with_walls(particles.v);
    std::vector<Rigid::Wrench<dim>> on_material(mover_hourglass_force);
    std::vector<Tensor<1, dim>>     of_support(scene.supports.size());
    Velocities                      f;
    state_forces(f, t_next);
    for (unsigned int i = 0; i < particles.n_free; ++i)
      elasticity->visit_wall_forces(i, [&](const unsigned int p, const auto &force) {
        add_to_mover(on_material, p, force);
      });
    add_friction(f, v);
    for (unsigned int i = 0; i < particles.n_free; ++i)
      for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
        add_to_mover(on_material, p, friction_of_pair(i, p, v));
    for (const auto &held : loads->held())
      for (unsigned int c = 0; c < dim; ++c)
        if (held.holds(c))
          of_support[held.support][c] -= f[held.particle][c];
    for (unsigned int m = 0; m < movers.size(); ++m)
      if (movers[m].support >= 0)
        of_support[movers[m].support] += on_material[m].force;
    Reactions all;
    for (const auto &reaction : of_support)
      all.of_supports.push_back(thickness() * dealii::Utilities::MPI::sum(reaction, scene.comm));
    for (const auto &[force, torque] : on_material)
      all.of_movers.push_back({thickness() * dealii::Utilities::MPI::sum(force, scene.comm),
                               thickness() * dealii::Utilities::MPI::sum(torque, scene.comm)});
    return all;
  }

  /// Sides go by the mean displacement of their particles, rigid bodies by their pose.
  template <int dim>
  double
  System<dim>::work_of_movers() const
  {
    std::vector<double> sums(movers.size() * (dim + 1)); // displacements and number of each mover's particles
    for (unsigned int i = particles.n_free; i < particles.n_owned; ++i)
      {
        double *const of_mover = &sums[particles.mover[i] * (dim + 1)];
        for (unsigned int c = 0; c < dim; ++c)
          of_mover[c] += displacement(i)[c];
        of_mover[dim] += 1.;
      }
    dealii::Utilities::MPI::sum(sums, scene.comm, sums);
    double work = 0.;
    for (unsigned int m = 0; m < movers.size(); ++m)
      {
        const auto &[force, torque] = mover_hourglass_force[m];
        if (movers[m].rigid)
          work += .5 * (force * poses[m].translation + torque * poses[m].rotation);
        else
          for (unsigned int c = 0; c < dim; ++c)
            work += .5 * force[c] * sums[m * (dim + 1) + c] / std::max(sums[m * (dim + 1) + dim], 1.);
      }
    return work;
  }

  template void                           System<2>::set_step(double, double);
  template void                           System<2>::restore_step(double, double);
  template Tensor<1, 2>                   System<2>::wall_velocity(unsigned int, const dealii::Point<2> &) const;
  template void                           System<2>::find_wall_velocities();
  template void                           System<2>::impose(Velocities &);
  template typename System<2>::Velocities System<2>::with_walls(Velocities) const;
  template std::vector<Rigid::Pose<2>>    System<2>::poses_before() const;
  template void                           System<2>::move_bodies();
  template void System<2>::add_to_mover(std::vector<Rigid::Wrench<2>> &, std::size_t, const Tensor<1, 2> &) const;
  template typename System<2>::Reactions  System<2>::reactions();
  template double                         System<2>::work_of_movers() const;
  template void                           System<3>::set_step(double, double);
  template void                           System<3>::restore_step(double, double);
  template Tensor<1, 3>                   System<3>::wall_velocity(unsigned int, const dealii::Point<3> &) const;
  template void                           System<3>::find_wall_velocities();
  template void                           System<3>::impose(Velocities &);
  template typename System<3>::Velocities System<3>::with_walls(Velocities) const;
  template std::vector<Rigid::Pose<3>>    System<3>::poses_before() const;
  template void                           System<3>::move_bodies();
  template void System<3>::add_to_mover(std::vector<Rigid::Wrench<3>> &, std::size_t, const Tensor<1, 3> &) const;
  template typename System<3>::Reactions System<3>::reactions();
  template double                        System<3>::work_of_movers() const;
} // namespace Stroma::Sph
