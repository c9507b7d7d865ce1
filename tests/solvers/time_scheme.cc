// Time schemes on one or two equations, solved through the algebra of their stages: orders, stiffness, polynomials.

#include <stroma/base/parameters.h>

#include <stroma/solvers/time_scheme.h>

#include <deal.II/base/index_set.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

using namespace Stroma;
using namespace Stroma::Solvers;

namespace
{
  Vector
  number(const double value)
  {
    Vector vector(dealii::complete_index_set(1), MPI_COMM_SELF);
    vector = value;
    return vector;
  }

  double
  of(const Vector &vector)
  {
    return vector[0];
  }

  /// A scalar equation r(t, u, v, a) = 0 of order one or two in time.
  using Equation = std::function<double(double t, double u, double v, double a)>;

  /// Newton's method for the stage's u, with numerical derivatives.
  Vector
  solve(const Equation &equation, const Stage &stage, const double guess, const Order order)
  {
    const auto residual = [&](const double u) {
      const double v = stage.v_factor * u + of(stage.v_known);
      return equation(stage.t, u, v, order == Order::second ? stage.a_factor * u + of(stage.a_known) : 0.);
    };
    double u = guess;
    for (unsigned int i = 0; i < 8; ++i)
      u -= residual(u) * 2e-4 / (residual(u + 1e-4) - residual(u - 1e-4));
    return number(u);
  }

  Motion
  step(TimeScheme &scheme, const Order order, const Equation &equation, const double t, const double t_next,
       const Motion &start)
  {
    for (unsigned int i = 0; i < scheme.n_stages(); ++i)
      {
        const Stage stage = scheme.stage(i, t, t_next, start);
        scheme.finish_stage(i, stage, solve(equation, stage, of(start.u), order));
      }
    return scheme.end(t, t_next, start);
  }

  Motion
  integrate(const TimeSchemeSettings &settings, const Order order, const Equation &equation, Motion motion,
            const double T, const unsigned int n)
  {
    TimeScheme scheme(settings, order);
    for (unsigned int k = 0; k < n; ++k)
      motion = step(scheme, order, equation, k * T / n, (k + 1) * T / n, motion);
    return motion;
  }

  Motion
  first_order_start(const double u)
  {
    return {number(u), {}, {}};
  }

  Motion
  second_order_start(const double u, const double v, const double a)
  {
    return {number(u), number(v), number(a)};
  }

  /// Order seen between n and 2 n steps.
  double
  order_of(const std::function<double(unsigned int)> &error, const unsigned int n)
  {
    return std::log2(std::abs(error(n) / error(2 * n)));
  }

  constexpr SchemeName sdirks[] = {SchemeName::backward_euler, SchemeName::sdirk2, SchemeName::sdirk3};

  const std::vector<TimeSchemeSettings> second_order_schemes = {{SchemeName::newmark},
                                                                {SchemeName::generalized_alpha, 0.},
                                                                {SchemeName::generalized_alpha, .8},
                                                                {SchemeName::generalized_alpha, 1.}};
} // namespace

TEST(TimeScheme, SdirksHaveTheirOrderInANonlinearEquation)
{
  // v + u^3 = f(t) with u = 1 + sin(t)/2.
  const auto     exact    = [](const double t) { return 1. + .5 * std::sin(t); };
  const Equation equation = [&](const double t, const double u, const double v, double) {
    return v + u * u * u - .5 * std::cos(t) - std::pow(exact(t), 3);
  };
  for (unsigned int p = 0; p < 3; ++p)
    {
      const auto end = [&](const unsigned int n) {
        return integrate({sdirks[p]}, Order::first, equation, first_order_start(1.), 2., n);
      };
      EXPECT_NEAR(order_of([&](unsigned int n) { return of(end(n).u) - exact(2.); }, 160), p + 1., .1);
      EXPECT_NEAR(order_of([&](unsigned int n) { return of(end(n).v) - .5 * std::cos(2.); }, 160), p + 1., .1);
    }
}

