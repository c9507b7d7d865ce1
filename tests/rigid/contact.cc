// Laws of contact: Coulomb's friction on a ball and a box, in the plane and in space.

#include "../base/keep_largest.h"

#include <stroma/rigid/contact.h>
#include <stroma/shapes/ball.h>
#include <stroma/shapes/box.h>

#include <gtest/gtest.h>

namespace
{
  using namespace Stroma;

  constexpr double mu = .3, eps = 1e4, resolution = 1e-9;

  /// A point by its coordinates, in the plane the first two of them.
  template <int dim>
  dealii::Point<dim>
  at(const double x, const double y, const double z)
  {
    dealii::Point<dim> X;
    X[0] = x;
    X[1] = y;
    if (dim == 3)
      X[dim - 1] = z;
    return X;
  }

  Contact
  coulomb()
  {
    Contact contact;
    contact.type     = Contact::Type::coulomb;
    contact.friction = mu;
    return contact;
  }

  /// The largest difference between the stiffness at @p x and differences of the traction, over eps.
  template <int dim>
  double
  stiffness_error(const Rigid::ContactLaw<dim> &law, const Rigid::ContactState<dim> &state, const dealii::Point<dim> &x)
  {
    constexpr double h     = 1e-7;
    double           worst = 0.;
    const auto       S     = law.stiffness(state, x, eps);
    for (unsigned int j = 0; j < dim; ++j)
      {
        dealii::Tensor<1, dim> step;
        step[j]      = h;
        const auto T = (law.traction(state, dealii::Point<dim>(x + step), eps) -
                        law.traction(state, dealii::Point<dim>(x - step), eps)) /
                       (2. * h);
        for (unsigned int i = 0; i < dim; ++i)
          keep_largest(worst, std::abs(S[i][j] + T[i]) / eps);
      }
    return worst;
  }

  /// A point pressed into the top of a shape, at height 1, and moved along it.
  template <int dim>
  void
  check_sliding(const Shapes::Shape<dim> &shape)
  {
    const Rigid::ContactLaw<dim> law(shape, coulomb(), resolution);
    Rigid::ContactState<dim>     state;
    const auto                   in = at<dim>(.1, .98, .05);
    law.enter(state, at<dim>(.1, 1.2, .05), in);
    EXPECT_FALSE(law.change_slip(state, in, eps)) << "pressed, and nearly straight";
    const auto moved = at<dim>(.15, .97, .06);
    ASSERT_TRUE(law.change_slip(state, moved, eps));
    EXPECT_TRUE(state.slides);
    EXPECT_FALSE(law.change_slip(state, moved, eps)) << "slides on, against its friction";
    for (const double x : {.16, .10, .04}) // forward, near the start, back
      {
        const auto   place  = at<dim>(x, .965, .052 + .2 * (x - .1));
        const auto   T      = law.traction(state, place, eps);
        const double p      = law.pressure(state, place, eps);
        const auto   normal = shape.nearest(place).normal;
        EXPECT_GT(p, 0.);
        EXPECT_NEAR((T - p * normal).norm(), mu * p, 1e-12 * p);
        EXPECT_LT(T[0] - p * normal[0], 0.) << "against the way";
        EXPECT_LT(stiffness_error(law, state, place), 1e-6) << dim << "D at " << x;
      }
    ASSERT_TRUE(law.change_slip(state, at<dim>(.04, .965, .05), eps)) << "went back along its friction";
    EXPECT_FALSE(state.slides);
    EXPECT_LT(stiffness_error(law, state, moved), 1e-6);
  }

  TEST(ContactLaw, FrictionIsAtItsLimitAndItsStiffnessTheDerivative)
  {
    check_sliding<2>(Shapes::Ball<2>({0., 0.}, 1.));
    check_sliding<2>(Shapes::Box<2>({-1., 0.}, {1., 1.}));
    check_sliding<3>(Shapes::Ball<3>({0., 0., 0.}, 1.));
    check_sliding<3>(Shapes::Box<3>({-1., 0., -1.}, {1., 1., 1.}));
  }

  TEST(ContactLaw, FrictionTurnsAgainstTheSlip)
  {
    // In space the way turns by a right angle: some rounds later the friction is against the new way.
    const Shapes::Box<3>       box({-1., 0., -1.}, {1., 1., 1.});
    const Rigid::ContactLaw<3> law(box, coulomb(), resolution);
    Rigid::ContactState<3>     state;
    law.enter(state, {0., 1.1, 0.}, {0., .98, 0.});
    ASSERT_TRUE(law.change_slip(state, {.1, .98, 0.}, eps));
    law.follow(state, {.1, .98, 0.}, eps);
    law.start_step(state, {.1, 1., 0.});
    const dealii::Point<3> turned(.1, 1., .01);
    EXPECT_GT(law.violation(state, turned), .005);
    for (unsigned int round = 0; round < 60; ++round)
      law.follow(state, turned, eps);
    EXPECT_LT(law.violation(state, turned), 1e-6);
    const auto T = law.traction(state, turned, eps);
    EXPECT_NEAR(T[2], -mu * T[1], 1e-6 * T[1]);
  }

  TEST(ContactLaw, KeepsItsStateInACheckpoint)
  {
    const Shapes::Ball<2>      ball({0., 0.}, 1.);
    const Rigid::ContactLaw<2> law(ball, coulomb(), resolution);
    Rigid::ContactState<2>     state, copy;
    law.enter(state, {0., 1.1}, {0., .98});
    ASSERT_TRUE(law.change_slip(state, {.1, .97}, eps));
    double values[Rigid::ContactState<2>::n_values];
    state.save(values);
    copy.load(values);
    EXPECT_TRUE(copy.slides);
    const dealii::Point<2> x(.12, .97);
    EXPECT_EQ(law.traction(copy, x, eps), law.traction(state, x, eps));
  }
} // namespace
