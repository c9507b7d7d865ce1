// Friction where a fluid meets the solid that it was: symmetric, of linear motions exact, and the fluid comes to rest half way between both.

#include "../base/keep_largest.h"
#include "degraded_block.h"

using namespace Stroma;
using namespace DegradedBlock;

namespace
{
  /// Forces of friction of @p v, which with_walls() has seen.
  template <int dim>
  std::vector<Tensor<1, dim>>
  friction_of(Sph::System<dim> &system, const std::vector<Tensor<1, dim>> &v)
  {
    std::vector<Tensor<1, dim>> f(system.particles.n_free);
    system.add_friction(f, v);
    return f;
  }

  /// Velocities @p velocity(place) of particles and of wall points.
  template <int dim, typename Velocity>
  std::vector<Tensor<1, dim>>
  everywhere(const Sph::System<dim> &system, const Velocity &velocity)
  {
    const auto                 &particles = system.particles;
    const auto                 &pairs     = system.pairs;
    std::vector<Tensor<1, dim>> v(pairs.n_points());
    for (unsigned int i = 0; i < particles.size(); ++i)
      v[i] = velocity(particles.x[i]);
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
        v[pairs.j[p]] = velocity(particles.x[i] + pairs.r[p]);
    return v;
  }

  template <int dim>
  void
  friction_is_symmetric()
  {
    Block<dim> block(.2);
    block.set_factors(front<dim>);
    auto       &system    = *block.system;
    const auto &particles = system.particles;
    // Walls at rest.
    std::vector<Tensor<1, dim>> u(system.pairs.n_points()), v(u);
    for (unsigned int i = 0; i < particles.size(); ++i)
      if (!particles.is_fixed(i))
        {
          u[i] = some_velocity(particles.X[i]);
          v[i] = some_velocity(1.7 * particles.X[i]);
        }
    const auto of_u = friction_of(system, u), of_v = friction_of(system, v);
    double     uv = 0., vu = 0., uu = 0.;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      {
        uv += u[i] * of_v[i];
        vu += v[i] * of_u[i];
        uu += u[i] * of_u[i];
      }
    const auto sum = [](const double x) { return dealii::Utilities::MPI::sum(x, MPI_COMM_WORLD); };
    EXPECT_GT(sum(system.degraded_friction->rows().size()), 30u);
    EXPECT_LT(sum(uu), 0.);
    EXPECT_NEAR(sum(uv), sum(vu), -1e-12 * sum(uu));
  }

  /// As far as area vectors are closed, which on disordered particles is to 1 %.
  template <int dim>
  void
  linear_motions_are_exact()
  {
    Block<dim> block(.2);
    block.set_factors(front<dim>);
    auto          &system = *block.system;
    Tensor<2, dim> A;
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int d = 0; d < dim; ++d)
        A[c][d] = std::sin(1. + c + 2.3 * d);
    const auto v = everywhere<dim>(system, [&](const auto &x) { return A * Tensor<1, dim>(x); });
    friction_of(system, v);
    const auto &rows = system.degraded_friction->rows();
    for (unsigned int k = 0; k < rows.size(); ++k)
      EXPECT_LT((system.degraded_friction->gradient(k) - A).norm(), .02 * A.norm()) << system.particles.X[rows[k]];
  }

  /// Largest over the ranks.
  double
  largest(const std::vector<Tensor<1, 2>> &forces)
  {
    double all = 0.;
    for (const auto &f : forces)
      keep_largest(all, f.norm());
    return dealii::Utilities::MPI::max(all, MPI_COMM_WORLD);
  }

  /// Forces of friction of dilatation alone, whose stress in the plane is (1 - 2/3 + 5/3) mu tr D.
  std::vector<Tensor<1, 2>>
  friction_of_dilatation(const Sph::System<2> &system, const std::vector<Tensor<1, 2>> &v)
  {
    const auto                              &particles = system.particles;
    std::vector<Tensor<2, 2>>                L(system.pairs.n_rows());
    std::vector<SymmetricTensor<2, 2>>       stress(particles.size());
    const std::vector<SymmetricTensor<2, 2>> no_shear(particles.size());
    system.elasticity->velocity_gradient(L, v);
    for (unsigned int i = 0; i < particles.n_free; ++i)
      stress[i] = 2. * system.constitutions[0].mu * trace(L[i]) * dealii::unit_symmetric_tensor<2>();
    system.neighbours->update_ghosts(stress);
    std::vector<Tensor<1, 2>> f(particles.n_free);
    system.elasticity->add_stress_force(f, stress, &no_shear);
    return f;
  }
} // namespace

TEST(DegradedFriction, MpiItIsSymmetric)
{
  friction_is_symmetric<2>();
  friction_is_symmetric<3>();
}

TEST(DegradedFriction, MpiLinearMotionsAreExact)
{
  linear_motions_are_exact<2>();
  linear_motions_are_exact<3>();
}

/// The traction of a shear flow that ends at the interface with a solid at rest; a gradient over both sides has half of it.
TEST(DegradedFriction, MpiAFluidComesToRestAtTheInterface)
{
  Block<2> block(0.);
  block.set_factors([](const auto &X) { return X[0] < 9. ? 0. : 1.; });
  auto       &system    = *block.system;
  const auto &particles = system.particles;
  const auto  v     = everywhere<2>(system, [](const auto &x) { return Tensor<1, 2>({0., std::max(9. - x[0], 0.)}); });
  const auto  f     = friction_of(system, v);
  double      force = 0.;
  for (unsigned int i = 0; i < particles.n_free; ++i)
    if (const auto &X = particles.X[i];
        X[0] > 9. && X[0] < 14. && std::abs(X[1] - 12.) < 1.) // far from the cell and the sides
      force += f[i][1];
  EXPECT_NEAR(dealii::Utilities::MPI::sum(force, MPI_COMM_WORLD), 2. * .97, .1);
}

/// One particle. A rotation has no friction but that of its dilatation, to round-off, which is as exact as second moments of area vectors
/// are.
TEST(DegradedFriction, MpiASolidLeftInTheFluidBelongsToIt)
{
  Block<2> block(0.);
  block.set_factors([](const dealii::Point<2> &X) { return X.distance({11.5, 9.5}) < .6 ? 1. : 0.; });
  auto      &system = *block.system;
  const auto linear = [&](const double a, const double b) {
    return everywhere<2>(system, [=](const auto &x) { return Tensor<1, 2>({a * x[1], b * x[0]}); });
  };
  const double of_shear = largest(friction_of(system, linear(1., 1.)));
  const auto   turn     = linear(1., -1.);
  const auto   f = friction_of(system, turn), of_dilatation = friction_of_dilatation(system, turn);
  for (unsigned int i = 0; i < f.size(); ++i)
    {
      EXPECT_LT(f[i].norm(), 5e-2 * of_shear);
      EXPECT_LT((f[i] - of_dilatation[i]).norm(), 1e-12 * of_shear);
    }
}
