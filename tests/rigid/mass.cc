// Rigid bodies with mass: Newton's and Euler's equations.

#include <stroma/rigid/mass.h>
#include <stroma/rigid/motion.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;
  using Rigid::DrivenBy;

  /// A box of sides 3, 2 and 1 about the origin, driven by the balance of forces in all components.
  template <int dim>
  Rigid::Body<dim>
  box(const dealii::Point<dim> &pivot)
  {
    Rigid::Body<dim> body;
    body.pivot          = pivot;
    body.moments.volume = 6.;
    for (unsigned int d = 0; d < dim; ++d)
      body.moments.second[d][d] = 6. * (3. - d) * (3. - d) / 12.;
    body.drive.translation.fill(DrivenBy::force);
    body.drive.rotation.fill(DrivenBy::force);
    return body;
  }

  const double mass = 5.;

  template <int dim>
  dealii::Point<dim>
  centroid(const Rigid::Body<dim> &body, const Rigid::Pose<dim> &pose)
  {
    return pose.place(body.moments.centroid);
  }
} // namespace

TEST(Mass, AConstantForceAndTorque)
{
  auto               body = box<2>({});
  Rigid::Motion<2>   motion(body);
  Rigid::Momentum<2> momentum(body, mass, {}, motion.pose());
  Rigid::Wrench<2>   acting;
  const double       dt = 1e-3, inertia = mass * (9. + 4.) / 12.;
  acting.force[0]  = 10.;
  acting.torque[0] = 2.;
  for (unsigned int k = 0; k < 1000; ++k)
    motion.commit(motion.next(k * dt, (k + 1) * dt, momentum.advance(acting, {}, motion.pose(), dt)));
  EXPECT_NEAR(motion.pose().translation[0], .5 * 10. / mass, 1e-3 * 10. / mass);
  EXPECT_NEAR(motion.pose().rotation[0], .5 * 2. / inertia, 1e-3 * 2. / inertia);
}

TEST(Mass, AHeldPivotTakesUpTheForceOfTurningAboutIt)
{
  auto body = box<2>({-1.5, 0.});
  body.drive.translation.fill(DrivenBy::rest);
  Rigid::Motion<2>   motion(body);
  Rigid::Momentum<2> momentum(body, mass, {}, motion.pose());
  Rigid::Wrench<2>   acting;
  acting.torque[0] = 2.;
  Rigid::Twist<2> twist;
  for (unsigned int k = 0; k < 100; ++k)
    {
      twist = momentum.advance(acting, {}, motion.pose(), .01);
      motion.commit(motion.next(k * .01, (k + 1) * .01, twist));
    }
  const double inertia = mass * ((9. + 4.) / 12. + 1.5 * 1.5);
  EXPECT_NEAR(twist.angular_velocity[0], 2. / inertia, 1e-12);
  EXPECT_EQ(twist.velocity.norm(), 0.);
}

TEST(Mass, WithoutForcesACentroidOffThePivotGoesStraight)
{
  const auto       body = box<2>({.7, -.4});
  Rigid::Motion<2> motion(body);
  Rigid::Twist<2>  twist;
  twist.velocity[0]         = .3;
  twist.velocity[1]         = .1;
  twist.angular_velocity[0] = 2.;
  Rigid::Momentum<2> momentum(body, mass, twist, motion.pose());
  const auto         start  = centroid(body, motion.pose());
  const auto         speed  = twist.at(motion.pose().arm(body.moments.centroid));
  const double       energy = momentum.kinetic_energy(twist, motion.pose()), dt = 1e-4;
  for (unsigned int k = 0; k < 20000; ++k)
    {
      twist = momentum.advance({}, {}, motion.pose(), dt);
      motion.commit(motion.next(k * dt, (k + 1) * dt, twist));
    }
  EXPECT_LT((centroid(body, motion.pose()) - (start + 2. * speed)).norm(), 1e-3);
  EXPECT_NEAR(momentum.kinetic_energy(twist, motion.pose()), energy, 1e-3 * energy);
}

/// About its middle axis a box tumbles (Euler): angular momentum stays, and energy to the order of the scheme.
TEST(Mass, ABoxThatTumblesKeepsItsAngularMomentum)
{
  const auto       body = box<3>({});
  Rigid::Motion<3> motion(body);
  Rigid::Twist<3>  twist;
  twist.angular_velocity[0] = .01;
  twist.angular_velocity[1] = 1.;
  Rigid::Momentum<3> momentum(body, mass, twist, motion.pose());
  const auto         angular = momentum.angular;
  const double       energy = momentum.kinetic_energy(twist, motion.pose()), dt = 1e-3;
  double             turned = 1.; // smallest angular velocity about the box's own middle axis
  for (unsigned int k = 0; k < 20000; ++k)
    {
      twist = momentum.advance({}, {}, motion.pose(), dt);
      motion.commit(motion.next(k * dt, (k + 1) * dt, twist));
      turned = std::min(turned,
                        (transpose(Rigid::rotation_matrix<3>(motion.pose().rotation)) * twist.angular_velocity)[1]);
    }
  EXPECT_LT((momentum.angular - angular).norm(), 1e-12 * angular.norm());
  EXPECT_NEAR(momentum.kinetic_energy(twist, motion.pose()), energy, 5e-3 * energy);
  EXPECT_LT(turned, -.9); // it has turned over
}
