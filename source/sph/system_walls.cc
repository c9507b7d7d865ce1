// Held sides and rigid bodies of System: how they move, and the forces on them.

#include <stroma/sph/system.h>

#include <deal.II/base/geometry_info.h>
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
        steps[m].emplace(*movers[m].rigid, poses[m], twists[m], from, to);
    at_end.clear();
    prescribe();
  }

  template <int dim>
  void
  System<dim>::prescribe()
  {
    prescribed.assign(particles.n_owned - particles.n_free, {});
    for (unsigned int i = particles.n_free; i < particles.n_owned; ++i)
      {
        const unsigned int m             = particles.mover[i];
        const auto        &X             = particles.X[i];
        prescribed[i - particles.n_free] = steps[m] || settings.published() ?
                                             wall_velocity(m, X) :
                                             movers[m].velocity_beyond(scene, X, t, t_next);
      }
  }

  template <int dim>
  void
  System<dim>::take_body_velocities(const std::vector<double> &mean, const std::vector<double> &end)
  {
    const auto in_step = bodies->twists_of(mean);
    ends_as            = bodies->twists_of(end);
    at_end             = steps;
    for (unsigned int m = 0; m < movers.size(); ++m)
      {
        if (!bodies->moves(m))
          continue;
        const Rigid::Twist<dim> change{ends_as[m].velocity - twists[m].velocity,
                                       ends_as[m].angular_velocity - twists[m].angular_velocity};
        at_end[m]->change_velocity(change, pairs_poses[m]);
        steps[m].emplace(*movers[m].rigid, poses[m], in_step[m], t, t_next);
      }
    prescribe();
  }

  template <int dim>
  void
  System<dim>::add_given(std::vector<Rigid::Twist<dim>> &of_movers) const
  {
    for (unsigned int m = 0; m < movers.size(); ++m)
      if (movers[m].rigid)
        {
          const auto given = movers[m].rigid->twist(t_next, movers[m].time_difference);
          of_movers[m].velocity += given.velocity;
          of_movers[m].angular_velocity += given.angular_velocity;
        }
  }

  template <int dim>
  std::vector<double>
  System<dim>::state_forces_on_bodies(const double load_time) const
  {
    auto                            all = bodies->loads(load_time);
    std::vector<Rigid::Wrench<dim>> of_contacts(movers.size());
    if (contacts)
      for (const auto &[where, force] : contacts->forces())
        of_contacts[force.mover].add(pairs_poses[force.mover].arm(force.X), -force.force);
    const auto from_contacts = bodies->sum(of_contacts);
    const auto from_pairs    = bodies->forces(
      [&](const unsigned int i, const auto &add) { visit_state_forces_of_walls(i, add); });
    for (unsigned int u = 0; u < all.size(); ++u)
      all[u] += from_contacts[u] + from_pairs[u];
    return all;
  }

  template <int dim>
  double
  System<dim>::fastest_body() const
  {
    double speed = 0.;
    for (unsigned int m = 0; m < movers.size(); ++m)
      if (bodies && bodies->moves(m) && steps[m])
        {
          const auto box = scene.bodies[movers[m].rigid->body].bounding_box();
          for (unsigned int corner = 0; corner < dealii::GeometryInfo<dim>::vertices_per_cell; ++corner)
            speed = std::max(speed, steps[m]->velocity(box.vertex(corner)).norm());
        }
    return speed;
  }

  template <int dim>
  double
  System<dim>::energy_of_bodies() const
  {
    double energy = 0.;
    for (unsigned int m = 0; m < movers.size(); ++m)
      if (momenta[m])
        {
          std::vector<Rigid::Twist<dim>> all(movers.size());
          all[m] = twists[m];
          add_given(all);
          energy += thickness() * momenta[m]->kinetic_energy(all[m], poses[m]);
        }
    return energy;
  }

  template <int dim>
  void
  System<dim>::restore_step(const double from, const double to, const std::vector<double> &body_motions)
  {
    set_step(from, to);
    for (unsigned int m = 0; m < movers.size(); ++m)
      if (steps[m])
        poses[m] = steps[m]->to;
    auto next = body_motions.begin();
    visit_motions([&](double &number) { number = *next++; });
    for (unsigned int m = 0; m < movers.size(); ++m)
      if (bodies && bodies->moves(m))
        steps[m]->to = poses[m];
    prescribe();
  }

  template <int dim>
  std::vector<double>
  System<dim>::body_motions()
  {
    std::vector<double> numbers;
    visit_motions([&](const double number) { numbers.push_back(number); });
    return numbers;
  }

  /// Calls visit(number) for all that a checkpoint holds of the bodies that the balance of forces moves.
  template <int dim>
  template <typename Visit>
  void
  System<dim>::visit_motions(const Visit &visit)
  {
    for (unsigned int m = 0; m < movers.size(); ++m)
      {
        if (!bodies || !bodies->moves(m))
          continue;
        for (unsigned int c = 0; c < dim; ++c)
          {
            visit(poses[m].translation[c]);
            visit(twists[m].velocity[c]);
          }
        for (unsigned int k = 0; k < Rigid::n_rotations<dim>; ++k)
          {
            visit(poses[m].rotation[k]);
            visit(twists[m].angular_velocity[k]);
          }
        steps[m]->visit_velocity(visit);
        if (!momenta[m])
          continue;
        for (unsigned int c = 0; c < dim; ++c)
          visit(momenta[m]->linear[c]);
        for (unsigned int k = 0; k < Rigid::n_rotations<dim>; ++k)
          visit(momenta[m]->angular[k]);
      }
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
    for (const auto &pair : pairs.touching)
      if (pairs.meets_wall_point(pair.p))
        of_walls[pairs.j[pair.p] - particles.size()] += contacts->approach(pair.i, pair.contact);
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
    pairs.let_slide(v);
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

  template <int dim>
  typename HourglassControl<dim>::OfWalls
  System<dim>::wall_displacements(const std::vector<Rigid::Pose<dim>> &at, const double time) const
  {
    typename HourglassControl<dim>::OfWalls all;
    for (const auto &wall : pairs.walls)
      {
        const auto &mover = movers[wall.mover];
        if (mover.rigid || !mover.varies_in_space)
          all.push_back(at[wall.mover].displacement(wall.X));
        else if (mover.gives_displacement)
          all.push_back(mover.displacement(scene, wall.X, time));
        else
          all.emplace_back();
      }
    return all;
  }

  /// To the end of the step.
  template <int dim>
  void
  System<dim>::move_bodies()
  {
    for (unsigned int m = 0; m < movers.size(); ++m)
      {
        if (!steps[m])
          {
            if (movers[m].moves && !movers[m].varies_in_space)
              poses[m].translation += (t_next - t) * wall_velocity(m, {});
            continue;
          }
        poses[m] = steps[m]->to;
      }
    for (unsigned int m = 0; m < at_end.size(); ++m)
      if (bodies->moves(m))
        {
          steps[m]->set_velocity(*at_end[m]);
          twists[m] = ends_as[m];
        }
    at_end.clear();
  }

  /// Largest move of a wall of facets since the pairs were found, at the corners of boxes around them [m].
  template <int dim>
  double
  System<dim>::move_of_facets() const
  {
    double largest = 0.;
    for (unsigned int m = 0; m < movers.size() && pairs.has_facets(); ++m)
      {
        const auto &mover = movers[m];
        if (!mover.moves || (!mover.rigid && pairs.has_segments()))
          continue;
        const auto box = mover.rigid ? scene.bodies[mover.rigid->body].bounding_box() : scene.bounding_box();
        for (unsigned int v = 0; v < dealii::GeometryInfo<dim>::vertices_per_cell; ++v)
          {
            const auto X = box.vertex(v);
            largest      = std::max(largest, !mover.rigid && mover.varies_in_space ?
                                               (mover.displacement(scene, mover.foot(X), now) -
                                           mover.displacement(scene, mover.foot(X), pairs_time))
                                            .norm() :
                                               poses[m].place(X).distance(pairs_poses[m].place(X)));
          }
      }
    return largest;
  }

  /// Of facets, where particles meet them in the step [m/s].
  template <int dim>
  double
  System<dim>::largest_wall_speed() const
  {
    double largest = 0.;
    for (unsigned int w = 0; w < of_walls.size() && pairs.has_facets(); ++w)
      largest = std::max(largest, of_walls[w].norm());
    return largest;
  }

  /// The @p force of pair @p p, one with a wall.
  template <int dim>
  void
  System<dim>::add_to_mover(std::vector<Rigid::Wrench<dim>> &wrenches, const std::size_t p,
                            const Tensor<1, dim> &force) const
  {
    const unsigned int m = mover_of(p);
    if (movers[m].rigid)
      wrenches[m].add(pairs_poses[m].arm(pairs.place_on_wall(particles, p)), force);
    else
      wrenches[m].force += force;
  }

  template <int dim>
  typename System<dim>::Reactions
  System<dim>::reactions()
  {
    const auto                      v = with_walls(particles.v);
    std::vector<Rigid::Wrench<dim>> on_material(movers.size());
    std::vector<Tensor<1, dim>>     of_support(scene.supports.size());
    const bool                      holds = loads->holds_any(); // particles, whose reactions are of whole sums
    Velocities                      f;
    if (holds)
      state_forces(f, t_next);
    else
      find_state_forces(t_next);
    for (unsigned int i = 0; i < particles.n_free; ++i)
      visit_state_forces_of_walls(i, [&](const unsigned int p, const auto &force) {
        add_to_mover(on_material, p, force / pairs.row_factor(i));
      });
    if (contacts)
      for (const auto &[where, force] : contacts->forces())
        on_material[force.mover].add(pairs_poses[force.mover].arm(force.X), force.force);
    if (holds)
      add_friction(f, v);
    else
      find_friction(v);
    for (unsigned int i = 0; i < particles.n_free; ++i)
      for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
        add_to_mover(on_material, p, friction_of_pair(i, p, v) / pairs.row_factor(i));
    for (const auto &held : loads->held())
      for (unsigned int c = 0; c < dim; ++c)
        if (held.holds(c))
          of_support[held.support][c] -= f[held.particle][c] / pairs.row_factor(held.particle);
    for (unsigned int m = 0; m < movers.size(); ++m)
      if (movers[m].support >= 0)
        of_support[movers[m].support] += on_material[m].force;
    Reactions all;
    for (const auto &reaction : of_support)
      all.of_supports.push_back(thickness() * dealii::Utilities::MPI::sum(reaction, scene.comm));
    for (const auto &body : scene.rigid_bodies)
      if (body.drive.support >= 0) // it bears the load on the body
        all.of_supports[body.drive.support] -= body.drive.force(t_next);
    for (const auto &[force, torque] : on_material)
      all.of_movers.push_back({thickness() * dealii::Utilities::MPI::sum(force, scene.comm),
                               thickness() * dealii::Utilities::MPI::sum(torque, scene.comm)});
    return all;
  }

  template void System<2>::set_step(double, double);
  template void System<2>::prescribe();
  template void System<2>::take_body_velocities(const std::vector<double> &, const std::vector<double> &);
  template void System<2>::add_given(std::vector<Rigid::Twist<2>> &) const;
  template std::vector<double>            System<2>::state_forces_on_bodies(double) const;
  template void                           System<2>::restore_step(double, double, const std::vector<double> &);
  template double                         System<2>::fastest_body() const;
  template double                         System<2>::energy_of_bodies() const;
  template std::vector<double>            System<2>::body_motions();
  template Tensor<1, 2>                   System<2>::wall_velocity(unsigned int, const dealii::Point<2> &) const;
  template void                           System<2>::find_wall_velocities();
  template void                           System<2>::impose(Velocities &);
  template typename System<2>::Velocities System<2>::with_walls(Velocities) const;
  template std::vector<Rigid::Pose<2>>    System<2>::poses_before() const;
  template void                           System<2>::move_bodies();
  template double                         System<2>::move_of_facets() const;
  template double                         System<2>::largest_wall_speed() const;
  template void System<2>::add_to_mover(std::vector<Rigid::Wrench<2>> &, std::size_t, const Tensor<1, 2> &) const;
  template typename System<2>::Reactions         System<2>::reactions();
  template typename HourglassControl<2>::OfWalls System<2>::wall_displacements(const std::vector<Rigid::Pose<2>> &,
                                                                               double) const;
  template void                                  System<3>::set_step(double, double);
  template void                                  System<3>::prescribe();
  template void System<3>::take_body_velocities(const std::vector<double> &, const std::vector<double> &);
  template void System<3>::add_given(std::vector<Rigid::Twist<3>> &) const;
  template std::vector<double>            System<3>::state_forces_on_bodies(double) const;
  template void                           System<3>::restore_step(double, double, const std::vector<double> &);
  template double                         System<3>::fastest_body() const;
  template double                         System<3>::energy_of_bodies() const;
  template std::vector<double>            System<3>::body_motions();
  template Tensor<1, 3>                   System<3>::wall_velocity(unsigned int, const dealii::Point<3> &) const;
  template void                           System<3>::find_wall_velocities();
  template void                           System<3>::impose(Velocities &);
  template typename System<3>::Velocities System<3>::with_walls(Velocities) const;
  template std::vector<Rigid::Pose<3>>    System<3>::poses_before() const;
  template void                           System<3>::move_bodies();
  template double                         System<3>::move_of_facets() const;
  template double                         System<3>::largest_wall_speed() const;
  template void System<3>::add_to_mover(std::vector<Rigid::Wrench<3>> &, std::size_t, const Tensor<1, 3> &) const;
  template typename System<3>::Reactions         System<3>::reactions();
  template typename HourglassControl<3>::OfWalls System<3>::wall_displacements(const std::vector<Rigid::Pose<3>> &,
                                                                               double) const;
} // namespace Stroma::Sph
