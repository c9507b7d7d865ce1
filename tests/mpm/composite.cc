// Composite cells and two-moment points: tangent, layers that cut cells, against all points.

#include "differences.h"
#include "solve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace
{
  using namespace Stroma;

  const std::string composite = " set Interface = composite cells\n", bonded = " set Interface = bonded points\n",
                    two_moments = " set Integration = two moments\n";

  template <int dim>
  void
  check_composite_tangent(const std::string &mpm)
  {
    SystemFixture<dim> s(two_material_box(dim, "subsection MPM\n" + composite + mpm + "end\n"));
    Vector             u = s.system->new_vector();
    std::mt19937       random(5);
    for (auto &value : u)
      value = .1 * (random() / 4294967295. - .5);
    expect_tangent_of_forces(s, u);
  }

  TEST(CompositeCells, TangentIsThatOfTheForces)
  {
    check_composite_tangent<2>(" set Cells = 3, 2\n set Points per cell = 3, 2\n");
    check_composite_tangent<3>(" set Cells = 2, 2, 1\n set Points per cell = 2, 3, 2\n");
    check_composite_tangent<3>(" set Cells = 2, 1, 1\n set Points per cell = 4, 4, 4\n" + two_moments);
    check_composite_tangent<2>(" set Cells = 3, 2\n set Shape functions = quadratic B-spline\n");
  }

  constexpr double share_soft = .37, stretch = 1.3;

  /// A unit square in two layers, soft below .37 m along @p axis, between smooth walls, stretched along y by 30 %; force [N].
  double
  layers(const unsigned int axis, const std::string &mpm, std::vector<double> *residuals = nullptr)
  {
    const std::string upper = axis == 0 ? "0.37, 1" : "1, 0.37";
    SystemFixture<2>  s(
       "subsection Materials\n"
        " subsection soft\n set Law = neo-Hookean\n set Shear modulus = 1\n set Bulk modulus = 2\n end\n"
        " subsection stiff\n set Law = neo-Hookean\n set Shear modulus = 30\n set Bulk modulus = 50\n end\n"
        "end\n"
        "subsection Bodies\n"
        " subsection all\n set Shape = box\n set Upper corner = 1, 1\n set Material = stiff\n end\n"
        " subsection part\n set Shape = box\n set Upper corner = " +
       upper +
       "\n set Material = soft\n end\nend\n"
        "subsection Supports\n"
        " subsection left\n set Where = side x-min\n set Displacement = 0; free\n end\n"
        " subsection right\n set Where = side x-max\n set Displacement = 0; free\n end\n"
        " subsection below\n set Where = side y-min\n set Displacement = free; 0\n end\n"
        " subsection above\n set Where = side y-max\n set Displacement = free; 0.3*t\n end\nend\n"
        "subsection MPM\n set Cells = 4, 4\n set Points per cell = 4, 4\n" +
       mpm + "end\n");
    Vector     u;
    const auto history = solve_exactly(s, u);
    if (residuals != nullptr)
      *residuals = history;
    Vector r = u;
    s.system->residual(r, u);
    return s.system->reactions()[3][1];
  }

  /// P_ii of the uncoupled neo-Hookean law (12) where the principal stretches are l, other and 1.
  double
  first_piola(const double l, const double other, const double mu, const double kappa)
  {
    const double J = l * other, trace = l * l + other * other + 1.;
    return (mu * std::pow(J, -2. / 3.) * (l * l - trace / 3.) + kappa * std::log(J)) / l;
  }

  /// Where @p f, which grows, is zero.
  template <typename F>
  double
  root(const F &f, double low, double high)
  {
    for (unsigned int i = 0; i < 200; ++i)
      (f((low + high) / 2) > 0. ? high : low) = (low + high) / 2;
    return (low + high) / 2;
  }

  TEST(CompositeCells, LayersInSeriesAreExact)
  {
    const auto   stiff_stretch = [](const double soft) { return (stretch - share_soft * soft) / (1. - share_soft); };
    const double soft          = root(
      [&](const double l) { return first_piola(l, 1., 1, 2) - first_piola(stiff_stretch(l), 1., 30, 50); }, .5, 3.);
    const double exact = first_piola(soft, 1., 1, 2);
    for (const auto &points : {std::string(), two_moments})
      {
        std::vector<double> residuals;
        EXPECT_NEAR(layers(1, composite + points, &residuals), exact, 1e-9 * exact);
        ASSERT_GE(residuals.size(), 3u);
        EXPECT_LT(residuals.size(), 9u); // quadratic
      }
    EXPECT_GT(layers(1, bonded + two_moments), 1.1 * exact);
  }

  TEST(CompositeCells, LayersInParallelAreExact)
  {
    const auto   other = [](const double soft) { return (1. - share_soft * soft) / (1. - share_soft); };
    const double soft  = root(
      [&](const double l) { return first_piola(l, stretch, 1, 2) - first_piola(other(l), stretch, 30, 50); }, .2, 2.);
    const double exact = share_soft * first_piola(stretch, soft, 1, 2) +
                         (1. - share_soft) * first_piola(stretch, other(soft), 30, 50);
    EXPECT_NEAR(layers(0, composite), exact, 1e-9 * exact);
    EXPECT_NEAR(layers(0, composite + two_moments), exact, 1e-9 * exact);
    EXPECT_GT(std::abs(layers(0, bonded + two_moments) / exact - 1.), 1e-4);
  }

  TEST(CompositeCells, AreTakenByDefaultWhereTheyCanBe)
  {
    const auto choice = [](const std::string &mpm, const std::string &stiff = "neo-Hookean") {
      std::string text = two_material_box(2, "subsection MPM\n set Cells = 2, 2\n" + mpm + "end\n");
      text.replace(text.rfind("neo-Hookean"), 11, stiff);
      const SystemFixture<2> s(text);
      return std::pair(s.settings.composite, s.settings.about_interfaces);
    };
    const std::string is_composite = "cells that hold two materials are composite",
                      is_bonded    = "points of two materials in a cell are bonded";
    for (const auto &mpm : {"", " set Shape functions = quadratic B-spline\n", " set Integration = two moments\n"})
      EXPECT_EQ(choice(mpm), std::pair(true, is_composite)) << mpm;
    for (const auto &mpm : {" set Grid reset = when distorted\n", " set Internal force = published\n",
                            " set Dilatation = projected\n", " set Points at = Gauss points\n"})
      EXPECT_EQ(choice(mpm), std::pair(false, is_bonded)) << mpm;
    EXPECT_EQ(choice("", "neo-Hookean\n set Viscosity = 1"), std::pair(false, is_bonded));
    EXPECT_EQ(choice(bonded), std::pair(false, std::string()));
    EXPECT_EQ(choice(composite), std::pair(true, std::string()));
  }

  TEST(CompositeCells, AreNothingToSceneOfOneMaterial)
  {
    const SystemFixture<2> s(
      "subsection Materials\n subsection gel\n set Law = neo-Hookean\n set Shear modulus = 1\n"
      " set Bulk modulus = 2\n end\nend\nsubsection Bodies\n subsection block\n set Shape = box\n"
      " set Upper corner = 1, 1\n set Material = gel\n end\nend\n"
      "subsection MPM\n set Cells = 2, 2\nend\n");
    EXPECT_FALSE(s.settings.composite);
    EXPECT_EQ(s.settings.about_interfaces, "");
  }

  TEST(TwoMomentPoints, AreAsGoodAsAllPointsWhereTheLawIsLinear)
  {
    const auto unbalanced = [](const std::string &mpm) {
      SystemFixture<2> s(
        "subsection Materials\n"
        " subsection soft\n set Law = linear elastic\n set Shear modulus = 1\n set Bulk modulus = 2\n end\n"
        " subsection stiff\n set Law = linear elastic\n set Shear modulus = 3\n set Bulk modulus = 7\n end\nend\n"
        "subsection Bodies\n subsection matrix\n set Shape = box\n set Upper corner = 1, 1\n set Material = soft\n end\n"
        " subsection inclusion\n set Shape = ball\n set Centre = 0.4, 0.5\n set Radius = 0.3\n set Material = stiff\n"
        " end\nend\nsubsection MPM\n set Cells = 3, 2\n set Points per cell = 7, 6\n" +
        mpm + "end\n");
      Vector       u = s.system->new_vector(), r = u;
      std::mt19937 random(5);
      for (auto &value : u)
        value = 1e-7 * (random() / 4294967295. - .5);
      s.system->residual(r, u);
      return Vector(s.system->unbalanced_forces());
    };
    const Vector all = unbalanced("");
    for (const auto &interface : {bonded, composite})
      {
        Vector difference = unbalanced(interface + two_moments);
        difference -= unbalanced(interface);
        EXPECT_LT(difference.linfty_norm(),
                  3e-8 * all.linfty_norm()); // strains of 1e-7: what is not linear, and round-off
      }
  }

  TEST(TwoMomentPoints, KeepMomentsOfTheSecondOrder)
  {
    SystemFixture<3> s(
      two_material_box(3, "subsection MPM\n set Cells = 2, 2, 1\n set Points per cell = 5, 4, 3\nend\n"));
    Mpm::TwoMomentPoints<3> standing;
    const auto              size = s.grid->box().cell_size;
    for (const auto &active : s.grid->active_cells())
      standing.add_cell(*s.points, active, Mpm::cell_moments(*s.points, active, size, 2, false), size);
    standing.finish(*s.points);
    ASSERT_FALSE(standing.empty());
    for (const auto &active : s.grid->active_cells())
      {
        const auto moments = Mpm::cell_moments(*s.points, active, size, 2, false).of_material;
        standing.for_parts(active.number, [&](const auto &part) {
          Solid::Moments<3> few;
          for (unsigned int p = part.begin; p < part.end; ++p)
            {
              dealii::Tensor<1, 3> x;
              for (unsigned int d = 0; d < 3; ++d)
                x[d] = (standing.xi[p][d] - .5) * size[d];
              few.add(standing.V[p], x);
            }
          const auto &all = moments[part.material];
          EXPECT_LE(part.end - part.begin, 8u);
          EXPECT_NEAR(few.volume(), all.volume(), 1e-15);
          EXPECT_LT((few.centroid() - all.centroid()).norm(), 1e-14);
          EXPECT_LT((few.covariance() - all.covariance()).norm(), 1e-14);
        });
      }
  }
} // namespace
