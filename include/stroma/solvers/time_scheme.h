#pragma once

#include <stroma/base/types.h>

#include <vector>

namespace Stroma
{
  class Parameters;
}

namespace Stroma::Solvers
{
  /// What a scene needs of time.
  enum class Order
  {
    statics, ///< forces depend on u alone; time only orders the loading
    first,   ///< on u and v = du/dt (viscosity without inertia)
    second   ///< on u, v and a = dv/dt (inertia)
  };

  enum class SchemeName
  {
    backward_euler,   ///< first order systems, order 1
    sdirk2,           ///< first order systems, order 2, two stages (Alexander 1977)
    sdirk3,           ///< first order systems, order 3, three stages (Alexander 1977)
    newmark,          ///< second order systems, trapezoidal: beta = 1/4, gamma = 1/2
    generalized_alpha ///< second order systems, order 2, with damping (Chung & Hulbert 1993)
  };

  /// Motion of all unknowns at one time. v and a are empty where the scene does not need them.
  struct Motion
  {
    Vector u; ///< displacement [m]
    Vector v; ///< velocity [m/s]
    Vector a; ///< acceleration [m/s^2]
  };

  /**
   * One implicit solve for a displacement u at time t, with v = v_factor u + v_known and a = a_factor u + a_known.
   * With generalized alpha u is the mean (1 - start_weight) u(t_next) + start_weight u(start), so that a displacement
   * prescribed as g(t) is (1 - start_weight) g(t_next) + start_weight u(start) here; with the others start_weight is 0.
   * In the last stage of an SDIRK it is g(t_next), and in those before what makes v = g'(t) of the stage: with g(t) there,
   * velocities and their forces would be of first order only.
   */
  struct Stage
  {
    double t            = 0.; ///< [s]
    double dt           = 0.; ///< length of the whole step [s], for laws with history
    double v_factor     = 0.; ///< [1/s]
    double a_factor     = 0.; ///< [1/s^2]
    double start_weight = 0.;
    bool   is_last      = true; ///< of the step
    Vector v_known, a_known;    ///< [m/s], [m/s^2]; empty where the scene does not need them
  };

  struct TimeSchemeSettings
  {
    SchemeName name            = SchemeName::sdirk2; ///< must fit the order; not used by statics
    double     spectral_radius = .8;                 ///< generalized_alpha: of the highest frequency, in [0, 1]

    /// Declares and reads the entries in the current section: 'Scheme' (the choices that fit @p order; generalized
    /// alpha or SDIRK 2 unless the present name fits), and 'Spectral radius' with generalized alpha. Declares nothing
    /// for statics.
    void add(Parameters &p, Order order);
  };

  /**
   * Time integration as a sequence of implicit solves that know nothing of it: each stage gives v and a as linear
   * functions of its unknown u. SDIRKs are L-stable, and their last stage is the end of the step; Newmark and
   * generalized alpha are A-stable and need v and a at the start. A step that failed is taken again from its start.
   */
  class TimeScheme
  {
  public:
    TimeScheme(const TimeSchemeSettings &settings, Order order);

    unsigned int n_stages() const;

    /// Whether stages and end look at the motion at the start of the step; if not, that may be empty.
    bool
    looks_back() const
    {
      return order != Order::statics;
    }

    /// Stage @p i of the step from @p start at @p t to @p t_next [s]. finish_stage() must have been called for those
    /// before.
    Stage stage(unsigned int i, double t, double t_next, const Motion &start) const;

    /// Takes the solution @p u of stage(i).
    void finish_stage(unsigned int i, const Stage &stage, const Vector &u);

    /// The motion at the end of the step, after the last stage.
    Motion end(double t, double t_next, const Motion &start) const;

    /// Acceleration at the end of the step, to second order: a of generalized alpha is that of a time
    /// (alpha_f - alpha_m) dt earlier (Erlicher, Bonaventura & Bursi 2002).
    Vector acceleration(const Motion &start, const Motion &end) const;

  private:
    void set_first_order(Stage &stage, unsigned int i, double dt, const Motion &start) const;
    void set_second_order(Stage &stage, double dt, const Motion &start) const;

    TimeSchemeSettings  settings;
    Order               order;
    std::vector<Vector> stage_velocities; ///< first order
    Vector              stage_u;          ///< of the last finished stage
  };
} // namespace Stroma::Solvers
