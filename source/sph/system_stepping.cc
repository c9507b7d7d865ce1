// How the state of System goes on with velocities: gradients, volumes, stresses, places.

#include <stroma/sph/rotation.h>
#include <stroma/sph/system.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace Stroma::Sph
{
  using dealii::Tensor;

  namespace
  {
    /// Ratio of volumes, before over after, beyond which a particle is crushed.
    constexpr double largest_compression = 10.;

    /// Mean excess of Packing from which on a fluid counts as losing volume. Flows that leave a lattice reach .08 before they settle at .03.
    constexpr double largest_excess = .1;

    /// Of HourglassControl::share_apart().
    constexpr double largest_share_apart = .05;

    /// Moves over the spacing, and strains, in one step, that only numbers without meaning can ask for.
    constexpr double lost = 1e3;

    /// Time in which stresses of inertial solids are drawn to the strain of places, over that in which friction lets modes of the size of
    /// the spacing rest: what this does to energy is then damped. Solids without inertia have no energy to gain by it.
    constexpr double rests_to_places = 10.;
    /// Of the strain of places, before which it is not found again.
    constexpr double least_share = .01;
  } // namespace

  /// The larger, or what is not a number.
  static double
  worse_of(const double a, const double b)
  {
    return b <= a ? a : std::isfinite(b) ? b : std::numeric_limits<double>::max();
  }

  template <int dim>
  void
  System<dim>::set_gradient(const Velocities &v)
  {
    elasticity->velocity_gradient(L, v);
    elasticity->add_wall_dilatation(L, v);
    if (degraded)
      degraded->set_gradients(v);
    for (unsigned int i = particles.n_free; i < pairs.n_rows() && boundary_stress; ++i)
      if (boundary_stress->gives(particles, i))
        L[i] = 0.; // nothing is integrated there
  }

  template <int dim>
  double
  System<dim>::largest_gradient() const
  {
    double largest = 0.;
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      largest = std::max(largest, L[i].norm());
    return largest;
  }

  template <int dim>
  StepStatus
  System<dim>::check(const Velocities &v, const double dt, const double largest_move, const double largest_strain) const
  {
    double move = std::max(fastest_body(), largest_wall_speed()) * dt / settings.arrangement.spacing, strain = 0.,
           compression = 0.;
    for (unsigned int i = 0; i < particles.n_owned; ++i)
      move = worse_of(move, v[i].norm() * dt / settings.arrangement.spacing);
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      {
        strain         = worse_of(strain, L[i].norm() * dt);
        const double J = particles.J[i] * volume_change(i, L[i], dt);
        compression    = worse_of(compression, J > 0. ? 1. / J : std::numeric_limits<double>::infinity());
      }
    StepStatus status = StepStatus::ok;
    if (move > largest_move || strain > largest_strain)
      status = StepStatus::moved_too_far;
    if (compression > largest_compression)
      status = StepStatus::crushed;
    if (!(move < lost && strain < lost))
      status = StepStatus::not_finite;
    if (packing && packing->mean_excess(particles) > largest_excess)
      status = worse(status, StepStatus::drifted_apart);
    if (hourglass_control && !degraded && hourglass_control->share_apart() > largest_share_apart)
      status = worse(status, StepStatus::came_apart);
    return reduce(status, scene.comm);
  }

  template <int dim>
  void
  System<dim>::commit(const Velocities &v, const double dt)
  {
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      update_stress(i, L[i], dt);
    move_bodies();
    if (bodies)
      find_wall_velocities();
    for (unsigned int i = 0; i < particles.n_owned; ++i)
      particles.x[i] += dt * v[i];
    particles.v.assign(v.begin(), v.begin() + particles.size());
    now = t_next;
    if (contacts)
      contacts->end_step();
    if (degraded)
      degrade(dt);
    neighbours->update_ghosts(particles.S);
    neighbours->update_ghosts(particles.J);
  }

  template <int dim>
  void
  System<dim>::shift(const Velocities &v, const double dt)
  {
    if (!packing)
      return;
    auto       dx = packing->shifts(particles, v, dt);
    const auto J  = particles.J;
    for (unsigned int i = 0; i < dx.size(); ++i)
      {
        if (degraded && is_solid(i))
          dx[i] = 0.;
        if (degraded && pairs.row_fixed[i] < pairs.row_start[i + 1])
          dx[i] += off_bodies(particles.x[i] + dx[i]);
        for (unsigned int c = 0; c < dim; ++c)
          if (is_held(i, c))
            dx[i][c] = 0.;
        if (dx[i].norm_square() == 0.)
          continue;
        particles.J[i] += packing->gradient(particles, i, J) * dx[i];
        particles.v[i] += L[i] * dx[i];
        particles.x[i] += dx[i];
      }
    neighbours->update_ghosts(particles.J);
    neighbours->update_ghosts(particles.v);
  }

  template <int dim>
  double
  System<dim>::volume_change(const unsigned int i, const Tensor<2, dim> &gradient, const double dt) const
  {
    if (settings.published())
      return 1. / (1. - dt * trace(gradient)); // Euler's step of (3)
    const Tensor<2, dim> I = dealii::unit_symmetric_tensor<dim>();
    if (is_solid(i))
      return determinant(I + dt * gradient);
    // Where a fluid is a part of a solid, V tr L of all sums up to 0 (Elasticity), and so do these changes.
    return degraded ? 1. + dt * trace(gradient) : std::exp(dt * trace(gradient));
  }

  template <int dim>
  void
  System<dim>::update_stress(const unsigned int i, const Tensor<2, dim> &gradient, const double dt)
  {
    particles.J[i] *= volume_change(i, gradient, dt);
    if (!has_solids())
      return;
    auto        &S = particles.S[i];
    const double G = constitutions[material_of(i)].G;
    if (settings.published())
      {
        S += dt * (deviatoric_rate(G, gradient) + jaumann_spin(S, gradient));
        return;
      }
    const Tensor<2, dim> I        = dealii::unit_symmetric_tensor<dim>();
    const auto           middle   = gradient * invert(I + .5 * dt * gradient);
    const auto           rotation = hughes_winget(middle, dt);
    const auto           half     = .5 * dt *
                      deviatoric_rate(G, degraded && degraded->touches(i) ?
                                           degraded->gradient(i) * invert(I + .5 * dt * gradient) :
                                           middle);
    S = rotated(S + half, rotation) + half;
  }

  /// Of the strain of places in the state after @p dt; none without friction.
  template <int dim>
  double
  System<dim>::share_of_places(const unsigned int material, const double dt) const
  {
    const auto &law = constitutions[material];
    if (law.mu == 0. || law.G == 0.)
      return 0.;
    const double dp = settings.arrangement.spacing, retardation = law.mu / law.G;
    return -std::expm1(-dt /
                       (is_inertial ? rests_to_places * (retardation + law.rho * dp * dp / law.mu) : retardation));
  }

  template <int dim>
  void
  System<dim>::draw_to_strain_of_places()
  {
    if (!hourglass_control || degraded || !is_viscous())
      return;
    std::vector<double> share;
    for (unsigned int m = 0; m < constitutions.size(); ++m)
      share.push_back(share_of_places(m, now - drawn_at));
    if (!(*std::max_element(share.begin(), share.end()) > least_share))
      return;
    if (!is_inertial) // which keeps all of its state itself
      undrawn = {particles.S, particles.J, particles.contact_gaps, drawn_at};
    drawn_at = now;
    Velocities u(particles.size());
    for (unsigned int i = 0; i < particles.n_owned; ++i)
      u[i] = displacement(i);
    neighbours->update_ghosts(u);
    neighbours->update_ghost_places(particles.x);
    for (const auto &of_wall : wall_displacements(poses, now))
      u.push_back(of_wall ? *of_wall : Tensor<1, dim>());
    Velocities x(pairs.n_points()); // places
    for (unsigned int i = 0; i < particles.size(); ++i)
      x[i] = particles.x[i];
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
        x[pairs.j[p]] = x[i] + pairs.r[p];
    std::vector<Tensor<2, dim>> H(pairs.n_rows()), unit(H); // gradients of u and x
    elasticity->velocity_gradient(H, u);
    elasticity->velocity_gradient(unit, x);
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      {
        const Tensor<2, dim> inverse = dealii::unit_symmetric_tensor<dim>() - H[i] * invert(unit[i]); // F^-1
        if (!(determinant(unit[i]) > 0. && determinant(inverse) > 0.) || !hourglass_control->knows_start(i, u))
          continue;
        const auto strain = -.5 * logarithm(symmetrize(transpose(inverse) * inverse));
        const auto S      = deviatoric_rate(constitutions[material_of(i)].G, Tensor<2, dim>(strain));
        particles.J[i] += share[material_of(i)] * (1. / determinant(inverse) - particles.J[i]);
        particles.S[i] += share[material_of(i)] * (S - particles.S[i]);
        for (auto &gaps : particles.contact_gaps)
          gaps[i] *= 1. - share[material_of(i)];
      }
    neighbours->update_ghosts(particles.S);
    neighbours->update_ghosts(particles.J);
  }

  template <int dim>
  void
  System<dim>::undo_draw()
  {
    if (!undrawn)
      return;
    particles.S            = std::move(undrawn->S);
    particles.J            = std::move(undrawn->J);
    particles.contact_gaps = std::move(undrawn->contact_gaps);
    drawn_at               = undrawn->drawn_at;
    undrawn.reset();
  }

  template void       System<2>::undo_draw();
  template void       System<3>::undo_draw();
  template void       System<2>::draw_to_strain_of_places();
  template void       System<3>::draw_to_strain_of_places();
  template double     System<2>::share_of_places(unsigned int, double) const;
  template double     System<3>::share_of_places(unsigned int, double) const;
  template void       System<2>::set_gradient(const Velocities &);
  template double     System<2>::largest_gradient() const;
  template StepStatus System<2>::check(const Velocities &, double, double, double) const;
  template void       System<2>::commit(const Velocities &, double);
  template void       System<2>::shift(const Velocities &, double);
  template double     System<2>::volume_change(unsigned int, const Tensor<2, 2> &, double) const;
  template void       System<2>::update_stress(unsigned int, const Tensor<2, 2> &, double);
  template void       System<3>::set_gradient(const Velocities &);
  template double     System<3>::largest_gradient() const;
  template StepStatus System<3>::check(const Velocities &, double, double, double) const;
  template void       System<3>::commit(const Velocities &, double);
  template void       System<3>::shift(const Velocities &, double);
  template double     System<3>::volume_change(unsigned int, const Tensor<2, 3> &, double) const;
  template void       System<3>::update_stress(unsigned int, const Tensor<2, 3> &, double);
} // namespace Stroma::Sph
