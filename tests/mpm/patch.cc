// Affine displacement of the boundary: the inside must follow exactly, and Newton must converge quadratically.

#include "../base/keep_largest.h"
#include "fixture.h"
#include "solve.h"

#include <gtest/gtest.h>

namespace
{
  using namespace Stroma;

  template <int dim>
  std::string
  one_material_patch(const std::string &displacement, const std::string &mpm)
  {
    const std::string corner = dim == 2 ? "1, 1" : "1, 1, 1";
    std::string       text   = "subsection Materials\n subsection gel\n set Law = neo-Hookean\n set Shear modulus = 2\n"
                               " set Bulk modulus = 5\n end\nend\n"
                               "subsection Bodies\n subsection block\n set Shape = box\n set Upper corner = " +
                       corner + "\n end\nend\nsubsection Supports\n";
    for (const std::string &axis :
         dim == 2 ? std::vector<std::string>{"x", "y"} : std::vector<std::string>{"x", "y", "z"})
      for (const std::string end : {"min", "max"})
        text += " subsection " + axis + end + "\n set Where = side " + axis + "-" + end +
                "\n set Displacement = " + displacement + "\n end\n";
    return text + "end\nsubsection MPM\n" + mpm + "end\n";
  }

  template <int dim>
  void
  check_patch(const std::string &text)
  {
    SystemFixture<dim> s(text);
    Vector             u;
    const auto         residuals = solve_exactly(s, u);

    double worst = 0;
    s.system->for_each_cell(u, [&](const auto &, const Mpm::GatheredPoints<dim> &p) {
      for (unsigned int q = 0; q < p.size; ++q)
        keep_largest(worst, (p.displacement(q) - s.scene.supports[0].displacement.value(p.location[q], 1.)).norm());
      return StepStatus::ok;
    });
    EXPECT_LT(worst, 1e-12);

    std::cout << "largest error " << worst << ", residuals";
    for (const double r : residuals)
      std::cout << ' ' << r;
    std::cout << std::endl;
  }

  TEST(Patch, MpiAffineBoundaryGivesAffineInsideIn2D)
  {
    check_patch<2>(
      one_material_patch<2>("0.2*x+0.1*y; -0.1*x+0.15*y", " set Cells = 5, 4\n set Points per cell = 3, 2\n"));
  }

  TEST(Patch, MpiAffineBoundaryGivesAffineInsideIn3D)
  {
    check_patch<3>(one_material_patch<3>("0.2*x+0.1*y; -0.1*x+0.15*z; 0.05*z-0.1*x",
                                         " set Cells = 3, 4, 3\n set Points per cell = 2, 2, 3\n"));
  }

  TEST(Patch, MpiAffineBoundaryGivesAffineInsideWithProjectedDilatation)
  {
    check_patch<2>(
      one_material_patch<2>("0.2*x+0.1*y; -0.1*x+0.15*y",
                            " set Cells = 5, 4\n set Points per cell = 3, 2\n set Dilatation = projected\n"));
    check_patch<3>(one_material_patch<3>("0.2*x+0.1*y; -0.1*x+0.15*z; 0.05*z-0.1*x",
                                         " set Cells = 3, 4, 3\n set Dilatation = projected\n"));
  }

  TEST(Patch, MpiAffineBoundaryGivesAffineInsideWithQuadraticBSplines)
  {
    const std::string splines = " set Shape functions = quadratic B-spline\n";
    check_patch<2>(one_material_patch<2>("0.2*x+0.1*y; -0.1*x+0.15*y",
                                         " set Cells = 5, 4\n set Points per cell = 3, 2\n" + splines));
    check_patch<3>(
      one_material_patch<3>("0.2*x+0.1*y; -0.1*x+0.15*z; 0.05*z-0.1*x", " set Cells = 3, 4, 1\n" + splines));
  }

  TEST(Newton, MpiConvergesQuadraticallyOnTwoMaterials)
  {
    SystemFixture<2> s(two_material_box(2, "subsection Supports\n subsection bottom\n  set Where = side y-min\n"
                                           "  set Type = clamp\n end\n subsection top\n  set Where = side y-max\n"
                                           "  set Displacement = 0.1; 0.3\n end\nend\n"
                                           "subsection MPM\n set Cells = 8, 8\nend\n"));
    Vector           u;
    const auto       residuals = solve_exactly(s, u);

    // In the basin of attraction, while above round-off: r_{k+1} <= C r_k^2 with one C.
    unsigned int checked = 0;
    std::cout << "residuals over internal force:";
    for (const double r : residuals)
      std::cout << ' ' << r;
    std::cout << std::endl;
    for (std::size_t k = 0; k + 1 < residuals.size(); ++k)
      {
        const double now = residuals[k], next = residuals[k + 1];
        if (now < .1 && now > 1e-7)
          {
            EXPECT_LT(next, 20 * now * now + 1e-13);
            ++checked;
          }
      }
    EXPECT_GE(checked, 2u);
  }
} // namespace