TEST(TimeScheme, SdirksIntegratePolynomialsUpToTheirOrder)
{
  for (unsigned int p = 1; p <= 3; ++p)
    for (unsigned int q = 0; q <= p; ++q)
      {
        const Equation equation = [q](const double t, double, const double v, double) {
          return v - (q == 0 ? 0. : q * std::pow(t, q - 1.));
        };
        const auto end = integrate({sdirks[p - 1]}, Order::first, equation, first_order_start(q == 0 ? 1. : 0.), 1., 3);
        EXPECT_NEAR(of(end.u), 1., 1e-12) << p << q;
      }
}

TEST(TimeScheme, SdirksForgetAStiffStartAtOnce)
{
  const Equation equation = [](const double t, const double u, const double v, double) {
    return v + 1e9 * (u - std::cos(t));
  };
  for (const SchemeName name : sdirks)
    {
      const auto end = integrate({name}, Order::first, equation, first_order_start(3.), .5, 1);
      EXPECT_NEAR(of(end.u), std::cos(.5), 1e-6);
    }
}

TEST(TimeScheme, SdirksEndAtTheirLastStage)
{
  for (const SchemeName name : sdirks)
    {
      TimeScheme scheme({name}, Order::first);
      const auto start = first_order_start(2.);
      const auto end   = step(
          scheme, Order::first, [](double, double u, double v, double) { return v + u; }, 1., 1.5, start);
      const Stage last = scheme.stage(scheme.n_stages() - 1, 1., 1.5, start);
      EXPECT_EQ(last.t, 1.5);
      EXPECT_EQ(last.start_weight, 0.);
      EXPECT_NEAR(of(end.v), -of(end.u), 1e-10); // balanced at the end
      EXPECT_NEAR(of(end.u), last.v_factor == 0. ? 0. : (of(end.v) - of(last.v_known)) / last.v_factor, 1e-12);
    }
}

TEST(TimeScheme, AStepTakenAgainIsThatStep)
{
  const Equation equation = [](double, const double u, const double v, double) { return v + u * u; };
  for (const SchemeName name : sdirks)
    {
      const auto start = first_order_start(2.);
      TimeScheme used({name}, Order::first), fresh({name}, Order::first);
      used.finish_stage(0, used.stage(0, 0., 9., start), number(77.)); // a step that failed after its first stage
      const auto a = step(used, Order::first, equation, 0., .1, start),
                 b = step(fresh, Order::first, equation, 0., .1, start);
      EXPECT_EQ(of(a.u), of(b.u));
      EXPECT_EQ(of(a.v), of(b.v));
    }
}

TEST(TimeScheme, OscillatorsHaveOrderTwo)
{
  // a + .4 v + 4 u + u^3 = f(t) with u = 1 + sin(t)/2.
  const auto     exact    = [](const double t) { return 1. + .5 * std::sin(t); };
  const Equation equation = [&](const double t, const double u, const double v, const double a) {
    return a + .5 * std::sin(t) + .4 * (v - .5 * std::cos(t)) + 4. * (u - exact(t)) + u * u * u - std::pow(exact(t), 3);
  };
  for (const auto &settings : second_order_schemes)
    {
      const auto end = [&](const unsigned int n) {
        return integrate(settings, Order::second, equation, second_order_start(1., .5, 0.), 2., n);
      };
      EXPECT_NEAR(order_of([&](unsigned int n) { return of(end(n).u) - exact(2.); }, 160), 2., .1);
      EXPECT_NEAR(order_of([&](unsigned int n) { return of(end(n).v) - .5 * std::cos(2.); }, 160), 2., .1);
    }
}

TEST(TimeScheme, ConstantAccelerationIsExact)
{
  const Equation equation = [](double, double, double, const double a) { return a - 3.; };
  for (const auto &settings : second_order_schemes)
    {
      const auto end = integrate(settings, Order::second, equation, second_order_start(1., 2., 3.), 2., 5);
      EXPECT_NEAR(of(end.u), 11., 1e-10);
      EXPECT_NEAR(of(end.v), 8., 1e-10);
      EXPECT_NEAR(of(end.a), 3., 1e-9);
    }
}

TEST(TimeScheme, NewmarkKeepsTheEnergyOfAnOscillator)
{
  const double   k        = 50.;
  const Equation equation = [k](double, const double u, double, const double a) { return a + k * u; };
  const auto     end = integrate({SchemeName::newmark}, Order::second, equation, second_order_start(1., 0., -k), 100.,
                                 1000);
  EXPECT_NEAR(of(end.v) * of(end.v) + k * of(end.u) * of(end.u), k, 1e-8 * k);
}

