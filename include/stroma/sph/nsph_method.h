#pragma once

#include <stroma/solvers/linear_solver.h>
#include <stroma/solvers/step_control.h>
#include <stroma/sph/particle_method.h>
#include <stroma/sph/step_operator.h>
#include <stroma/sph/velocity_history.h>

namespace Stroma::Sph
{
  /**
   * Non-inertial smoothed particle hydrodynamics: velocities follow from the balance of friction, stress and loads, (14) of
   * Heck 2017, Gamma v = f, by conjugate gradients. With implicit stresses the balance is that at the end of the step or of
   * each of its two stages (SDIRK 2), (Gamma + dt (K_el + K_hg)) v = f, linear in the velocity: geometry and rotation are
   * those of the step's start. A constant geometry given, SDIRK 2 is of second order in time, the others are of first.
   */
  template <int dim>
  class NsphMethod : public ParticleMethod<dim>
  {
  public:
    /// Declares and reads the sections NSPH and Linear solver. Throws UserError for explicit stresses with steps beyond
    /// their limit.
    NsphMethod(Parameters &p, const Scene<dim> &scene, const Solvers::StepSettings &steps, Timers &timers);

    StepStatus advance(double t, double t_next, StepWork &work) override;
    void       save(Output::ArchiveWriter &archive) const override;

    /// Largest stable step of explicit stresses over all materials [s]: 2 mu_P/M for longitudinal waves, M = K + 4G/3 and
    /// mu_P = mu with the morris operator, 3 mu with the central one; 2 mu/G for shear; and 1.5 mu/(s G) for hourglass
    /// control with 'Stabilisation' s, which friction of pairs resists alone. Where solids of
    /// different moduli meet, 10/3 mu/K as well (central), half of that of longitudinal waves (morris).
    static double explicit_limit(const Scene<dim> &scene, const std::vector<Constitution> &constitutions,
                                 const Settings &settings);

  private:
    using Velocities = typename System<dim>::Velocities;

    void       prepare(const Output::ArchiveReader *archive) override;
    void       restore_solver(const Output::ArchiveReader &archive);
    void       check_balance() const;
    StepStatus update_geometry();
    StepStatus find_islands();
    void       tell_of_islands();
    bool       islands_are_driven() const;
    void       check_islands() const;
    double     next_step(const Velocities &v) const;
    void       describe_stepping(Output::Summary &summary) const override;
    void       prepare_operator(double dt);
    /// Velocities of all points, and those of the rigid bodies that the balance of forces moves; or the forces on these.
    struct Pair
    {
      Velocities          particles;
      std::vector<double> bodies; ///< in the order of BodyBalance; empty where there are none
    };
    StepStatus solve_with_contacts(Pair &mean, Pair &end, double t, double t_next, StepWork &work);
    StepStatus commit(Pair &mean, Pair &end, double dt, StepWork &work);
    StepStatus solve_stages(Pair &mean, Pair &end, double dt, StepWork &work);
    StepStatus solve(Pair &v, const Pair &driving, StepWork &work);
    Pair       state_forces(double load_time);
    Pair       resistance(const Pair &v) const;
    double     largest_residual(const Pair &driving, const Pair &resisting) const;
    void       add_stress_change(Pair &driving, const Velocities &mean, double dt) const;
    void       set_bodies(Pair &v, const std::vector<double> &q) const;
    void       remove_mean(Vector &r) const;
    bool
    is_implicit() const
    {
      return this->settings.stress_update == StressUpdate::implicit_;
    }

    Solvers::LinearSolverSettings          linear_settings;
    std::unique_ptr<Islands<dim>>          islands;
    std::unique_ptr<StepOperator<dim>>     A;
    std::unique_ptr<Solvers::LinearSolver> linear_solver;
    unsigned int                           n_pairings      = 0; ///< of the system, after which islands were found last
    std::uint64_t                          most_islands    = 0; ///< in the run so far
    unsigned int                           order_of_solver = 0; ///< number of that in which its equations are
    VelocityHistory<dim>                   history;
    std::vector<double> loads_on_bodies; ///< of the stage that is solved, on the unknowns of BodyBalance
  };
} // namespace Stroma::Sph
