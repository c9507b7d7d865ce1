// What keeps a fluid at rest: places and volumes that fit, and pressures at walls.

#include "scene_fixture.h"

#include <stroma/sph/system.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

using namespace Stroma;
using dealii::Tensor;

namespace
{
  constexpr double K = 1000.;

  const std::string materials = "subsection Materials\n subsection water\n  set Law = fluid\n  set Viscosity = 1\n"
                                "  set Viscous operator = morris\n  set Bulk modulus = 1000\n  set Density = 1\n end\nend\n";
  const std::string square    = "subsection Bodies\n subsection water\n  set Shape = box\n  set Upper corner = 1, 1\n end\nend\n";
  const std::string cube      = "subsection Bodies\n subsection water\n  set Shape = box\n  set Upper corner = 1, 1, 1\n end\nend\n";

  template <int dim>
  struct Water
  {
    Water(const std::string &text, const double spacing, const double jitter)
      : fixture(materials + text)
    {
      Sph::Settings settings;
      settings.arrangement.spacing = spacing;
      settings.arrangement.jitter  = jitter;
      system = std::make_unique<Sph::System<dim>>(fixture.scene, settings, Sph::Dynamics::inertial, 1., timers);
      system->arrange();
      EXPECT_EQ(system->update_geometry(true), StepStatus::ok);
      system->set_step(0., 1.);
    }

    double
    energy() const
    {
      return dealii::Utilities::MPI::sum(system->packing->energy(), MPI_COMM_WORLD);
    }

    ParticleScene<dim>                fixture;
    Timers                            timers;
    std::unique_ptr<Sph::System<dim>> system;
  };

  /// A direction for each particle, of ids alone.
  template <int dim>
  Tensor<1, dim>
  direction(const std::uint64_t id)
  {
    Tensor<1, dim> d;
    for (unsigned int c = 0; c < dim; ++c)
      d[c] = std::sin(1e4 * (id + .37 * c));
    return d;
  }

  template <int dim>
  double
  sum_of_products(const std::vector<Tensor<1, dim>> &f, const Sph::Particles<dim> &particles)
  {
    double sum = 0.;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      sum += f[i] * direction<dim>(particles.id[i]);
    return dealii::Utilities::MPI::sum(sum, MPI_COMM_WORLD);
  }

  template <int dim>
  void
  check_energy(const std::string &text, const double spacing)
  {
    Water<dim>                  water(text, spacing, .3);
    auto                       &system = *water.system;
    std::vector<Tensor<1, dim>> f(system.particles.n_free), v(system.particles.size());
    for (auto &load : f)
      load[0] = std::pow(spacing, dim);
    system.packing->set_loads(f);
    f.assign(f.size(), {});
    system.packing->add_force(f);
    const double power = sum_of_products(f, system.particles);

    Tensor<1, dim> momentum;
    double         largest = 0.;
    for (const auto &f_i : f)
    {
      momentum += f_i;
      largest = std::max(largest, f_i.norm());
    }
    momentum = dealii::Utilities::MPI::sum(momentum, MPI_COMM_WORLD);
    EXPECT_GT(dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD), 0.);
    EXPECT_LT(momentum.norm(), 1e-12 * dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD));

    // Motion by the tangent, then by the places themselves.
    const double step = 1e-5 * spacing, before = water.energy();
    for (unsigned int i = 0; i < system.particles.n_free; ++i)
      v[i] = direction<dim>(system.particles.id[i]);
    system.neighbours->update_ghosts(v);
    system.packing->move(system.particles, v, step);
    EXPECT_NEAR((water.energy() - before) / step, -power, 1e-3 * std::abs(power));
    for (unsigned int i = 0; i < system.particles.n_free; ++i)
      system.particles.x[i] += step * direction<dim>(system.particles.id[i]);
    EXPECT_EQ(system.update_geometry(true), StepStatus::ok);
    EXPECT_NEAR((water.energy() - before) / step, -power, 1e-3 * std::abs(power));
  }

  /// Pressures that are linear in place, and the forces that they leave besides those they should make; largest, over V |b|.
  template <int dim>
  double
  imbalance(const std::string &text, const double spacing, const double jitter)
  {
    Water<dim>     water(text, spacing, jitter);
    auto          &system = *water.system;
    Tensor<1, dim> b;
    b[0] = .003, b[dim - 1] = -.01; // [Pa/m], so small that volumes stay
    for (unsigned int i = 0; i < system.particles.size(); ++i)
    {
      const double p = .02 + b * system.particles.x[i];
      if (!system.particles.is_fixed(i))
        system.particles.J[i] = std::pow(1. + 7. * p / K, -1. / 7.);
    }
    std::vector<Tensor<1, dim>> f;
    system.state_forces(f, 0.);
    double largest = 0.;
    for (unsigned int i = 0; i < system.particles.n_free; ++i)
    {
      const double V = system.particles.volume(i);
      largest        = std::max(largest, (f[i] + V * b).norm() / (V * b.norm()));
    }
    return dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD);
  }
} // namespace

TEST(Packing, MpiForcesAreThoseOfTheEnergyAndConserveMomentum)
{
  check_energy<2>(square + "subsection Periodic\n set Directions = x, y\nend\n", .1);
  check_energy<3>(cube + "subsection Periodic\n set Directions = x, y, z\nend\n", .15);
}

TEST(Packing, MpiLatticesAreNotCrowded)
{
  const Water<2> closed(square + clamped({ "x-min", "x-max", "y-min", "y-max" }), .1, 0.);
  EXPECT_LT(closed.system->packing->mean_excess(), 1e-12);
  const Water<3> open(cube + clamped({ "z-min" }), .2, 0.);
  EXPECT_LT(open.system->packing->mean_excess(), 1e-12);
}

TEST(Packing, MpiVolumesThatOutgrowTheirPlacesEndTheRun)
{
  Water<2> water(square + clamped({ "x-min", "x-max", "y-min", "y-max" }), .1, 0.);
  auto    &system = *water.system;
  system.set_gradient(system.with_walls(system.particles.v));
  EXPECT_EQ(system.check(system.particles.v, .1, .2, 1.), StepStatus::ok);
  for (auto &J : system.particles.J)
    J *= 1.15;
  EXPECT_EQ(system.update_geometry(true), StepStatus::ok);
  system.set_gradient(system.with_walls(system.particles.v));
  EXPECT_EQ(system.check(system.particles.v, .1, .2, 1.), StepStatus::drifted_apart);
}

/// Also in corners; without the pressure continued to walls particles beside them are left with half of the force and more.
TEST(WallPressure, MpiLinearPressureBalancesAWeight)
{
  const std::string vessel = square + clamped({ "x-min", "x-max", "y-min", "y-max" });
  EXPECT_LT(imbalance<2>(vessel, .1, 0.), 2e-3);
  EXPECT_LT(imbalance<2>(vessel, .1, .2), .15);
  EXPECT_LT(imbalance<3>(cube + clamped({ "x-min", "x-max", "y-min", "y-max", "z-min", "z-max" }), .2, 0.), 2e-3);
}
