// Projected dilatation: consistent tangent, patch test, and a bonded strip that locks without it.

#include "differences.h"
#include "solve.h"

#include <gtest/gtest.h>

#include <random>

namespace
{
  using namespace Stroma;

  /// The tangent against central differences, to their accuracy, and its symmetry.
  template <int dim>
  void
  check_tangent(const std::string &mpm, const bool prior_deformation)
  {
    SystemFixture<dim> s(two_material_box(dim, "subsection MPM\n set Dilatation = projected\n" + mpm + "end\n"));
    Vector             u = s.system->new_vector();
    std::mt19937       random(5);
    for (auto &value : u)
      value = .15 * (random() / 4294967295. - .5);
    if (prior_deformation)
      {
        s.system->rebase_points(u, false);
        for (auto &value : u)
          value = .1 * (random() / 4294967295. - .5);
      }
    expect_tangent_of_forces(s, u);
  }

  TEST(ProjectedDilatation, TangentIsThatOfTheForces)
  {
    check_tangent<2>(" set Cells = 3, 2\n set Points per cell = 3, 2\n", false);
    check_tangent<3>(" set Cells = 2, 1, 1\n set Points per cell = 2, 3, 2\n", false);
    check_tangent<2>(" set Cells = 3, 2\n set Grid reset = always\n", true);
    check_tangent<3>(" set Cells = 2, 1, 1\n set Grid reset = always\n", true);
  }

  /// Force that squeezes a bonded strip of 2 x 1 m by 1 % (mu = 1000 Pa) [N].
  double
  strip(const std::string &nu, const std::string &mpm)
  {
    SystemFixture<2> s("subsection Materials\n subsection pad\n set Law = neo-Hookean\n set Shear modulus = 1000\n"
                       " set Poisson's ratio = " +
                       nu +
                       "\n end\nend\n"
                       "subsection Bodies\n subsection pad\n set Shape = box\n set Upper corner = 2, 1\n end\nend\n"
                       "subsection Supports\n subsection below\n set Where = side y-min\n set Type = clamp\n end\n"
                       " subsection above\n set Where = side y-max\n set Displacement = 0; -0.01*y*t\n end\nend\n"
                       "subsection MPM\n set Cells = 16, 8\n" +
                       mpm + "end\n");
    Vector           u;
    solve_exactly(s, u);
    Vector r = u;
    s.system->residual(r, u);
    return s.system->reactions()[0][1];
  }

  TEST(ProjectedDilatation, NearlyIncompressibleStripDoesNotLock)
  {
    // Biquadratic elements with projected dilatation: 64.098, 148.37 and 162.85 N.
    EXPECT_NEAR(strip("0.3", " set Dilatation = projected\n"), 64.098, .01 * 64.1);
    EXPECT_NEAR(strip("0.49", " set Dilatation = projected\n"), 148.37, .03 * 148);
    EXPECT_NEAR(strip("0.4999", " set Dilatation = projected\n"), 162.85, .04 * 163);
    EXPECT_NEAR(strip("0.4999", " set Dilatation = projected\n set Points per cell = 4, 4\n"), 162.85, .04 * 163);
    EXPECT_GT(strip("0.4999", ""), 800);
  }
} // namespace