TEST(TimeScheme, GeneralizedAlphaDampsTheHighestFrequencyAsTold)
{
  const double   k        = 1e10;
  const Equation equation = [k](double, const double u, double, const double a) { return a + k * u; };
  const auto     size     = [&](const double radius, const unsigned int n) {
    const auto end = integrate({SchemeName::generalized_alpha, radius}, Order::second, equation,
                                       second_order_start(1., 0., 0.), 1. * n, n);
    return std::abs(of(end.u)) + std::abs(of(end.v)) + std::abs(of(end.a));
  };
  EXPECT_LT(size(0., 4), 1e-6);
  // A triple eigenvalue: n steps leave a multiple of n^2 radius^n.
  for (const double radius : {.4, .7})
    EXPECT_NEAR(size(radius, 40) / size(radius, 20), 4. * std::pow(radius, 20), .4 * std::pow(radius, 20));
}

TEST(TimeScheme, PrescribedMotionOfTheMeanEndsWhereItShould)
{
  const auto g = [](const double t) { return std::sin(3. * t); };
  for (const auto &settings : second_order_schemes)
    {
      TimeScheme scheme(settings, Order::second);
      Motion     motion = second_order_start(0., 3., 0.);
      for (unsigned int k = 0; k < 10; ++k)
        {
          const double t = .1 * k, t_next = .1 * (k + 1);
          const Stage  stage = scheme.stage(0, t, t_next, motion);
          EXPECT_NEAR(stage.t, t_next - .1 * stage.start_weight, 1e-15);
          scheme.finish_stage(0, stage,
                              number((1. - stage.start_weight) * g(t_next) + stage.start_weight * of(motion.u)));
          motion = scheme.end(t, t_next, motion);
          EXPECT_NEAR(of(motion.u), g(t_next), 1e-13);
        }
    }
}

TEST(TimeScheme, StaticsHasOneStageWithoutVelocities)
{
  TimeScheme  scheme({}, Order::statics);
  const auto  start = first_order_start(1.);
  const Stage stage = scheme.stage(0, 0., 2., start);
  EXPECT_EQ(scheme.n_stages(), 1u);
  EXPECT_EQ(stage.t, 2.);
  EXPECT_EQ(stage.v_known.size() + stage.a_known.size(), 0u);
  scheme.finish_stage(0, stage, number(5.));
  const Motion end = scheme.end(0., 2., start);
  EXPECT_EQ(of(end.u), 5.);
  EXPECT_EQ(end.v.size() + end.a.size(), 0u);
}

namespace
{
  TimeSchemeSettings
  read(const std::string &text, const Order order)
  {
    const auto         file = ParameterFile::parse(text, "test.prm");
    Parameters         p(file);
    TimeSchemeSettings settings;
    settings.add(p, order);
    p.finish();
    return settings;
  }

  std::string
  message_of(const std::string &text, const Order order)
  {
    try
      {
        read(text, order);
      }
    catch (const UserError &error)
      {
        return error.what();
      }
    return "no error";
  }
} // namespace

TEST(TimeSchemeEntries, ChooseAmongSchemesOfTheOrder)
{
  EXPECT_EQ(read("", Order::first).name, SchemeName::sdirk2);
  EXPECT_EQ(read("set Scheme = SDIRK 3\n", Order::first).name, SchemeName::sdirk3);
  EXPECT_EQ(read("", Order::second).name, SchemeName::generalized_alpha);
  EXPECT_EQ(read("set Scheme = Newmark\n", Order::second).name, SchemeName::newmark);
  EXPECT_EQ(read("set Spectral radius = .5\n", Order::second).spectral_radius, .5);
  EXPECT_EQ(message_of("set Scheme = Newmark\n", Order::first),
            "test.prm:1: 'Scheme' was given as 'Newmark'; it must be one of: backward Euler, SDIRK 2, SDIRK 3");
  EXPECT_EQ(message_of("set Spectral radius = 1.1\n", Order::second),
            "test.prm:1: 'Spectral radius' was given as '1.1'; it must be a number in [0, 1]");
  EXPECT_EQ(message_of("set Scheme = SDIRK 2\n", Order::statics).rfind("test.prm:1: 'Scheme' is not a parameter", 0),
            0u);
}
