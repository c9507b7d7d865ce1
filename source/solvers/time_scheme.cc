#include <stroma/base/parameters.h>

#include <stroma/solvers/time_scheme.h>

#include <cmath>

namespace Stroma::Solvers
{
  namespace
  {
    /// A diagonally implicit Runge-Kutta scheme whose last row of a is b.
    struct Tableau
    {
      unsigned int n_stages;
      double       a[3][3];

      /// c_i, the place of stage i in the step.
      double
      c(const unsigned int i) const
      {
        return i + 1 == n_stages ? 1. : a[i][0] + a[i][1] + a[i][2];
      }
    };

    /// Alexander, SIAM J. Numer. Anal. 14 (1977) 1006-1021, theorem 5: L-stable with order = number of stages.
    const Tableau &
    tableau(const SchemeName name)
    {
      constexpr double     g = .4358665215084589994; // root of x^3 - 3 x^2 + 3/2 x - 1/6
      static const double  h = 1. - std::sqrt(.5);
      static const Tableau one{1, {{1.}}};
      static const Tableau two{2, {{h}, {1. - h, h}}};
      static const Tableau three{
        3, {{g}, {.5 * (1. - g), g}, {-1.5 * g * g + 4. * g - .25, 1.5 * g * g - 5. * g + 1.25, g}}};
      return name == SchemeName::sdirk3 ? three : name == SchemeName::sdirk2 ? two : one;
    }

    /// Newmark's relations u' = u + dt v + dt^2 ((1/2 - beta) a + beta a'), v' = v + dt ((1 - gamma) a + gamma a')
    /// with balance at the weighted mean (1 - alpha_f) ' + alpha_f of u and v and (1 - alpha_m) ' + alpha_m of a.
    struct Weights
    {
      double alpha_m, alpha_f, beta, gamma;
    };

    /// Chung & Hulbert, J. Appl. Mech. 60 (1993) 371-375, eqs. (17), (20), (25); Newmark has no means.
    Weights
    weights(const TimeSchemeSettings &settings)
    {
      const double rho     = settings.spectral_radius;
      const bool   mean    = settings.name == SchemeName::generalized_alpha;
      const double alpha_m = mean ? (2. * rho - 1.) / (rho + 1.) : 0.;
      const double alpha_f = mean ? rho / (rho + 1.) : 0.;
      const double root    = 1. - alpha_m + alpha_f;
      return {alpha_m, alpha_f, .25 * root * root, root - .5};
    }

    /// factor_a a + factor_b b + factor_c c.
    Vector
    combine(const double factor_a, const Vector &a, const double factor_b, const Vector &b, const double factor_c,
            const Vector &c)
    {
      Vector sum(a);
      sum.sadd(factor_a, factor_b, b);
      sum.add(factor_c, c);
      return sum;
    }

    bool
    is_second_order(const SchemeName name)
    {
      return name == SchemeName::newmark || name == SchemeName::generalized_alpha;
    }
  } // namespace

  void
  TimeSchemeSettings::add(Parameters &p, const Order order)
  {
    if (order == Order::statics)
      return;
    if (is_second_order(name) != (order == Order::second))
      name = order == Order::second ? SchemeName::generalized_alpha : SchemeName::sdirk2;
    if (order == Order::first)
      p.add_choice<SchemeName>("Scheme", name, "integration in time: of order 1, 2 and 3",
                               {{"backward Euler", SchemeName::backward_euler},
                                {"SDIRK 2", SchemeName::sdirk2},
                                {"SDIRK 3", SchemeName::sdirk3}});
    else
      p.add_choice<SchemeName>("Scheme", name, "integration in time, of order 2",
                               {{"generalized alpha", SchemeName::generalized_alpha},
                                {"Newmark", SchemeName::newmark}});
    if (name == SchemeName::generalized_alpha)
      p.add("Spectral radius", spectral_radius,
            "what a step leaves of the highest frequency: 1 keeps it, 0 takes it out at once", "",
            Range::closed(0., 1.));
  }

