// Viscosity and laws with history on material points: against finite elements, which have a cell loop of their own, against
// closed formulas, and the tangent against differences.

#include "../base/keep_largest.h"
#include "differences.h"
#include "method_fixture.h"

#include <stroma/output/point_results.h>

#include <gtest/gtest.h>

#include <random>

namespace
{
  using namespace Stroma;

  const std::string elastic = "  set Shear modulus = 2\n  set Bulk modulus = 5\n";

  /// A square of material @p gel.
  std::string
  square(const std::string &gel, const std::string &more)
  {
    return "subsection Materials\n subsection gel\n" + gel +
           " end\nend\nsubsection Bodies\n subsection block\n  set Shape = box\n  set Upper corner = 1, 1\n end\nend\n" +
           more;
  }

  const std::string sheared =
    "subsection Supports\n subsection bottom\n  set Where = side y-min\n  set Type = clamp\n end\n"
    " subsection top\n  set Where = side y-max\n  set Displacement = 0.2*t*t; 0.1*sin(3*t)\n end\nend\n"
    "subsection Loads\n subsection weight\n  set Where = all\n  set Force density = 0.3*t; -0.5*sin(2*t)\n end\nend\n"
    "subsection Newton\n set Displacement tolerance = 1e-11\n set Energy tolerance = 1e-20\nend\n"
    "subsection Linear solver\n set Tolerance = 1e-12\nend\n";

  /// Largest difference of results between material points at Gauss points and bilinear elements, over their size.
  double
  difference_from_elements(const std::string &gel, const std::string &more = "")
  {
    const std::string text = square(gel, sheared +
                                           "subsection MPM\n set Cells = 4, 3\n set Points at = Gauss points\n" + more +
                                           "end\nsubsection FEM\n set Cells = 4, 3\n set Degree = 1\n" + more +
                                           "end\n");
    MethodFixture     mpm(text, "mpm"), fem(text, "fem");
    EXPECT_TRUE(mpm.advance(0., 1., 5));
    EXPECT_TRUE(fem.advance(0., 1., 5));
    const auto a = mpm.scalars(), b = fem.scalars();
    double     worst = 0;
    for (const auto &name : {"reaction_bottom_x_N", "reaction_bottom_y_N", "reaction_top_y_N", "strain_energy_J"})
      keep_largest(worst, std::abs(a.at(name) / b.at(name) - 1.));
    Output::Summary of_mpm, of_fem;
    mpm.method->describe(of_mpm);
    Output::add_point_results(*mpm.method->state(), {}, MPI_COMM_WORLD, of_mpm.results);
    fem.method->describe(of_fem);
    Output::add_point_results(*fem.method->state(), {}, MPI_COMM_WORLD, of_fem.results);
    for (const auto &[name, value] : of_mpm.results) // of the points' stresses, viscous part included
      if (name.find("von_mises") == 0)
        keep_largest(worst, std::abs(value / of_fem.results.at(name) - 1.));
    return worst;
  }

  TEST(Viscous, MpiMaterialPointsAtGaussPointsAreBilinearElements)
  {
    if (!MethodFixture::has("fem"))
      GTEST_SKIP() << "a build without finite elements";
    for (const std::string op : {"central", "morris", "deviatoric"})
      for (const std::string scheme : {"backward Euler", "SDIRK 2", "SDIRK 3"})
        EXPECT_LT(difference_from_elements(elastic + "  set Viscosity = 0.7\n  set Viscous operator = " + op + "\n",
                                           " set Scheme = " + scheme + "\n"),
                  1e-8)
          << op << ' ' << scheme;
  }

  TEST(History, MpiMaterialPointsAtGaussPointsAreBilinearElements)
  {
    if (!MethodFixture::has("fem"))
      GTEST_SKIP() << "a build without finite elements";
    EXPECT_LT(difference_from_elements("  set Law = Prony\n" + elastic +
                                       "  set Relaxation times = 0.3, 2\n  set Shear parts g = 0.2, 0.4\n"
                                       "  set Bulk parts k = 0.1, 0.3\n"),
              1e-8);
  }

  /// What is left after .7 s of the force at .2 s, of a bar that is stretched until .1 s, its sides at walls, and held.
  double
  relaxation(const std::string &policy)
  {
    MethodFixture s(square("  set Law = Prony\n" + elastic +
                             "  set Relaxation times = 0.5\n  set Shear parts g = 0.4\n"
                             "  set Bulk parts k = 0.2\n",
                           "subsection Supports\n"
                           " subsection bottom\n  set Where = side y-min\n  set Displacement = free; 0\n end\n"
                           " subsection x0\n  set Where = side x-min\n  set Displacement = 0; free\n end\n"
                           " subsection x1\n  set Where = side x-max\n  set Displacement = 0; free\n end\n"
                           " subsection top\n  set Where = layer y-max 0.25\n"
                           "  set Displacement = free; 0.02*y*min(1,t/0.1)\n end\nend\n"
                           "subsection MPM\n set Cells = 4, 4\n set Margin above = 0, 0.5\n set Penalty = 1e7\n"
                           " set Grid reset = " +
                             policy +
                             "\nend\nsubsection Newton\n set Displacement tolerance = 1e-12\n"
                             " set Energy tolerance = 1e-22\nend\n"),
                    "mpm");
    EXPECT_TRUE(
      s.advance(0., .2, 2)); // a reset changes the force by what it changes the cells' filling, so after the first
    const double then = s.scalars().at("reaction_bottom_y_N");
    EXPECT_TRUE(s.advance(.2, .7, 5));
    return s.scalars().at("reaction_bottom_y_N") / then;
  }

