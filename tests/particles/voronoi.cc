// Relaxed arrangements: nearly equal volumes, no close pairs.

#include "scene_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace
{
  using namespace Stroma;

  /// Spread of the volumes over their mean, and the least distance, periodic where the scene is.
  template <int dim>
  std::pair<double, double>
  quality(const ParticleScene<dim> &s, const Particles::ParticleSet<dim> &particles)
  {
    double sum = 0., squares = 0., least = 1e9;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      {
        sum += particles.V0[i];
        squares += particles.V0[i] * particles.V0[i];
        for (unsigned int j = 0; j < i; ++j)
          {
            auto r = particles.x[i] - particles.x[j];
            for (unsigned int d = 0; d < dim; ++d)
              if (const double period = s.scene.bounding_box().side_length(d); s.scene.periodic[d])
                r[d] -= period * std::round(r[d] / period);
            least = std::min(least, r.norm());
          }
      }
    const double mean = sum / particles.n_free;
    return {std::sqrt(squares / particles.n_free - mean * mean) / mean, least};
  }

  TEST(Voronoi, Square)
  {
    for (const std::string periodic : {"", "subsection Periodic\n set Directions = x, y\nend\n"})
      {
        ParticleScene<2> s(box_of_gel("1, 1", periodic));
        const auto       particles = s.arrange(.025, 0., Particles::ArrangementName::voronoi);
        const auto [spread, least] = quality(s, particles);
        EXPECT_EQ(particles.n_free, 1600u);
        EXPECT_LT(spread, .03);
        EXPECT_GT(least, .6 * .025);
      }
  }

  TEST(Voronoi, CubeWithLayer)
  {
    ParticleScene<3> s(box_of_gel("1, 1, 1", clamped({"z-min"})));
    const auto       particles = s.arrange(.1, .2, Particles::ArrangementName::voronoi);
    const auto [spread, least] = quality(s, particles);
    EXPECT_EQ(particles.n_free, 1000u);
    EXPECT_EQ(particles.n_owned, 1200u);
    EXPECT_LT(spread, .03);
    EXPECT_GT(least, .06);
  }

  TEST(Voronoi, MpiTheSameOnAnyRanks)
  {
    auto       s         = ParticleScene<2>::heck("pillars");
    const auto particles = s.arrange(5e-4, 1.3e-3, Particles::ArrangementName::voronoi);
    EXPECT_EQ(dealii::Utilities::MPI::sum(particles.n_free, MPI_COMM_WORLD), 400u - 64u);
    EXPECT_TRUE(are_share_of(particles, s.arrange_alone(5e-4, 1.3e-3, Particles::ArrangementName::voronoi, 0.)));
  }
} // namespace
