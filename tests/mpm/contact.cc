// Contact with rigid bodies: tangent, uniform pressure, finite elements beside, bodies that forces move and turn.

#include "contact_scene.h"
#include "differences.h"

#include <stroma/rigid/contact_rounds.h>

#include <gtest/gtest.h>

#include <random>

namespace
{
  using namespace Stroma;

  /// A box of material, held nowhere, under a rigid body that is free to move and turn, in the plane or in space.
  template <int dim>
  std::string
  free_body(const std::string &shape, const std::string &type)
  {
    const std::string z = dim == 2 ? "" : ", 1", free = dim == 2 ? "free" : "free; free; free",
                      all = dim == 2 ? "free; free" : "free; free; free", up = dim == 2 ? "0; 1" : "0; 1; 0";
    return gel + "subsection Bodies\n subsection block\n  set Shape = box\n  set Upper corner = 1, 1" + z +
           "\n end\n subsection body\n  set Rigid = true\n" + shape + " end\nend\nsubsection Supports\n" +
           driven("  set Displacement = " + all + "\n  set Rotation = " + free + "\n") + "end\n" +
           "subsection Loads\n subsection load\n  set Where = body body\n  set Total force = " + up +
           "\n end\nend\nsubsection Contact\n subsection touch\n  set Type = " + type + "\n end\nend\n" +
           "subsection MPM\n set Cells = " + (dim == 2 ? "3, 2" : "2, 2, 2") + "\nend\n";
  }

  template <int dim>
  void
  check_tangent(const std::string &shape, const std::string &type)
  {
    SystemFixture<dim> s(free_body<dim>(shape, type));
    Vector             u = s.system->new_vector(), r = u;
    Rigid::start_step(*s.system, s.system->touching, u);
    std::mt19937 random(5);
    for (auto &value : u)
      value = .02 * (random() / 4294967295. - .5);
    u(s.system->bodies.unknown(0, 1)) = -.08;
    for (unsigned int k = 0; k < Rigid::n_rotations<dim>; ++k)
      u(s.system->bodies.unknown(0, dim + k)) = .05 - .03 * k;
    auto &touching = s.system->touching;
    EXPECT_TRUE(touching.update(s.system->with_ghosts(u))); // they enter
    touching.update(s.system->with_ghosts(u));              // and have multipliers
    Matrix K;
    s.system->residual(r, u);
    s.system->tangent(K, r, u);
    EXPECT_GT(std::abs(r(s.system->bodies.unknown(0, 1))), 1.);
    const auto errors = tangent_errors(*s.system, K, u, dim == 2 ? 1 : 0);
    std::cout << dim << "D " << type << ": " << errors.worst / errors.scale << ", " << errors.skew / errors.scale
              << std::endl;
    EXPECT_LT(errors.worst / errors.scale, 1e-7);
    EXPECT_LT(errors.skew / errors.scale, 1e-7);
  }

  TEST(Contact, TangentIsTheDerivativeHoweverTheBodyTurns)
  {
    check_tangent<2>("  set Shape = ball\n  set Centre = 0.6, 1.5\n  set Radius = 0.5\n", "stick");
    check_tangent<2>("  set Shape = box\n  set Lower corner = 0.2, 1\n  set Upper corner = 0.9, 1.5\n", "frictionless");
    check_tangent<3>("  set Shape = ball\n  set Centre = 0.6, 1.5, 0.4\n  set Radius = 0.5\n", "stick");
    check_tangent<3>("  set Shape = box\n  set Lower corner = 0.2, 1, -0.2\n  set Upper corner = 0.9, 1.5, 1.1\n",
                     "frictionless");
  }