  // M(.7)/M(.2), M = K + 4/3 G, of a strain that grows evenly over the first step of .1 s = tau/5. (No point crosses into
  // another cell, which would change the force by itself.)
  TEST(History, MpiResetsOfTheGridLeaveRelaxationAsItIs)
  {
    const double G_0 = 2. / (1. - .4), K_0 = 5. / (1. - .2), relaxed = 5. + 4. / 3. * 2.;
    const double spring = (K_0 * .2 + 4. / 3. * G_0 * .4) * (1. - std::exp(-.2)) / .2;
    const double exact  = (relaxed + spring * std::exp(-.6 / .5)) / (relaxed + spring * std::exp(-.1 / .5));
    EXPECT_NEAR(relaxation("never"), exact, 1e-5);
    EXPECT_NEAR(relaxation("always"), exact, 1e-5);
  }

  /// Largest difference between the tangent and central differences of the residual, over its largest entry.
  template <int dim>
  double
  error_of_tangent(const std::string &gel, const std::string &mpm, const Solvers::Stage &times)
  {
    const std::string  corner = dim == 2 ? "1, 1" : "1, 1, 1", zero = dim == 2 ? "" : "; free";
    SystemFixture<dim> s(
      "subsection Materials\n subsection gel\n" + gel +
      " end\nend\nsubsection Bodies\n subsection block\n  set Shape = box\n  set Upper corner = " + corner +
      "\n end\nend\nsubsection Supports\n subsection top\n  set Where = layer y-max 0.3\n"
      "  set Displacement = free; 0.1*t" +
      zero + "\n end\nend\nsubsection MPM\n set Penalty = 10\n" + mpm + "end\n");
    std::mt19937 random(5);
    const auto   randomise = [&](Vector &x, const double size) {
      for (auto &value : x)
        value = size * (random() / 4294967295. - .5);
    };
    Vector u = s.system->new_vector(), r = u;
    if (s.points->deformation.stored()) // give the points a deformation of their own
      {
        randomise(u, .1);
        s.system->rebase_points(u, false);
      }
    for (auto &point : s.points->handler) // and a history
      for (unsigned int i = 0; i < s.points->history.components; ++i)
        point.get_properties()[s.points->history.first + i] = .02 * (random() / 4294967295. - .5);
    Solvers::Stage stage = times;
    stage.v_known        = u;
    randomise(stage.v_known, .3);
    s.system->set_stage(stage, 0.);
    randomise(u, .1);
    Matrix K;
    EXPECT_EQ(s.system->residual(r, u), StepStatus::ok);
    EXPECT_EQ(s.system->tangent(K, r, u), StepStatus::ok);
    const auto [worst, skew, scale] = tangent_errors(*s.system, K, u);
    EXPECT_EQ(s.system->symmetric(), skew < 1e-12 * scale); // the solver is chosen by that
    return worst / scale;
  }

  TEST(Tangent, EqualsDifferencesWithViscosityAndHistory)
  {
    Solvers::Stage inner, last, step;
    inner.v_factor = 4.;
    inner.dt       = .3;
    inner.is_last  = false;
    last           = inner;
    last.is_last   = true;
    step.t = step.dt          = .3;
    const std::string viscous = elastic + "  set Viscosity = 0.7\n  set Viscous operator = ";
    for (const std::string op : {"central", "morris", "deviatoric"})
      for (const std::string more : {"", " set Grid reset = always\n", " set Dilatation = projected\n"})
        {
          EXPECT_LT(error_of_tangent<2>(viscous + op + "\n", " set Cells = 3, 2\n" + more, last), 1e-8) << op << more;
          EXPECT_LT(error_of_tangent<2>(viscous + op + "\n", " set Cells = 3, 2\n" + more, inner), 1e-8) << op << more;
        }
    EXPECT_LT(error_of_tangent<3>(viscous + "central\n", " set Cells = 2, 1, 1\n set Grid reset = always\n", last),
              1e-8);
    const std::string prony = "  set Law = Prony\n" + elastic +
                              "  set Relaxation times = 0.3, 2\n"
                              "  set Shear parts g = 0.2, 0.4\n  set Bulk parts k = 0.1, 0.3\n";
    EXPECT_LT(error_of_tangent<2>(prony, " set Cells = 3, 2\n set Grid reset = always\n", step), 1e-8);
    EXPECT_LT(error_of_tangent<3>(prony, " set Cells = 2, 1, 1\n", step), 1e-8);
  }
} // namespace
