// Coulomb's friction between a rigid body and material: a dragged punch, a spinning disc, a rolling one.

#include "contact_scene.h"

namespace
{
  using namespace Stroma;

  /// Coulomb's friction of coefficient @p mu.
  std::string
  coulomb(const std::string &mu)
  {
    return "Coulomb\n  set Friction coefficient = " + mu;
  }

  const std::vector<std::string> methods_with_contact = {"mpm", "fem"};

  TEST(Friction, MpiADraggedPunchSticksAndSlidesAtTheLimit)
  {
    // A flat punch wider than the block: all normals are alike, so that forces are to each other as tractions.
    const std::string punch = "  set Shape = box\n  set Lower corner = -3, 0\n  set Upper corner = 3, 2\n";
    const auto        path  = "  set Displacement = 0.2*if(t<0.5, max(0,t-0.1), 0.9-t); -0.02*min(1, 10*t)\n";
    for (const auto &method : methods_with_contact)
      if (MethodFixture::has(method))
        {
          MethodFixture s(block(punch, clamped + driven(path), "", coulomb("0.2"), gauss), method);
          ASSERT_TRUE(s.advance(0., .1, 1)) << method;
          ASSERT_TRUE(s.advance(.1, .5, 4)) << method;
          auto scalars = s.scalars();
          EXPECT_NEAR(scalars.at("contact_force_body_x_N"), -.2 * scalars.at("contact_force_body_y_N"), 1e-3) << method;
          EXPECT_NEAR(scalars.at("contact_sliding_area_body_m2"), scalars.at("contact_area_body_m2"), 1e-12) << method;
          ASSERT_TRUE(s.advance(.5, .52, 1)) << method;
          scalars = s.scalars();
          EXPECT_LT(scalars.at("contact_sliding_area_body_m2"), 1.) << method << ": back, it sticks first";
          EXPECT_GT(scalars.at("contact_force_body_x_N"), -.17 * scalars.at("contact_force_body_y_N")) << method;
          ASSERT_TRUE(s.advance(.52, 1., 12)) << method;
          scalars = s.scalars();
          EXPECT_NEAR(scalars.at("contact_force_body_x_N"), .2 * scalars.at("contact_force_body_y_N"), 1e-3) << method;
        }
  }

  TEST(Friction, MuchOfItSticksAndLittleIsFrictionless)
  {
    const auto path = clamped + driven("  set Displacement = 0.02*t; -0.05*t\n");
    for (const auto &[mu, type] : {std::pair{"100", "stick"}, {"1e-9", "frictionless"}})
      {
        MethodFixture rough(block(circle, path, "", coulomb(mu), gauss), "mpm");
        MethodFixture limit(block(circle, path, "", type, gauss), "mpm");
        ASSERT_TRUE(rough.advance(0., 1., 4)) << type;
        ASSERT_TRUE(limit.advance(0., 1., 4)) << type;
        for (const std::string name : {"contact_force_body_x_N", "contact_force_body_y_N", "strain_energy_J"})
          EXPECT_NEAR(rough.scalars().at(name), limit.scalars().at(name),
                      1e-4 * limit.scalars().at("contact_force_body_y_N"))
            << type << " " << name;
      }
  }

  TEST(Friction, ADiscSpinsUnderTheSameForceHoweverFar)
  {
    // Two radians, in few steps or many: the surface of a body is where it is, whichever way it went there.
    const auto text = block(circle,
                            clamped + driven("  set Displacement = 0; -0.02*min(1, 10*t)\n"
                                             "  set Rotation = 20/9*max(0, t - 0.1)\n"),
                            "", coulomb("0.1"), gauss);
    for (const auto &method : methods_with_contact)
      if (MethodFixture::has(method))
        for (const unsigned int n_steps : {4, 16})
          {
            MethodFixture s(text, method);
            ASSERT_TRUE(s.advance(0., .1, 1)) << method;
            ASSERT_TRUE(s.advance(.1, .2, 2)) << method;
            const auto before = s.scalars();
            ASSERT_TRUE(s.advance(.2, 1., n_steps)) << method << n_steps;
            const auto after = s.scalars();
            EXPECT_NEAR(after.at("contact_sliding_area_body_m2"), after.at("contact_area_body_m2"), 1e-12) << method;
            for (const std::string name : {"body_force_y_N", "body_force_x_N", "body_torque_Nm"})
              EXPECT_NEAR(after.at(name), before.at(name), 1e-4 * std::abs(before.at("body_force_y_N")))
                << method << name;
            // The friction's arm is the radius, and forces across the surface have none.
            EXPECT_NEAR(std::abs(after.at("body_torque_Nm")), .1 * std::abs(after.at("body_force_y_N")),
                        .03 * .1 * std::abs(after.at("body_force_y_N")))
              << method;
          }
  }

  TEST(Friction, ADiscRollsWhereItSticks)
  {
    const auto text = block(circle,
                            clamped + driven("  set Displacement = 0.1*t; -0.02*min(1, 20*t)\n  set Rotation = free\n"),
                            "", coulomb("0.3"), gauss);
    expect_alike(text, {"body_rotation_rad", "body_force_x_N", "body_force_y_N"}, 20);
    MethodFixture s(text, "mpm");
    ASSERT_TRUE(s.advance(0., 1., 20));
    EXPECT_NEAR(s.scalars().at("body_torque_Nm"), 0., 1e-6);
    EXPECT_NEAR(s.scalars().at("body_rotation_rad"), -.1, .005);
  }
} // namespace