  TEST(Contact, MpiAWidePunchCompressesAlikeOnAnyGrid)
  {
    // Without friction the block is free to widen: what it bears is the same all over, wherever cells end.
    const std::string   punch  = "  set Shape = box\n  set Lower corner = -3, TOP\n  set Upper corner = 3, 2\n";
    const std::string   roller = " subsection bottom\n  set Where = side y-min\n  set Displacement = free; 0\n end\n"
                                 " subsection left\n  set Where = side x-min\n  set Displacement = 0; free\n end\n";
    std::vector<double> forces;
    for (const std::string grid : {"", " set Upper corner = 1, 0.07\n", " set Upper corner = 1.06, 0.12\n",
                                   " set Shape functions = quadratic B-spline\n"})
      {
        auto at_top = punch;
        at_top.replace(at_top.find("TOP"), 3, "0");
        MethodFixture s(block(at_top, roller + driven("  set Displacement = 0; -0.1*t\n"), "", "frictionless", grid),
                        "mpm");
        ASSERT_TRUE(s.advance(0., 1., 2)) << grid;
        const auto scalars = s.scalars();
        forces.push_back(scalars.at("contact_force_body_y_N"));
        EXPECT_NEAR(scalars.at("reaction_bottom_y_N"), forces.back(), 1e-5 * forces.back()) << grid;
        EXPECT_NEAR(scalars.at("contact_area_body_m2"), 2., .13) << grid; // the corners' on the sides touch as well
        if (grid.find("spline") != std::string::npos) // areas integrate the first and last functions of splines to 1 %
          EXPECT_NEAR(scalars.at("contact_pressure_max_body_Pa"), .5 * forces.back(), .02 * forces.back());
        else
          { // Beyond the end of the surface what touches on the sides is not borne by a node of its own.
            const double part = grid.find("1.06") == std::string::npos ? 1e-5 : 5e-5;
            EXPECT_NEAR(scalars.at("contact_pressure_max_body_Pa"), .5 * forces.back(), part * forces.back()) << grid;
          }
      }
    EXPECT_GT(forces[0], 200.);
    for (std::size_t i = 0; i < forces.size(); ++i) // the last is that of splines
      EXPECT_NEAR(forces[i], forces[0], (i + 1 < forces.size() ? 1e-5 : 2e-4) * forces[0]);
  }

  TEST(Contact, MpiAPressedCircleIsThatOfFiniteElements)
  {
    for (const std::string type : {"stick", "frictionless"})
      expect_alike(block(circle, clamped + driven("  set Displacement = 0; free\n"), "  set Total force = 0; -60*t\n",
                         type, gauss),
                   {"displacement_body_y_m", "contact_force_body_y_N", "contact_pressure_max_body_Pa",
                    "contact_area_body_m2", "reaction_bottom_y_N", "strain_energy_J"},
                   3);
  }

  TEST(Contact, ARollingDiscTurnsAsFarAsItGoes)
  {
    const auto text = block(circle,
                            clamped + driven("  set Displacement = 0.1*t; -0.02*min(1, 20*t)\n  set Rotation = free\n"),
                            "", "stick", gauss);
    expect_alike(text, {"body_rotation_rad", "body_force_x_N", "body_force_y_N"}, 20);
    MethodFixture s(text, "mpm");
    ASSERT_TRUE(s.advance(0., 1., 20));
    const auto scalars = s.scalars();
    EXPECT_NEAR(scalars.at("body_torque_Nm"), 0., 1e-6);
    EXPECT_NEAR(scalars.at("body_rotation_rad"), -.1, .005);
  }

  TEST(Contact, ADiscThatTurnsDragsItselfAlong)
  {
    const auto    text = block(circle, clamped + driven("  set Displacement = free; free\n  set Rotation = -0.2*t\n"),
                               "  set Total force = 0; -20*min(1, 20*t)\n", "stick", gauss);
    MethodFixture s(text, "mpm");
    ASSERT_TRUE(s.advance(0., 1., 20));
    const auto scalars = s.scalars();
    EXPECT_NEAR(scalars.at("body_displacement_x_m"), .2, .01);
    EXPECT_NEAR(scalars.at("body_force_x_N"), 0., 1e-5);
    EXPECT_NEAR(scalars.at("body_force_y_N"), -20., 1e-4);
  }

  TEST(Contact, LetsGoWithoutTrace)
  {
    for (const std::string type : {"stick", "frictionless"})
      {
        MethodFixture s(block(circle, clamped + driven("  set Displacement = 0; -0.2*t*(2-t)\n"), "", type, ""), "mpm",
                        2.);
        ASSERT_TRUE(s.advance(0., 1., 10)) << type;
        EXPECT_GT(s.scalars().at("contact_force_body_y_N"), 10.) << type;
        ASSERT_TRUE(s.advance(1., 2.2, 12)) << type;
        EXPECT_EQ(s.scalars().at("contact_area_body_m2"), 0.) << type;
        EXPECT_NEAR(s.scalars().at("strain_energy_J"), 0., 1e-12) << type;
      }
  }

  const std::string hinged = "  set Displacement = 0; 0\n  set Rotation = free\n";

