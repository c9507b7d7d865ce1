// Loads: the forces on the unknowns add up to the load, and so do their moments; cells that a region cuts; bad input.

#include "solid_fixture.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;

  template <int dim>
  struct LoadFixture : PartsFixture<dim>
  {
    /// @param load entries of the load
    LoadFixture(const std::string &load, const std::string &fem, const std::string &body = "  set Shape = box\n")
      : PartsFixture<dim>((dim == 2 ? "set Thickness = 0.5\n" : "") + gel() + one("Bodies", "block", body) +
                          one("Loads", "push", load) + "subsection FEM\n" + fem + "end\n")
    {
      this->number();
      loads = std::make_unique<Fem::Loads<dim>>(this->scene, this->settings, this->mesh, this->space(),
                                                this->unknowns->loaded_singly());
    }

    /// Force and its moment about the origin (about z) at time @p t.
    std::array<double, dim + 1>
    total(const double t = 1.)
    {
      Vector force(this->unknowns->owned, MPI_COMM_WORLD);
      loads->assemble(t, force);
      std::array<double, dim + 1> sum{};
      for (const auto &[dof, component, X] : this->unknowns->owned_nodes())
        {
          sum[component] += force(dof);
          sum[dim] += component == 0 ? -X[1] * force(dof) : component == 1 ? X[0] * force(dof) : 0.;
        }
      for (double &part : sum)
        part = dealii::Utilities::MPI::sum(part, MPI_COMM_WORLD);
      return sum;
    }

    std::unique_ptr<Fem::Loads<dim>> loads;
  };

  const std::string cells_2d = " set Cells = 5, 4\n", cells_3d = " set Cells = 3, 2, 2\n";
  const std::string hanging =
    " subsection Refinement\n  subsection spot\n   set Where = nearest 0.3, 0.3\n   set Levels = 2\n"
    "  end\n end\n";

  TEST(MpiLoads, TheTotalIsExactWhateverTheRegionCuts)
  {
    for (const std::string where :
         {"all", "ball 0.43, 0.52 : 0.3", "ball 0.3, 0.37 : 0.04", "ball 1, 0.4 : 0.2", "box 0.1, 0.1 : 0.33, 0.77",
          "layer x-max 0.07", "layer y-min 0.4", "side x-max", "side y-min", "nearest 0.31, 0.68", "material gel"})
      for (const std::string &fem : {cells_2d, cells_2d + hanging, cells_2d + " set Degree = 1\n" + hanging})
        {
          LoadFixture<2> s("  set Where = " + where + "\n  set Total force = 3*t; -2*t\n", fem);
          for (const double t : {1., .5, 1.})
            {
              const auto sum = s.total(t);
              EXPECT_NEAR(sum[0], 3. * t, 1e-11) << where << fem;
              EXPECT_NEAR(sum[1], -2. * t, 1e-11) << where << fem;
            }
        }
    for (const std::string where :
         {"all", "ball 0.43, 0.52, 0.5 : 0.3", "box 0, 0, 0 : 0.3, 0.3, 0.3", "side z-max", "nearest 0, 0.4, 1"})
      {
        LoadFixture<3> s("  set Where = " + where + "\n  set Total force = 1; 2; 3\n", cells_3d + " set Degree = 1\n");
        const auto     sum = s.total();
        for (unsigned int c = 0; c < 3; ++c)
          EXPECT_NEAR(sum[c], c + 1., 1e-11) << where;
      }
  }

  TEST(MpiLoads, MomentsAreThoseOfTheRegion)
  {
    // A uniform force along y acts at the region's centre: exactly where cells fit it, else to the fine quadrature.
    const std::map<std::string, std::pair<double, double>> centre{{"all", {.5, 1e-13}},
                                                                  {"side y-max", {.5, 1e-13}},
                                                                  {"side x-max", {1., 1e-13}},
                                                                  {"layer x-min 0.4", {.2, 1e-13}},
                                                                  {"box 0.2, 0 : 0.6, 0.5", {.4, 1e-13}},
                                                                  {"ball 0.43, 0.52 : 0.3", {.43, 1e-4}},
                                                                  {"ball 0.3, 0.37 : 0.04", {.3, 1e-4}},
                                                                  {"layer x-max 0.07", {.965, 1e-3}}};
    for (const auto &[where, place] : centre)
      {
        LoadFixture<2> s("  set Where = " + where + "\n  set Total force = 0; 3\n", cells_2d + hanging);
        EXPECT_NEAR(s.total()[2], 3. * place.first, 3. * place.second) << where;
      }
  }

  TEST(MpiLoads, DensitiesAndTractionsAreIntegrated)
  {
    // Thickness 0.5 m. int x y = 1/4, int x^2 y = 1/6, with degree 2 exactly.
    auto sum = LoadFixture<2>("  set Where = all\n  set Force density = x*y; 0\n", cells_2d).total();
    EXPECT_NEAR(sum[0], .5 / 4., 1e-14);
    EXPECT_NEAR(sum[2], -.5 / 6., 1e-14);
    sum = LoadFixture<2>("  set Where = side x-max\n  set Traction = 0; y^2\n", cells_2d + hanging).total();
    EXPECT_NEAR(sum[1], .5 / 3., 1e-14);
    EXPECT_NEAR(sum[2], .5 / 3., 1e-14);
    sum = LoadFixture<2>("  set Where = ball 0.43, 0.52 : 0.3\n  set Force density = 1; 0\n", cells_2d).total();
    EXPECT_NEAR(sum[0], .5 * M_PI * .09, 1e-3 * .5 * M_PI * .09);
    sum = LoadFixture<2>("  set Where = ball 0.3, 0.37 : 0.04\n  set Force density = 1; 0\n", cells_2d).total();
    EXPECT_NEAR(sum[0], .5 * M_PI * .0016, 2e-2 * .5 * M_PI * .0016); // a fifth of a cell
    // A pressure inside a quarter of a ring: p r_i along both axes.
    const std::string ring = "  set Shape = ring\n  set Centre = 0, 0\n  set Inner radius = 1\n  set Outer radius = 2\n"
                             "  set Angles = 0, 90\n";
    sum = LoadFixture<2>("  set Where = rim 0, 0 : 1\n  set Traction = 3*x; 3*y\n", " set Cells = 2, 8\n", ring)
            .total();
    EXPECT_NEAR(sum[0], .5 * 3., 1e-5);
    EXPECT_NEAR(sum[1], .5 * 3., 1e-5);
    const auto in_space = LoadFixture<3>("  set Where = side z-max\n  set Traction = 0; 0; x*y\n", cells_3d).total();
    EXPECT_NEAR(in_space[2], .25, 1e-14);
  }

  TEST(MpiLoads, ALoadOutsideTheBodiesIsRefused)
  {
    try
      {
        LoadFixture<2>("  set Where = ball 7, 7 : 1\n  set Total force = 1; 0\n", cells_2d);
        FAIL();
      }
    catch (const UserError &error)
      {
        EXPECT_EQ(std::string(error.what()),
                  "test.prm:14: load 'push' (ball 7, 7 : 1) selects no part of the mesh; enlarge it or "
                  "move it into the bodies");
      }
  }
} // namespace
