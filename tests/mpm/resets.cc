// What a reset of the grid leaves of a uniform deformation.

#include "../base/keep_largest.h"
#include "fixture.h"
#include "method_fixture.h"

#include <stroma/mpm/point_weights.h>

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace
{
  using namespace Stroma;

  /// A block between rollers whose upper side moves by @p stretch - 1 until t = 1.
  std::string
  stretched_block(const double stretch, const std::string &shapes)
  {
    return "subsection Materials\n subsection gel\n set Law = neo-Hookean\n set Shear modulus = 2\n set Bulk modulus = 5\n"
           " end\nend\nsubsection Bodies\n subsection block\n set Shape = box\n set Upper corner = 1, 1\n end\nend\n"
           "subsection Supports\n"
           " subsection left\n set Where = side x-min\n set Displacement = 0; free\n end\n"
           " subsection right\n set Where = side x-max\n set Displacement = 0; free\n end\n"
           " subsection bottom\n set Where = side y-min\n set Displacement = free; 0\n end\n"
           " subsection top\n set Where = side y-max\n set Displacement = free; " +
           std::to_string(stretch - 1.) +
           "*t\n end\nend\n"
           "subsection MPM\n set Cells = 4, 4\n set Margin above = 0, 3\n set Grid reset = always\n"
           " set Shape functions = " +
           shapes + "\nend\n";
  }

  /// Force on the upper side of a block of unit size stretched by @p J in confinement.
  double
  confined_force(const double J)
  {
    const double mu = 2., kappa = 5.;
    return (mu * std::pow(J, -2. / 3.) * (J * J - (2. + J * J) / 3.) + kappa * std::log(J)) / J;
  }

  TEST(Resets, MpiStretchAndCompressionKeepTheStressOfTheLaw)
  {
    for (const double stretch : {.3, .75, 1.3, 2.5})
      for (const char *shapes : {"linear", "quadratic B-spline"})
        {
          MethodFixture block(stretched_block(stretch, shapes), "mpm");
          ASSERT_TRUE(block.advance(0., 1., 12)) << shapes << ", " << stretch;
          EXPECT_NEAR(block.scalars().at("reaction_top_y_N") / confined_force(stretch), 1., 1.5e-3)
            << shapes << ", " << stretch;
          EXPECT_LT(block.scalars().at("reset_misfit"), 1e-3) << shapes << ", " << stretch;
        }
  }

  TEST(Resets, MpiManyResetsLeaveAUniformStretchAlone)
  {
    for (const char *shapes : {"linear", "quadratic B-spline"})
      {
        MethodFixture block(stretched_block(1.6, shapes), "mpm");
        ASSERT_TRUE(block.advance(0., 1., 150)) << shapes;
        EXPECT_NEAR(block.scalars().at("reaction_top_y_N") / confined_force(1.6), 1., 1e-4) << shapes;
        EXPECT_LT(block.scalars().at("reset_misfit"), 1e-4) << shapes;
      }
  }

  /// Deforms all points by F and puts them into their cells.
  void
  deform(SystemFixture<2> &s, const dealii::Tensor<2, 2> &F, const bool split)
  {
    auto &points = *s.points;
    for (auto &point : points.handler)
      {
        const auto values = point.get_properties();
        const auto X      = point.get_location();
        const auto x      = dealii::Point<2>(F * X);
        for (unsigned int i = 0; i < 2; ++i)
          {
            values[points.displacement.first + i] = x[i] - X[i];
            for (unsigned int k = 0; k < 2; ++k)
              values[points.deformation.first + 2 * i + k] = F[i][k];
          }
        point.set_location(x);
      }
    if (split)
      points.split_stretched([](unsigned int, bool) { return std::uint64_t(0); });
    points.move_to_their_cells();
    s.system->rebuild();
  }

  dealii::Tensor<2, 2>
  gradient(const double xx, const double xy, const double yx, const double yy)
  {
    dealii::Tensor<2, 2> F;
    F[0][0] = xx;
    F[0][1] = xy;
    F[1][0] = yx;
    F[1][1] = yy;
    return F;
  }

  TEST(PointWeights, MpiFullCellsAreIntegratedWhereverTheirPointsLie)
  {
    for (const auto &F : {gradient(.83, 0., 0., 1.07), gradient(1., .2, 0., .9)})
      {
        SystemFixture<2> s(stretched_block(1.3, "linear"));
        deform(s, F, false);
        Mpm::set_weights(*s.points, *s.grid);
        const double h       = .25;
        double       total   = 0;
        int          n_inner = 0;
        for (const auto &active : s.grid->active_cells())
          {
            double           volume = 0;
            dealii::Point<2> centre;
            for (const auto &point : s.points->handler.particles_in_cell(active.cell))
              {
                const auto   values = point.get_properties();
                const double v      = values[s.points->weight.first] * values[s.points->volume.first] * determinant(F);
                EXPECT_GT(values[s.points->weight.first], 0.);
                volume += v;
                for (unsigned int d = 0; d < 2; ++d)
                  centre[d] += v * point.get_reference_location()[d];
              }
            total += volume;
            bool is_inner = true;
            for (const unsigned int f : active.cell->face_indices())
              is_inner &= !active.cell->at_boundary(f) && s.grid->is_active(active.cell->neighbor(f));
            if (!is_inner)
              continue;
            ++n_inner;
            EXPECT_NEAR(volume / (h * h), 1., 1e-3);
            EXPECT_NEAR(centre[0] / volume, .5, .045);
            EXPECT_NEAR(centre[1] / volume, .5, .045);
          }
        EXPECT_NEAR(dealii::Utilities::MPI::sum(total, MPI_COMM_WORLD), determinant(F), 5e-3);
        EXPECT_GE(dealii::Utilities::MPI::sum(n_inner, MPI_COMM_WORLD), 2);
      }
  }

  TEST(PointWeights, MpiUniformStressIsBalancedInside)
  {
    for (const char *shapes : {"linear", "quadratic B-spline"})
      for (const auto &F : {gradient(.83, 0., 0., 1.07), gradient(1., 0., 0., 1.9), gradient(1.02, .1, -.05, .95)})
        {
          std::string text = stretched_block(1.3, shapes);
          text.replace(text.find("Cells = 4, 4\n set Margin above = 0, 3"), 37,
                       "Cells = 8, 8\n set Margin below = 1, 1\n set Margin above = 1, 1");
          SystemFixture<2> s(text);
          deform(s, F, true);
          Mpm::set_weights(*s.points, *s.grid);
          auto r = s.system->new_vector();
          ASSERT_EQ(s.system->residual(r, s.system->new_vector()), StepStatus::ok);
          const auto &unbalanced = s.system->unbalanced_forces();
          double      inside = 0, largest = 0;
          for (std::size_t i = 0; i < s.grid->nodes.n_nodes(); ++i)
            {
              const auto node = s.grid->nodes.node(i);
              if (!s.grid->nodes.owned.is_element(node.unknown))
                continue;
              const auto X = dealii::Point<2>(invert(F) * node.X);
              for (unsigned int c = 0; c < 2; ++c)
                {
                  const double force = std::abs(unbalanced(node.unknown + c));
                  keep_largest(largest, force);
                  if (std::min({X[0], X[1], 1. - X[0], 1. - X[1]}) > .31)
                    keep_largest(inside, force);
                }
            }
          inside  = dealii::Utilities::MPI::max(inside, MPI_COMM_WORLD);
          largest = dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD);
          EXPECT_LT(inside, 1e-12 * largest) << shapes << ", F = " << F;
        }
  }

  TEST(Resets, MpiMisfitIsZeroForQuadraticMotionsAndSeesGradientsThatAreNot)
  {
    SystemFixture<2> s(stretched_block(1.3, "linear"));
    auto            &points = *s.points;
    const double     bend = .3, spread = .2;
    for (const double off : {0., spread})
      {
        for (auto &point : points.handler)
          {
            const auto values = point.get_properties();
            const auto X      = points.initial_place(point.get_location(), values.data());
            // x = X + bend Y^2 e_x, with F_22 alternately too large and too small in each cell
            values[points.displacement.first]    = bend * X[1] * X[1];
            values[points.deformation.first + 1] = 2. * bend * X[1];
            const bool is_left                   = point.get_reference_location()[0] < .5;
            values[points.deformation.first + 3] = 1. + (is_left ? off : -off);
            point.set_location(dealii::Point<2>(X[0] + bend * X[1] * X[1], X[1]));
          }
        const double misfit = s.system->misfit(s.system->new_vector());
        if (off == 0.)
          EXPECT_LT(misfit, 1e-14);
        else
          EXPECT_NEAR(misfit, .5 * off / std::sqrt(2.), .01);
      }
  }

  TEST(PointSplitting, MpiHalvesKeepVolumeAndPlace)
  {
    SystemFixture<2> s(stretched_block(1.3, "linear"));
    deform(s, gradient(1., 0., 0., 2.5), true);
    EXPECT_EQ(s.points->handler.n_global_particles(), 8u * 8 * 4); // 1.25 cells, halved twice
    double           volume = 0, moment = 0;
    std::set<double> ids;
    for (const auto &point : s.points->handler)
      {
        const auto values = point.get_properties();
        volume += values[s.points->volume.first];
        moment += values[s.points->volume.first] * point.get_location()[1];
        EXPECT_TRUE(ids.insert(point.get_id()).second);
        const auto X = s.points->initial_place(point.get_location(), values.data());
        EXPECT_NEAR(point.get_location()[1], 2.5 * X[1], 1e-13);
        EXPECT_NEAR(values[s.points->sides.first + 1], 1. / 32, 1e-15);
      }
    EXPECT_NEAR(dealii::Utilities::MPI::sum(volume, MPI_COMM_WORLD), 1., 1e-13);
    EXPECT_NEAR(dealii::Utilities::MPI::sum(moment, MPI_COMM_WORLD), 1.25, 1e-13);
  }

  TEST(PointSplitting, MpiOnlyTheOuterHalfHoldsASide)
  {
    SystemFixture<2> s(stretched_block(1.3, "linear"));
    auto            &points = *s.points;
    for (auto &point : points.handler)
      point.get_properties()[points.deformation.first + 3] = 2.5;
    points.split_stretched(
      [&](const unsigned int axis, const bool upper) { return s.motion->marks_of_inner_half(axis, upper); });
    int n_driven = 0;
    for (const auto &point : points.handler)
      if (points.is_marked(point.get_properties().data(), points.support, 3))
        {
          ++n_driven;
          EXPECT_NEAR(1. - points.initial_place(point.get_location(), point.get_properties().data())[1], 1. / 64,
                      1e-14);
        }
    EXPECT_EQ(dealii::Utilities::MPI::sum(n_driven, MPI_COMM_WORLD), 8);
  }

  TEST(PointSplitting, MpiHalvesOfAHeldPointHoldItsPlace)
  {
    std::string held = stretched_block(2.5, "linear");
    held.insert(held.find("end\nsubsection MPM"),
                " subsection inner\n  set Where = nearest 0.4, 0.6\n  set Displacement = 0; 1.5*y*t\n end\n");
    MethodFixture block(held, "mpm");
    ASSERT_TRUE(block.advance(0., 1., 12));
    EXPECT_NEAR(block.scalars().at("reaction_top_y_N") / confined_force(2.5), 1., 4e-3);
    EXPECT_LT(std::abs(block.scalars().at("reaction_inner_y_N")), 4e-3 * confined_force(2.5));
  }

  TEST(PointSplitting, MpiHalvesBearTheLoadsOfTheirPoint)
  {
    const std::string loaded = stretched_block(2.5, "linear") +
                               "subsection Loads\n subsection one\n"
                               "  set Where = nearest 0.4, 0.6\n  set Total force = 0; 0.1\n end\n subsection layer\n"
                               "  set Where = layer y-max 0.3\n  set Total force = 0; 0.2\n end\nend\n";
    MethodFixture block(loaded, "mpm");
    for (unsigned int k = 0; k < 4; ++k)
      {
        ASSERT_TRUE(block.advance(.25 * k, .25 * (k + 1), 3));
        const auto scalars = block.scalars();
        EXPECT_NEAR(scalars.at("reaction_top_y_N") + scalars.at("reaction_bottom_y_N"), -.3, 1e-7) << k;
      }
  }
} // namespace
