// Closed area vectors where a solid is degraded: gaps that open inside are no free surfaces, volumes of all sum up to what bounds them.

#include "degraded_block.h"

using namespace Stroma;
using namespace DegradedBlock;

namespace
{
  /// Where particles at @p x come to when a hole of radius @p a opens at @p centre and nothing changes its volume.
  dealii::Point<2>
  beside_hole(const dealii::Point<2> &x, const dealii::Point<2> &centre, const double a)
  {
    const auto r = x - centre;
    return centre + std::sqrt(1. + a * a / r.norm_square()) * r;
  }

  /// Forces of the pressure 1 everywhere.
  std::vector<Tensor<1, 2>>
  forces_of_pressure(const Sph::System<2> &system)
  {
    const auto                        &particles = system.particles;
    std::vector<SymmetricTensor<2, 2>> stress(particles.size());
    for (unsigned int i = 0; i < particles.size(); ++i)
      if (!particles.is_fixed(i))
        stress[i] = -1. * dealii::unit_symmetric_tensor<2>();
    std::vector<Tensor<1, 2>> f(particles.n_free);
    system.elasticity->add_stress_force(f, stress, &particles.S);
    return f;
  }

  /// What the closing leaves of the sum of area vectors around @p i; those of walls belong half to the wall.
  Tensor<1, 2>
  open_area(const Sph::Pairs<2> &pairs, const unsigned int i)
  {
    Tensor<1, 2> area;
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
      area += (p < pairs.row_fixed[i] ? 1. : .5) * pairs.c[p];
    return area;
  }
} // namespace

TEST(AreaVectors, MpiAGapThatOpensInsideIsNoFreeSurface)
{
  const dealii::Point<2> centre(11., 11.);
  Block<2>               block(.1);
  block.set_factors([](const auto &) { return 0.; });
  auto &system    = *block.system;
  auto &particles = system.particles;
  for (unsigned int i = 0; i < particles.n_free; ++i)
    particles.x[i] = beside_hole(particles.x[i], centre, 1.3);
  ASSERT_EQ(system.update_geometry(), StepStatus::ok);
  const auto   f      = forces_of_pressure(system);
  double       at_gap = 0., n_at_gap = 0.;
  Tensor<1, 2> at_side;
  for (unsigned int i = 0; i < particles.n_free; ++i)
    {
      if (particles.x[i].distance(centre) < 2.2)
        {
          at_gap += f[i].norm();
          n_at_gap += 1.;
        }
      if (const auto &X = particles.X[i]; X[0] > 13. && X[1] > 2. && X[1] < 5.)
        at_side += f[i];
    }
  const auto sum = [](const auto &x) { return dealii::Utilities::MPI::sum(x, MPI_COMM_WORLD); };
  EXPECT_GT(sum(n_at_gap), 4.);
  EXPECT_LT(sum(at_gap), .01 * sum(n_at_gap)) << sum(at_gap) / sum(n_at_gap);
  EXPECT_GT(sum(at_side)[0], 2.5); // the free surface of the start stays one
}

/// Particles are sparse on one side of the cell.
TEST(AreaVectors, MpiAUniformPressureDoesNotPushTheBody)
{
  Block<2> block(.2);
  block.set_factors([](const auto &) { return 0.; });
  auto &system    = *block.system;
  auto &particles = system.particles;
  for (unsigned int i = 0; i < particles.n_free; ++i)
    particles.x[i] = beside_hole(particles.x[i], {6., 2.7}, .9);
  ASSERT_EQ(system.update_geometry(), StepStatus::ok);
  const auto  &pairs = system.pairs;
  Tensor<1, 2> area;
  double       size = 0.;
  for (unsigned int i = 0; i < pairs.n_rows(); ++i)
    for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
      if (system.movers[pairs.mover(particles, p)].rigid)
        {
          area += .5 * pairs.c[p];
          size += .5 * pairs.c[p].norm();
        }
  area = dealii::Utilities::MPI::sum(area, MPI_COMM_WORLD);
  size = dealii::Utilities::MPI::sum(size, MPI_COMM_WORLD);
  EXPECT_GT(size, 10.); // the circumference is 12.6
  EXPECT_LT(area.norm(), 1e-3 * size) << area / size;
}

/// Of a motion that leaves the free surface and the cell where they are, beside a gap. What is missing is what the closing leaves open, to
/// round-off.
TEST(AreaVectors, MpiVolumesOfAllSumUpToThatOfTheVessel)
{
  Block<2> block(.2);
  block.set_factors(front<2>);
  auto &system    = *block.system;
  auto &particles = system.particles;
  for (unsigned int i = 0; i < particles.n_free; ++i)
    particles.x[i] = beside_hole(particles.x[i], {6., 2.7}, .9);
  ASSERT_EQ(system.update_geometry(), StepStatus::ok);
  std::vector<Tensor<1, 2>> v(particles.size());
  for (unsigned int i = 0; i < particles.size(); ++i)
    if (const auto &X = particles.X[i]; !particles.is_fixed(i) && std::max(X[0], X[1]) < 12. && X[0] > 4.)
      v[i] = some_velocity(X);
  std::vector<Tensor<2, 2>> L(system.pairs.n_rows());
  system.elasticity->velocity_gradient(L, system.with_walls(v));
  double change = 0., of_each = 0., of_open_areas = 0.;
  for (unsigned int i = 0; i < particles.n_free; ++i)
    {
      const double of_this = particles.volume(i) * trace(L[i]);
      change += of_this;
      of_each += std::abs(of_this);
      of_open_areas -= v[i] * open_area(system.pairs, i);
    }
  const auto sum = [](const double x) { return dealii::Utilities::MPI::sum(x, MPI_COMM_WORLD); };
  EXPECT_GT(sum(of_each), 20.);
  EXPECT_LT(std::abs(sum(change)), 2e-3 * sum(of_each)) << sum(change) << " of " << sum(of_each);
  EXPECT_NEAR(sum(change), sum(of_open_areas), 1e-12 * sum(of_each));
}