  TimeScheme::TimeScheme(const TimeSchemeSettings &settings, const Order order)
    : settings(settings)
    , order(order)
  {
    Assert(order == Order::statics || is_second_order(settings.name) == (order == Order::second),
           dealii::ExcMessage("this scheme does not fit the order of the equations"));
    stage_velocities.resize(order == Order::first ? n_stages() : 0);
  }

  unsigned int
  TimeScheme::n_stages() const
  {
    return order == Order::first ? tableau(settings.name).n_stages : 1;
  }

  Stage
  TimeScheme::stage(const unsigned int i, const double t, const double t_next, const Motion &start) const
  {
    AssertIndexRange(i, n_stages());
    Stage stage;
    stage.t  = t_next;
    stage.dt = t_next - t;
    if (order == Order::first)
      set_first_order(stage, i, t_next - t, start);
    else if (order == Order::second)
      set_second_order(stage, t_next - t, start);
    return stage;
  }

  /// u_i = u + dt sum_{j <= i} a_ij v_j.
  void
  TimeScheme::set_first_order(Stage &stage, const unsigned int i, const double dt, const Motion &start) const
  {
    const Tableau &scheme = tableau(settings.name);
    stage.t -= (1. - scheme.c(i)) * dt;
    stage.is_last  = i + 1 == scheme.n_stages;
    stage.v_factor = 1. / (scheme.a[i][i] * dt);
    stage.v_known  = start.u;
    for (unsigned int j = 0; j < i; ++j)
      stage.v_known.add(dt * scheme.a[i][j], stage_velocities[j]);
    stage.v_known *= -stage.v_factor;
  }

  /// Of the mean u_m: v_m and a_m, from Newmark's relations with u' - u = (u_m - u) / (1 - alpha_f).
  void
  TimeScheme::set_second_order(Stage &stage, const double dt, const Motion &start) const
  {
    const auto [alpha_m, alpha_f, beta, gamma] = weights(settings);
    stage.t -= alpha_f * dt;
    stage.start_weight = alpha_f;
    stage.v_factor     = gamma / (beta * dt);
    stage.v_known      = combine(-stage.v_factor, start.u, 1. - (1. - alpha_f) * gamma / beta, start.v,
                                 (1. - alpha_f) * dt * (1. - .5 * gamma / beta), start.a);
    stage.a_factor     = (1. - alpha_m) / ((1. - alpha_f) * beta * dt * dt);
    stage.a_known      = combine(-stage.a_factor, start.u, -(1. - alpha_m) / (beta * dt), start.v,
                                 1. - .5 * (1. - alpha_m) / beta, start.a);
  }

  void
  TimeScheme::finish_stage(const unsigned int i, const Stage &stage, const Vector &u)
  {
    stage_u = u;
    if (order != Order::first)
      return;
    stage_velocities[i] = stage.v_known;
    stage_velocities[i].add(stage.v_factor, u);
  }

  Motion
  TimeScheme::end(const double t, const double t_next, const Motion &start) const
  {
    Motion motion;
    motion.u = stage_u;
    if (order == Order::first)
      motion.v = stage_velocities.back();
    if (order != Order::second)
      return motion;
    const auto [alpha_m, alpha_f, beta, gamma] = weights(settings);
    const double dt                            = t_next - t;
    motion.u.sadd(1. / (1. - alpha_f), -alpha_f / (1. - alpha_f), start.u);
    Vector increment(motion.u);
    increment -= start.u;
    motion.a = combine(1. / (beta * dt * dt), increment, -1. / (beta * dt), start.v, 1. - .5 / beta, start.a);
    motion.v = combine(gamma * dt, motion.a, 1., start.v, (1. - gamma) * dt, start.a);
    return motion;
  }

  Vector
  TimeScheme::acceleration(const Motion &start, const Motion &end) const
  {
    const auto [alpha_m, alpha_f, beta, gamma] = weights(settings);
    Vector a(end.a);
    a.sadd(1. + alpha_f - alpha_m, alpha_m - alpha_f, start.a);
    return a;
  }
} // namespace Stroma::Solvers
