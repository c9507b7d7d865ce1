#include <stroma/base/text.h>
#include <stroma/sph/nsph_method.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Sph
{
  namespace
  {
    /// Largest norm of a velocity gradient times dt in a step.
    constexpr double largest_strain = .2;

    /// Of Alexander's SDIRK 2.
    const double gamma = 1. - std::sqrt(.5);

    template <int dim>
    double
    norm(const std::vector<dealii::Tensor<1, dim>> &f, const MPI_Comm comm)
    {
      double sum = 0.;
      for (const auto &f_i : f)
        sum += f_i.norm_square();
      return std::sqrt(dealii::Utilities::MPI::sum(sum, comm));
    }
  } // namespace

  template <int dim>
  NsphMethod<dim>::NsphMethod(Parameters &p, const Scene<dim> &scene, const Solvers::StepSettings &steps, Timers &timers)
    : ParticleMethod<dim>(p, scene, Dynamics::overdamped, steps.end_time, timers)
  {
    linear_settings.tolerance = 1e-6;
    const bool is_held = !scene.supports.empty() || std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                                                [](const auto &body) { return body.rigid; });
    if (!is_held)
      linear_settings.preconditioner = Solvers::Preconditioner::jacobi;
    {
      const auto section = p.section("Linear solver", "conjugate gradients");
      linear_settings.add(p);
      if (!is_held && linear_settings.preconditioner == Solvers::Preconditioner::amg)
        throw UserError(p.where("Preconditioner"), "multigrid needs material that is held somewhere; without a support set "
                                                   "'Preconditioner = jacobi'");
    }
    const double limit = explicit_limit(scene, this->system->constitutions);
    if (!is_implicit() && std::max(steps.initial_step, steps.largest_step) > limit)
      throw UserError(this->settings.where_stress_update,
                      "explicit stresses are stable up to steps of 2 mu_P/(K + 4G/3) = " + brief(limit) +
                        " s, but 'Time/Initial step' is " + brief(steps.initial_step) + " s and 'Largest step' " +
                        brief(steps.largest_step) + " s; reduce them or set 'Stress update = implicit'");
  }

  template <int dim>
  double
  NsphMethod<dim>::explicit_limit(const Scene<dim> &scene, const std::vector<Constitution> &constitutions)
  {
    double limit = std::numeric_limits<double>::max();
    for (unsigned int m = 0; m < constitutions.size(); ++m)
    {
      const bool central = scene.media[m].viscous_operator == Materials::ViscousOperator::central;
      limit = std::min(limit, 2. * (central ? 3. : 1.) * constitutions[m].mu / constitutions[m].p_wave_modulus());
    }
    return limit;
  }

  template <int dim>
  void
  NsphMethod<dim>::prepare()
  {
    A             = std::make_unique<StepOperator<dim>>(*this->system);
    linear_solver = std::make_unique<Solvers::LinearSolver>(linear_settings);
    const auto &system = *this->system;
    const bool  all_periodic = std::all_of(this->scene.periodic.begin(), this->scene.periodic.end(), [](bool p) { return p; });
    if (!system.is_supported() && !all_periodic)
      throw UserError("section Supports", "nothing holds the material, and without inertia forces alone do not tell how it "
                                          "moves as a whole; clamp a side or a layer, or solve with 'Method = sph'");
    Log::line("NSPH: explicit stresses would be stable up to steps of " +
              brief(explicit_limit(this->scene, system.constitutions)) + " s");
  }

  template <int dim>
  StepStatus
  NsphMethod<dim>::advance(const double t, const double t_next, StepWork &work)
  {
    auto        &system = *this->system;
    const double dt     = t_next - t;
    auto         status = system.update_geometry();
    if (status != StepStatus::ok)
      return status;
    system.set_step(t, t_next);
    Velocities mean, end; // over the step, and at its end
    {
      const auto scope = this->timers.scope("solve");
      work.newton_iterations += 1;
      work.hardest_solve = 1;
      status             = solve_stages(mean, end, dt, work);
    }
    if (status != StepStatus::ok)
      return status;

    const auto scope = this->timers.scope("stress");
    system.set_gradient(mean);
    const bool published = this->settings.published();
    status = system.check(mean, dt, published ? 1. : this->settings.largest_move, published ? 1. : largest_strain);
    if (status != StepStatus::ok)
      return status;
    const bool in_balance = before.step > 0.; // as velocities at the start are not
    before                = { std::move(system.particles.v), dt, in_balance ? system.neighbours->n_orders : 0 };
    system.commit(mean, dt);
    system.particles.v = std::move(end);
    this->time         = t_next;
    this->collect_scalars(t_next);
    return StepStatus::ok;
  }

  template <int dim>
  StepStatus
  NsphMethod<dim>::solve_stages(Velocities &mean, Velocities &end, const double dt, StepWork &work)
  {
    auto        &system = *this->system;
    const bool   two    = is_implicit() && this->settings.scheme == Solvers::SchemeName::sdirk2;
    const double share  = two ? gamma : 1.; // of the step, in each stage
    Velocities   driving;
    system.state_forces(driving, this->time + share * dt);
    prepare_operator(is_implicit() ? share * dt : 0.);
    end = first_guess(share * dt);
    system.impose(end);
    auto status = solve(end, driving, work);
    mean        = end;
    if (!two || status != StepStatus::ok)
      return status;

    // Alexander's second stage, with the stress that the first leaves; first guess on the line through what is known.
    for (unsigned int i = 0; i < end.size(); ++i)
      end[i] += (1. / gamma - 1.) * (mean[i] - system.particles.v[i]);
    system.impose(end);
    system.state_forces(driving, this->time + dt);
    Velocities increment(driving.size());
    system.elasticity->combine(1., 0.);
    system.elasticity->add_stiffness_force(increment, mean);
    for (unsigned int i = 0; i < driving.size(); ++i)
      driving[i] += (1. - gamma) * dt * increment[i];
    prepare_operator(share * dt);
    status = solve(end, driving, work);
    for (unsigned int i = 0; i < end.size(); ++i)
      mean[i] = (1. - gamma) * mean[i] + gamma * end[i];
    return status;
  }

  template <int dim>
  typename NsphMethod<dim>::Velocities
  NsphMethod<dim>::first_guess(const double ahead) const
  {
    Velocities v = this->system->particles.v;
    if (before.order == this->system->neighbours->n_orders)
      for (unsigned int i = 0; i < this->system->particles.n_free; ++i)
        v[i] += ahead / before.step * (v[i] - before.v[i]);
    return v;
  }

  template <int dim>
  void
  NsphMethod<dim>::prepare_operator(const double dt)
  {
    A->set_step(dt);
    const auto order = this->system->neighbours->n_orders;
    if (linear_settings.preconditioner == Solvers::Preconditioner::amg && order != order_of_solver)
      linear_solver->set_near_null_space(A->near_null_space());
    order_of_solver = order;
  }

  template <int dim>
  StepStatus
  NsphMethod<dim>::solve(Velocities &v, const Velocities &driving, StepWork &work)
  {
    const auto &system = *this->system;
    const auto &comm   = this->scene.comm;
    // What is left of the balance with the velocities of the first guess, those imposed included.
    Velocities resisting;
    A->force(resisting, v);
    const double         scale = std::max({ norm(system.loads->last_force(), comm), norm(driving, comm), norm(resisting, comm) });
    Vector               r = A->new_vector(), change(r);
    const unsigned int   n = system.particles.n_free;
    auto *const          values = reinterpret_cast<dealii::Tensor<1, dim> *>(r.begin());
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int c = 0; c < dim; ++c)
        values[i][c] = system.is_held(i, c) ? 0. : driving[i][c] + resisting[i][c];
    if (!system.is_supported())
      remove_mean(r);

    const auto result = linear_solver->solve(*A, change, r, linear_settings.tolerance * scale);
    work.linear_iterations += result.iterations;
    work.residual_evaluations += 1;
    if (!result.converged)
      return StepStatus::linear_failed;
    if (!system.is_supported())
      remove_mean(change);
    const auto *const changes = reinterpret_cast<const dealii::Tensor<1, dim> *>(change.begin());
    for (unsigned int i = 0; i < n; ++i)
      v[i] += changes[i];
    system.neighbours->update_ghosts(v);
    return StepStatus::ok;
  }

  template <int dim>
  void
  NsphMethod<dim>::remove_mean(Vector &r) const
  {
    dealii::Tensor<1, dim> sum;
    const unsigned int     n      = this->system->particles.n_free;
    auto *const            values = reinterpret_cast<dealii::Tensor<1, dim> *>(r.begin());
    for (unsigned int i = 0; i < n; ++i)
      sum += values[i];
    sum = dealii::Utilities::MPI::sum(sum, this->scene.comm);
    for (unsigned int i = 0; i < n; ++i)
      values[i] -= sum / double(this->system->n_free);
  }

  template <int dim>
  void
  NsphMethod<dim>::go_on_as_resumed()
  {
    ParticleMethod<dim>::go_on_as_resumed();
    linear_solver->forget();
    before = {};
  }

  template <int dim>
  void
  NsphMethod<dim>::describe_stepping(Output::Summary &summary) const
  {
    summary.method = "nsph";
    (is_implicit() ? summary.used : summary.left_out).push_back("stiffness in the velocity system");
    summary.results["explicit_step_limit_s"] = explicit_limit(this->scene, this->system->constitutions);
  }

  template class NsphMethod<2>;
  template class NsphMethod<3>;
} // namespace Stroma::Sph