  TEST(Contact, ATorqueTurnsABodyUntilItTouches)
  {
    // However many steps: nothing but the material bears it.
    const std::string   paddle = "  set Shape = box\n  set Lower corner = 0, 0.1\n  set Upper corner = 0.9, 0.2\n"
                                 "  set Pivot = 0, 0.15\n";
    const auto          text   = block(paddle, clamped + driven(hinged), "  set Torque = -1\n", "frictionless", gauss);
    std::vector<double> turned;
    for (const unsigned int n_steps : {1, 4})
      {
        MethodFixture s(text, "mpm");
        ASSERT_TRUE(s.advance(0., 1., n_steps));
        turned.push_back(s.scalars().at("body_rotation_rad"));
        EXPECT_GT(s.scalars().at("contact_area_body_m2"), 0.);
        EXPECT_NEAR(s.scalars().at("body_torque_Nm"), -1., 1e-6);
      }
    EXPECT_LT(turned[0], -.11); // the corner's way of 0.1 on an arm of 0.9
    EXPECT_NEAR(turned[1], turned[0], 1e-6);
    expect_alike(text, {"body_rotation_rad", "contact_area_body_m2", "strain_energy_J"}, 2);
  }

  TEST(Contact, NothingBearsALoadThatPullsABodyOff)
  {
    for (const std::string method : {"mpm", "fem"})
      if (MethodFixture::has(method))
        {
          MethodFixture s(block(circle, clamped + driven("  set Displacement = 0; free\n"),
                                "  set Total force = 0; 20*(t-0.75)\n", "frictionless", gauss),
                          method);
          ASSERT_TRUE(s.advance(0., .5, 2)) << method;
          const double pressed = s.scalars().at("displacement_body_y_m");
          EXPECT_EQ(s.method->advance(.5, 1., s.work), StepStatus::not_borne) << method;
          EXPECT_EQ(s.scalars().at("displacement_body_y_m"), pressed) << method;
        }
  }

  TEST(Contact, NothingBearsATorqueThatTurnsABallInTheAir)
  {
    const std::string ball = "  set Shape = ball\n  set Centre = 0, 1.1\n  set Radius = 1\n";
    MethodFixture     s(block(ball, clamped + driven(hinged), "  set Torque = -1\n", "stick", gauss), "mpm");
    EXPECT_EQ(s.method->advance(0., 1., s.work), StepStatus::not_borne);
  }

  TEST(Contact, ForcesAreThoseOfTheBalance)
  {
    MethodFixture s(block(circle, clamped + driven("  set Displacement = 0; -0.3*t\n"), "", "stick", gauss), "mpm");
    ASSERT_TRUE(s.advance(0., 1., 2));
    const auto   scalars = s.scalars();
    const double force   = scalars.at("contact_force_body_y_N");
    EXPECT_GT(force, 100.);
    EXPECT_NEAR(scalars.at("body_force_y_N"), -force, 1e-9 * force);
  }

  TEST(Contact, ABodyThatReachesATouchIntoTheMaterialTouchesAllOfIt)
  {
    // By less than the depth that is allowed; the circle covers a part of the surface then.
    std::vector<double> areas, pressures;
    for (const std::string centre : {"1", "0.9999"})
      {
        MethodFixture s(block("  set Shape = ball\n  set Centre = 0, " + centre + "\n  set Radius = 1\n",
                              clamped + driven("  set Displacement = 0; free\n"), "  set Total force = 0; -6*t\n",
                              "frictionless", gauss),
                        "mpm");
        ASSERT_TRUE(s.advance(0., 1., 1));
        areas.push_back(s.scalars().at("contact_area_body_m2"));
        pressures.push_back(s.scalars().at("contact_pressure_max_body_Pa"));
      }
    EXPECT_NEAR(areas[1], areas[0], 1e-12);
    EXPECT_NEAR(pressures[1], pressures[0], 1e-3 * pressures[0]);
  }

  TEST(Contact, ABodyThatTouchesExactlyIsNotInside)
  {
    for (const std::string top : {"0.1", "0.3", "0.6", "0.7", "1/30"})
      EXPECT_NO_THROW(
        MethodFixture(block("  set Shape = box\n  set Lower corner = -3, " + top + "\n  set Upper corner = 3, 2\n",
                            clamped, "", "stick", "", top),
                      "mpm"))
        << top;
  }

  TEST(Contact, BodiesInTheMaterialAreRefused)
  {
    const std::string inside = "  set Shape = ball\n  set Centre = 0, -0.5\n  set Radius = 0.2\n";
    EXPECT_THROW(MethodFixture(block(inside, clamped, "", "stick", ""), "mpm"), UserError);
  }
} // namespace
