// The part of a particle that lies in a region.

#include "scene_fixture.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;

  /// Volume that the particles have in the region of the scene's only load.
  template <int dim>
  double
  loaded_volume(const std::string &corner, const std::string &region, const double spacing)
  {
    const std::string  force = dim == 2 ? "1; 0" : "1; 0; 0";
    ParticleScene<dim> s(box_of_gel(corner, "subsection Loads\n subsection push\n  set Where = " + region +
                                              "\n  set Force density = " + force + "\n end\nend\n"));
    const auto         particles = s.arrange(spacing);
    double             sum       = 0.;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      sum += particles.V0[i] * Particles::share_in_region(s.scene, s.scene.loads[0].region, particles.X[i],
                                                          particles.material_of(i), spacing);
    return sum;
  }

  TEST(ShareInRegion, CircleConverges)
  {
    const double exact = dealii::numbers::PI * .04;
    const auto   error = [&](const double spacing) {
      return std::abs(loaded_volume<2>("1, 1", "ball 0.47, 0.52 : 0.2", spacing) / exact - 1.);
    };
    EXPECT_LT(error(.1), 4e-3);
    EXPECT_LT(error(.05), 1e-3);
    EXPECT_LT(error(.0125), 1e-4);
  }

  TEST(ShareInRegion, BallConverges)
  {
    const double exact = 4. / 3. * dealii::numbers::PI * .008;
    EXPECT_NEAR(loaded_volume<3>("1, 1, 1", "ball 0.47, 0.52, 0.51 : 0.2", .05), exact, 5e-3 * exact);
  }

  TEST(ShareInRegion, BoxAndLayerAreExact)
  {
    EXPECT_NEAR(loaded_volume<2>("1, 1", "box 0.113, 0.2 : 0.631, 0.777", .1), .518 * .577, 1e-14);
    EXPECT_NEAR(loaded_volume<2>("1, 1", "layer y-max 0.137", .1), .137, 1e-14);
    EXPECT_NEAR(loaded_volume<3>("1, 1, 1", "layer z-min 0.137", .1), .137, 1e-13);
  }

  TEST(ShareInRegion, Materials)
  {
    EXPECT_NEAR(loaded_volume<2>("1, 1", "material gel", .1), 1., 1e-13);
    EXPECT_NEAR(loaded_volume<2>("1, 1", "all", .1), 1., 1e-13);
    EXPECT_EQ(loaded_volume<2>("1, 1", "material stiff", .1), 0.);
  }
} // namespace
