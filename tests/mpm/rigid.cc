// A disc that turns in an elastic square: u_theta = B / r, torque 4 pi mu B, where the sides follow that.

#include "method_fixture.h"

#include <gtest/gtest.h>

namespace
{
  using namespace Stroma;

  constexpr double angle = 1e-4, radius = .3, mu = 2.;

  std::string
  turning_disc(const unsigned int cells, const std::string &mpm)
  {
    const std::string B = "(1e-4*0.09*t)"; // angle radius^2
    std::string       text =
      "set Dimension = 2\n"
      "subsection Materials\n subsection gel\n set Law = neo-Hookean\n set Shear modulus = 2\n"
      " set Bulk modulus = 5\n end\nend\n"
      "subsection Bodies\n"
      " subsection gel\n set Shape = box\n set Lower corner = -1, -1\n set Upper corner = 1, 1\n end\n"
      " subsection disc\n set Shape = ball\n set Centre = 0, 0\n set Radius = 0.3\n set Rigid = true\n"
      " end\nend\nsubsection Supports\n"
      " subsection disc\n set Where = body disc\n set Displacement = 0; 0\n set Rotation = 1e-4*t\n end\n";
    for (const std::string side : {"x-min", "x-max", "y-min", "y-max"})
      text += " subsection " + side + "\n set Where = side " + side + "\n set Displacement = -" + B + "*y/(x^2+y^2); " +
              B + "*x/(x^2+y^2)\n end\n";
    const std::string n = std::to_string(cells);
    return text + "end\nsubsection MPM\n set Cells = " + n + ", " + n + "\n" + mpm + "end\n";
  }

  TEST(RigidSurfaces, MpiADiscThatTurnsHasItsTorque)
  {
    const double exact = 4. * dealii::numbers::PI * mu * angle * radius * radius; // [N m] a metre
    for (const std::string shape : {"linear", "quadratic B-spline"})
      {
        double last = 1.;
        for (const unsigned int cells : {16, 32})
          {
            MethodFixture s(turning_disc(cells, " set Shape functions = " + shape + "\n"), "mpm");
            ASSERT_TRUE(s.advance(0., 1., 1));
            const auto   scalars = s.scalars();
            const double error   = scalars.at("disc_torque_Nm") / exact - 1.;
            std::cout << shape << ", " << cells << " cells: torque " << scalars.at("disc_torque_Nm") << ", error "
                      << error << std::endl;
            EXPECT_NEAR(scalars.at("disc_rotation_rad"), angle, 1e-18);
            EXPECT_LT(std::abs(scalars.at("disc_force_x_N")), 1e-9);
            EXPECT_LT(std::abs(error), last);
            last = std::abs(error);
          }
        EXPECT_LT(last, .02);
      }
  }

  TEST(RigidSurfaces, MpiATorqueTurnsTheDiscAsFar)
  {
    MethodFixture given(turning_disc(16, ""), "mpm");
    ASSERT_TRUE(given.advance(0., 1., 1));
    char torque[40];
    std::snprintf(torque, sizeof(torque), "%.15g*t", given.scalars().at("disc_torque_Nm"));
    auto       text = turning_disc(16, "");
    const auto turn = std::string(" set Displacement = 0; 0\n set Rotation = 1e-4*t\n");
    text.replace(text.find(turn), turn.size(), " set Displacement = free; 0\n set Rotation = free\n");
    text += std::string("subsection Loads\n subsection turn\n set Where = body disc\n set Torque = ") + torque +
            "\n set Total force = 1e-5*t; 0\n end\nend\n" +
            "subsection Newton\n set Displacement tolerance = 1e-10\n set Energy tolerance = 1e-16\nend\n";
    MethodFixture s(text, "mpm");
    ASSERT_TRUE(s.advance(0., 1., 2));
    EXPECT_NEAR(s.scalars().at("disc_rotation_rad"), angle, 1e-6 * angle);
    EXPECT_NEAR(s.scalars().at("disc_force_x_N"), 1e-5, 1e-10);
    EXPECT_GT(s.scalars().at("disc_displacement_x_m"), 1e-8);
  }

  TEST(RigidSurfaces, MpiARingIsBondedAsTheDiscWithinIt)
  {
    double torque[2];
    for (const bool is_ring : {false, true})
      {
        auto text = turning_disc(32, "");
        if (is_ring)
          {
            const std::string ball = "Shape = ball\n set Centre = 0, 0\n set Radius = 0.3\n";
            text.replace(text.find(ball), ball.size(),
                         "Shape = ring\n set Centre = 0, 0\n set Inner radius = 0.15\n set Outer radius = 0.3\n"
                         " set Angles = 0, 360\n");
          }
        MethodFixture s(text, "mpm");
        ASSERT_TRUE(s.advance(0., 1., 1));
        torque[is_ring] = s.scalars().at("disc_torque_Nm");
      }
    EXPECT_NEAR(torque[1], torque[0], .05 * std::abs(torque[0])); // the gel within the ring turns with it
  }

  TEST(RigidSurfaces, MpiAPolygonIsBondedAsTheBoxOfItsShape)
  {
    double torque[2];
    for (const bool is_polygon : {false, true})
      {
        auto              text = turning_disc(16, "");
        const std::string ball = "Shape = ball\n set Centre = 0, 0\n set Radius = 0.3\n";
        text.replace(text.find(ball), ball.size(),
                     is_polygon ? "Shape = polygon\n set Corners = -0.2, -0.1, 0.2, -0.1, 0.2, 0.1, -0.2, 0.1\n" :
                                  "Shape = box\n set Lower corner = -0.2, -0.1\n set Upper corner = 0.2, 0.1\n");
        MethodFixture s(text, "mpm");
        ASSERT_TRUE(s.advance(0., 1., 1));
        torque[is_polygon] = s.scalars().at("disc_torque_Nm");
      }
    EXPECT_GT(torque[0], 1e-5);
    EXPECT_NEAR(torque[1], torque[0], 1e-8 * torque[0]); // the same places, in another order
  }

  TEST(RigidSurfaces, AreRefusedUnderALaterBody)
  {
    auto       text  = turning_disc(8, "");
    const auto cover = std::string(" subsection cover\n set Shape = box\n set Lower corner = -1, -1\n"
                                   " set Upper corner = 1, 1\n end\n");
    text.replace(text.find("end\nsubsection Supports"), 0, cover);
    EXPECT_THROW(MethodFixture(text, "mpm"), UserError);
  }

  TEST(RigidSurfaces, AreRefusedOnGridsThatAreReset)
  {
    EXPECT_THROW(MethodFixture(turning_disc(8, " set Grid reset = always\n"), "mpm"), UserError);
  }
} // namespace
