#include <stroma/rigid/pose.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;
  using Rigid::Axial;

  const Axial<3>             theta({.4, -.9, .3}), rate({-.2, .5, 1.1});
  const dealii::Tensor<1, 3> r({.3, .7, -.2});
  constexpr double           pi = dealii::numbers::PI;

  /// exp of the matrix of theta x, by its series.
  dealii::Tensor<2, 3>
  exponential(const Axial<3> &w)
  {
    dealii::Tensor<2, 3> sum, term, W;
    W[2][1] = w[0], W[1][2] = -w[0], W[0][2] = w[1], W[2][0] = -w[1], W[1][0] = w[2], W[0][1] = -w[2];
    for (unsigned int d = 0; d < 3; ++d)
      sum[d][d] = term[d][d] = 1.;
    for (unsigned int n = 1; n < 40; ++n)
      {
        term = term * W / n;
        sum += term;
      }
    return sum;
  }

  TEST(Rotation, IsTheExponential)
  {
    for (const double factor : {0., 1e-9, 1., 3.})
      EXPECT_LT((Rigid::rotation_matrix<3>(factor * theta) - exponential(factor * theta)).norm(), 1e-14);
    const Axial<2> quarter({pi / 2.});
    EXPECT_LT(
      (Rigid::rotation_matrix<2>(quarter) * dealii::Tensor<1, 2>({1., 0.}) - dealii::Tensor<1, 2>({0., 1.})).norm(),
      1e-15);
  }

  TEST(Rotation, AngularVelocityIsThatOfTheMatrix)
  {
    const double h = 1e-5;
    for (const double factor : {0., 1e-4, .009, .011, 1., 2.})
      {
        const Axial<3> at = factor * theta, w = Rigid::angular_velocity<3>(at, rate);
        const auto     dR = (Rigid::rotation_matrix<3>(at + h * rate) - Rigid::rotation_matrix<3>(at - h * rate)) /
                        (2. * h);
        const dealii::Tensor<1, 3> arm = Rigid::rotation_matrix<3>(at) * r;
        EXPECT_LT((dR * r - Rigid::cross<3>(w, arm)).norm(), 1e-9) << factor;
      }
  }

  TEST(Rotation, ComposesAndCountsTurns)
  {
    const auto both = Rigid::rotation_matrix<3>(Rigid::compose<3>(theta, rate));
    EXPECT_LT((both - Rigid::rotation_matrix<3>(rate) * Rigid::rotation_matrix<3>(theta)).norm(), 1e-14);
    Axial<3>       whole;
    const Axial<3> step({0., 0., .3});
    for (unsigned int i = 0; i < 100; ++i)
      whole = Rigid::compose<3>(whole, step);
    EXPECT_NEAR(whole[2], 30., 1e-10);
    EXPECT_NEAR((Rigid::compose<2>(Axial<2>({6.}), Axial<2>({1.}))[0]), 7., 1e-15);
  }

  TEST(Rotation, TorqueIsConjugateToAngularVelocity)
  {
    const dealii::Tensor<1, 3> f({2., -1., 4.});
    EXPECT_NEAR((Rigid::moment<3>(r, f) * rate), (f * Rigid::cross<3>(rate, r)), 1e-15);
    const dealii::Tensor<1, 2> arm({.3, .7}), force({2., -1.});
    const Axial<2>             w({3.});
    EXPECT_NEAR((Rigid::moment<2>(arm, force) * w), (force * Rigid::cross<2>(w, arm)), 1e-15);
  }

  TEST(Pose, KeepsDistancesAndMovesThePivotByItsTranslation)
  {
    const Rigid::Pose<3>   pose{dealii::Point<3>(.1, .2, .3), dealii::Tensor<1, 3>({1., 2., 3.}), theta};
    const dealii::Point<3> A(1., 0., .5), B(-.3, .4, 2.);
    EXPECT_NEAR(pose.place(A).distance(pose.place(B)), A.distance(B), 1e-15);
    EXPECT_LT((pose.displacement(pose.pivot) - pose.translation).norm(), 1e-15);
  }
} // namespace
