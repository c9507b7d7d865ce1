// Hourglass control of the state: forces of places now and at the start.

#include "../particles/scene_fixture.h"

#include <stroma/sph/system.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

using namespace Stroma;
using dealii::Point;
using dealii::Tensor;

namespace
{
  constexpr double spacing = .1;

  /// A free block; the lower half is ten times as stiff.
  const std::string halves =
    "subsection Materials\n"
    " subsection stiff\n  set Law = hypoelastic\n  set Young's modulus = 25\n"
    "  set Poisson's ratio = .3\n  set Viscosity = 100\n  set Density = 1000\n end\n"
    " subsection soft\n  set Law = hypoelastic\n  set Young's modulus = 2.5\n"
    "  set Poisson's ratio = .3\n  set Viscosity = 100\n  set Density = 1000\n end\nend\n"
    "subsection Bodies\n subsection lower\n  set Shape = box\n  set Upper corner = 1, .5\n"
    "  set Material = stiff\n end\n subsection upper\n  set Shape = box\n"
    "  set Lower corner = 0, .5\n  set Upper corner = 1, 1\n  set Material = soft\n end\nend\n";

  /// Numbers that depend on id and component alone, in [-1, 1].
  double
  roughness(const std::uint64_t id, const unsigned int c)
  {
    return std::sin(1e4 * (id + .37 * c + 1.));
  }

  /// Pairs are those of the undeformed block; stresses are 0, so that forces are those of hourglass control.
  struct FreeBlock
  {
    explicit FreeBlock(const std::string &more = "")
      : fixture(halves + more)
    {
      Sph::Settings settings;
      settings.arrangement.spacing = spacing;
      settings.arrangement.jitter  = .15;
      system = std::make_unique<Sph::System<2>>(fixture.scene, settings, Sph::Dynamics::inertial, 1., timers);
      system->arrange();
      EXPECT_EQ(system->update_geometry(true), StepStatus::ok);
      system->set_step(0., 1.);
    }

    /// Forces with the particles at place(id, X).
    template <typename Place>
    Sph::System<2>::Velocities
    forces_at(const Place &place)
    {
      auto &p = system->particles;
      for (unsigned int i = 0; i < p.n_owned; ++i)
        p.x[i] = system->neighbours->image_near(place(p.id[i], p.X[i]), p.x[i]);
      Sph::System<2>::Velocities f;
      system->state_forces(f, 0.);
      return f;
    }

    double
    energy() const
    {
      return system->strain_energy();
    }

    ParticleScene<2>                fixture;
    Timers                          timers;
    std::unique_ptr<Sph::System<2>> system;
  };

  Point<2>
  rough_place(const std::uint64_t id, const Point<2> &X)
  {
    return X + .2 * spacing * Tensor<1, 2>({roughness(id, 0), roughness(id, 1)});
  }

  double
  sum_of_norms(const Sph::System<2>::Velocities &f)
  {
    double sum = 0.;
    for (const auto &f_i : f)
      sum += f_i.norm();
    return dealii::Utilities::MPI::sum(sum, MPI_COMM_WORLD);
  }
} // namespace

TEST(HourglassControl, MpiForcesHaveNoSumAndNoTorque)
{
  FreeBlock    block;
  const auto   f = block.forces_at(rough_place);
  Tensor<1, 2> sum;
  double       torque = 0.;
  for (unsigned int i = 0; i < f.size(); ++i)
    {
      const auto &x = block.system->particles.x[i];
      sum += f[i];
      torque += x[0] * f[i][1] - x[1] * f[i][0];
    }
  const double size = sum_of_norms(f);
  EXPECT_GT(size, 1.);
  EXPECT_LT(dealii::Utilities::MPI::sum(sum, MPI_COMM_WORLD).norm(), 1e-14 * size);
  EXPECT_LT(std::abs(dealii::Utilities::MPI::sum(torque, MPI_COMM_WORLD)), 1e-14 * size);
}

// Half as long again, with rows in pairs: what was one spacing away is .7 or 2.3 away. Not so where the block is evenly stretched.
TEST(HourglassControl, MpiRowsInPairsHaveComeApart)
{
  const auto status_of = [](const double closer) {
    FreeBlock block;
    auto     &p = block.system->particles;
    for (unsigned int i = 0; i < p.n_owned; ++i)
      {
        const int row = static_cast<int>(p.X[i][1] / spacing);
        p.x[i][1]     = 1.5 * p.X[i][1] + (row % 2 == 0 ? closer : -closer) * spacing;
        p.J[i]        = 1.5;
      }
    EXPECT_EQ(block.system->update_geometry(true), StepStatus::ok);
    return block.system->check(p.v, 1., 1., 1.);
  };
  EXPECT_EQ(status_of(0.), StepStatus::ok);
  EXPECT_EQ(status_of(.4), StepStatus::came_apart);
}

