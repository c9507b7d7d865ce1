// Places and volumes of a fluid's particles that fit each other.

#include "scene_fixture.h"

#include <stroma/sph/system.h>

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
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

    ParticleScene<dim>                fixture;
    Timers                            timers;
    std::unique_ptr<Sph::System<dim>> system;
  };
} // namespace

TEST(Packing, MpiLatticesAreNotCrowded)
{
  const Water<2> closed(square + clamped({ "x-min", "x-max", "y-min", "y-max" }), .1, 0.);
  EXPECT_LT(closed.system->packing->mean_excess(closed.system->particles), 1e-12);
  const Water<3> open(cube + clamped({ "z-min" }), .2, 0.);
  EXPECT_LT(open.system->packing->mean_excess(open.system->particles), 1e-12);
}

TEST(Packing, MpiVolumesThatOutgrowTheirPlacesEndTheRun)
{
  Water<2> water(square + clamped({ "x-min", "x-max", "y-min", "y-max" }), .1, 0.);
  auto    &system = *water.system;
  system.set_gradient(system.with_walls(system.particles.v));
  EXPECT_EQ(system.check(system.particles.v, .1, .2, 1.), StepStatus::ok);
  for (auto &J : system.particles.J)
    J *= 1.1;
  EXPECT_EQ(system.update_geometry(true), StepStatus::ok);
  system.set_gradient(system.with_walls(system.particles.v));
  EXPECT_EQ(system.check(system.particles.v, .1, .2, 1.), StepStatus::drifted_apart);
}