TEST(HourglassControl, MpiForcesTurnWithTheMaterial)
{
  FreeBlock          block;
  const double       c = std::cos(2.), s = std::sin(2.);
  const Tensor<2, 2> Q({{c, -s}, {s, c}});
  const Tensor<1, 2> shift({5., -3.});
  const auto         f = block.forces_at(rough_place);
  const double       E = block.energy();
  const auto         g = block.forces_at(
    [&](const std::uint64_t id, const Point<2> &X) { return Point<2>(Q * rough_place(id, X) + shift); });
  EXPECT_NEAR(block.energy(), E, 1e-12 * E);
  for (unsigned int i = 0; i < f.size(); ++i)
    EXPECT_LT((g[i] - Q * f[i]).norm(), 1e-11);
}

TEST(HourglassControl, MpiLinearMotionsHaveNoForce)
{
  FreeBlock          block;
  const Tensor<2, 2> F({{1.3, .2}, {-.4, .8}});
  const auto         f = block.forces_at([&](const std::uint64_t, const Point<2> &X) { return Point<2>(F * X); });
  EXPECT_LT(sum_of_norms(f), 1e-11);
  EXPECT_LT(block.energy(), 1e-22);
}

TEST(HourglassControl, MpiForcesAreMinusTheGradientOfTheEnergy)
{
  FreeBlock  block;
  const auto f = block.forces_at(rough_place);
  for (const std::uint64_t id : {0, 12, 44, 47, 55, 58}) // at a corner, inside, and on both sides of the border
    for (unsigned int c = 0; c < 2; ++c)
      {
        double E[2];
        for (const int side : {0, 1})
          {
            block.forces_at([&](const std::uint64_t k, const Point<2> &X) {
              auto x = rough_place(k, X);
              x[c] += (k == id ? 1e-5 : 0.) * (side == 0 ? -1. : 1.);
              return x;
            });
            E[side] = block.energy();
          }
        const double expected = -(E[1] - E[0]) / 2e-5; // exact but for rounding: E is quadratic
        for (unsigned int i = 0; i < f.size(); ++i)
          if (block.system->particles.id[i] == id)
            {
              EXPECT_NEAR(f[i][c], expected, 1e-9 * std::max(1., std::abs(expected)));
            }
      }
}

TEST(HourglassControl, MpiTheSameAcrossPeriodicFaces)
{
  // Places are folded into the period, undeformed ones are not.
  FreeBlock                             block("subsection Periodic\n set Directions = x\nend\n");
  const auto                            f = block.forces_at(rough_place);
  const Tensor<1, 2>                    shift({.3, 0.});
  auto                                 &p = block.system->particles;
  std::map<std::uint64_t, Tensor<1, 2>> before;
  for (unsigned int i = 0; i < f.size(); ++i)
    before[p.id[i]] = f[i];
  Tensor<1, 2> sum;
  for (const auto &f_i : f)
    sum += f_i;
  EXPECT_LT(dealii::Utilities::MPI::sum(sum, MPI_COMM_WORLD).norm(), 1e-14 * sum_of_norms(f));
  block.forces_at([&](const std::uint64_t, const Point<2> &X) { return X + shift; });
  ASSERT_EQ(block.system->update_geometry(true), StepStatus::ok);
  const auto g = block.forces_at([&](const std::uint64_t id, const Point<2> &X) { return rough_place(id, X) + shift; });
  for (unsigned int i = 0; i < g.size(); ++i)
    if (const auto f_i = before.find(p.id[i]); f_i != before.end()) // particles may have gone to other ranks
      {
        EXPECT_LT((g[i] - f_i->second).norm(), 1e-8 * std::max(1., g[i].norm()));
      }
}

TEST(HourglassControl, MpiWallsMoveWithTheirSides)
{
  // A held side and the material with it, as one or stretched: no force.
  for (const std::string motion :
       {"set Displacement = 0.05*t; 0.1*t", "set Type = velocity\n  set Velocity = 0.05; 0.1",
        "set Displacement = 0.01*x*t; 0.1*t"})
    {
      FreeBlock  block("subsection Supports\n subsection floor\n  set Where = side y-min\n  " + motion +
                       "\n end\nend\n");
      const bool stretches = motion.find('x') != std::string::npos;
      const auto x         = [&](const double t) {
        return [=](const std::uint64_t, const Point<2> &X) {
          return Point<2>(X[0] + t * (stretches ? .01 * X[0] : .05), X[1] + .1 * t);
        };
      };
      auto &system = *block.system;
      block.forces_at(x(0.));
      system.set_step(0., 1.);
      Sph::System<2>::Velocities v(system.particles.size());
      for (unsigned int i = 0; i < v.size(); ++i)
        v[i] = x(1.)(0, system.particles.X[i]) - system.particles.X[i];
      system.impose(v);
      system.set_gradient(v);
      system.commit(v, 1.);
      Sph::System<2>::Velocities f;
      for (const bool anew : {false, true})
        {
          if (anew)
            {
              ASSERT_EQ(system.update_geometry(true), StepStatus::ok);
            }
          for (auto &S : system.particles.S)
            S = 0.;
          for (auto &J : system.particles.J)
            J = 1.;
          system.state_forces(f, 1.);
          EXPECT_LT(sum_of_norms(f), stretches ? 1e-6 : 1e-8) << motion; // places on walls that vary go by two rounds
        }
    }
}
