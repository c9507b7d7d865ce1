// Rigid bodies in a solid or a fluid: a disc that turns in a ring, a box that turns and moves in a block.

#include "solid_fixture.h"
#include "stokes_fixture.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;

  /// B of u_theta = A r + B/r between a disc of radius 1 that turns by 1 and a rim of radius 2 at rest.
  constexpr double couette_B = 4. / 3.;

  /// A disc in the hole of a ring, which @p drive turns by @p angle (a small one gives a linear problem).
  std::string
  disc_in_ring(const std::string &material, const std::string &drive, const double angle, const std::string &fem)
  {
    const std::string profile = "4/3*" + std::to_string(angle) + "*(1/(x^2+y^2)-0.25)";
    return one("Materials", "gel", material) + "subsection Constants\n set c = " + std::to_string(angle) + "\nend\n" +
           "subsection Bodies\n subsection ring\n  set Shape = ring\n  set Inner radius = 1\n  set Outer radius = 2\n"
           "  set Angles = 0, 360\n end\n subsection disc\n  set Shape = ball\n  set Radius = 1\n  set Rigid = true\n"
           " end\nend\nsubsection Supports\n subsection outer\n  set Where = rim 0, 0 : 2\n  set Type = clamp\n end\n" +
           drive + "end\nsubsection Exact solution\n set Displacement = -y*" + profile + "; x*" + profile +
           "\nend\nsubsection FEM\n" + fem + "end\n" +
           "subsection Newton\n set Displacement tolerance = 1e-9\n set Energy tolerance = 1e-14\nend\n"
           "subsection Linear solver\n set Tolerance = 1e-11\nend\n";
  }

  std::string
  on_disc(const std::string &entries)
  {
    return " subsection drive\n  set Where = body disc\n" + entries + " end\n";
  }

  struct RingErrors
  {
    double torque, displacement; ///< relative
  };

  RingErrors
  ring_errors(const unsigned int n)
  {
    const double    angle = 1e-4;
    SolidFixture<2> s(
      disc_in_ring("  set Law = linear elastic\n  set Shear modulus = 2\n  set Bulk modulus = 5\n",
                   on_disc("  set Displacement = 0; 0\n  set Rotation = c*t\n"), angle,
                   " set Kinematics = small\n set Cells = " + std::to_string(n) + ", " + std::to_string(8 * n) + "\n"));
    s.method->setup(nullptr);
    EXPECT_TRUE(s.advance(0., 1.));
    auto results = s.scalars();
    add_results(*s.method, s.scene, {}, 1., nullptr, results);
    EXPECT_NEAR(results.at("disc_rotation_rad"), angle, 1e-15);
    EXPECT_NEAR(results.at("disc_force_x_N"), 0., 1e-9);
    return {results.at("disc_torque_Nm") / (4. * dealii::numbers::PI * 2. * couette_B * angle) - 1.,
            results.at("displacement_error_L2_relative")};
  }

  TEST(MpiRigid, ADiscTurnsInARing)
  {
    const auto coarse = ring_errors(2), fine = ring_errors(4);
    EXPECT_LT(std::abs(fine.torque), 2e-3);
    EXPECT_GT(std::log2(coarse.torque / fine.torque), 3.5); // fourth order, as energies are
    EXPECT_LT(fine.displacement, 2e-3);
    EXPECT_GT(std::log2(coarse.displacement / fine.displacement), 2.7); // third
  }

  TEST(Rigid, ATorqueTurnsADiscFar)
  {
    // Of an incompressible neo-Hookean ring the torque is 4 pi G B of any angle, and turning hardly changes volumes.
    const double      angle = 1.1;
    const std::string soft  = "  set Shear modulus = 2\n  set Bulk modulus = 5\n";
    const std::string fem   = " set Cells = 4, 32\n";
    char              torque[40];
    std::snprintf(torque, sizeof(torque), "%.15g*t", 4. * dealii::numbers::PI * 2. * couette_B * angle);
    for (const std::string drive :
         {"  set Displacement = 0; 0\n  set Rotation = free\n", "  set Displacement = 0; free\n"})
      {
        SolidFixture<2> s(
          disc_in_ring(soft, on_disc(drive), angle, fem) +
          one("Loads", "turn", "  set Where = body disc\n  set Torque = " + std::string(torque) + "\n"));
        s.method->setup(nullptr);
        ASSERT_TRUE(s.advance(0., 1., 4));
        EXPECT_NEAR(s.scalars().at("disc_rotation_rad"), angle, 2e-3 * angle);
        EXPECT_NEAR(s.scalars().at("disc_torque_Nm"), std::atof(torque), 1e-6);
      }
  }

  double
  viscous_torque_error(const unsigned int n_steps)
  {
    SolidFixture<2> s(disc_in_ring("  set Law = linear elastic\n  set Shear modulus = 2\n  set Bulk modulus = 5\n"
                                   "  set Viscosity = 3\n",
                                   on_disc("  set Displacement = 0; 0\n  set Rotation = 0.5*sin(3*t)\n"), 1.,
                                   " set Kinematics = small\n set Cells = 1, 8\n"));
    s.method->setup(nullptr);
    EXPECT_TRUE(s.advance(0., 1., n_steps));
    return s.scalars().at("disc_torque_Nm");
  }

  TEST(Rigid, TorquesOfViscosityAreOfTheOrderOfTheScheme)
  {
    const double finest = viscous_torque_error(160);
    EXPECT_GT(std::log2((viscous_torque_error(10) - finest) / (viscous_torque_error(20) - finest)), 1.8);
  }

  TEST(MpiRigid, ADiscTurnsInAFluid)
  {
    const auto torque = [](const unsigned int n) {
      StokesFixture<2> s(one("Materials", "water", "  set Law = fluid\n  set Viscosity = 3\n") +
                         "subsection Bodies\n subsection ring\n  set Shape = ring\n  set Inner radius = 1\n"
                         "  set Outer radius = 2\n  set Angles = 0, 360\n end\n subsection disc\n  set Shape = ball\n"
                         "  set Radius = 1\n  set Rigid = true\n end\nend\nsubsection Supports\n subsection outer\n"
                         "  set Where = rim 0, 0 : 2\n  set Type = clamp\n end\n" +
                         on_disc("  set Type = velocity\n  set Velocity = 0; 0\n  set Angular velocity = 0.5\n") +
                         "end\nsubsection Exact solution\n set Velocity = -y*2/3*(1/(x^2+y^2)-0.25); "
                         "x*2/3*(1/(x^2+y^2)-0.25)\nend\nsubsection FEM\n set Cells = " +
                         std::to_string(n) + ", " + std::to_string(8 * n) + "\nend\n");
      const auto       results = s.run();
      EXPECT_LT(results.at("velocity_error_L2_relative"), .04 / (n * n * n));
      EXPECT_NEAR(results.at("disc_rotation_rad"), .5, 1e-15);
      return results.at("disc_torque_Nm") / (4. * dealii::numbers::PI * 3. * couette_B * .5) - 1.;
    };
    const double coarse = torque(2), fine = torque(4);
    EXPECT_LT(std::abs(fine), 2e-3);
    EXPECT_GT(std::log2(coarse / fine), 3.);
  }

  /// F = 4 pi mu U/(ln(b/a) - (b^2 - a^2)/(b^2 + a^2)) pulls a disc through a concentric shell, see cylinder_in_shell.prm.
  TEST(MpiRigid, AForcePullsADiscThroughAShell)
  {
    const auto speed = [](const unsigned int n) {
      StokesFixture<2> s(
        one("Materials", "water", "  set Law = fluid\n  set Viscosity = 3\n") +
        "subsection Bodies\n subsection ring\n  set Shape = ring\n  set Inner radius = 1\n"
        "  set Outer radius = 2\n  set Angles = 0, 360\n end\n subsection disc\n  set Shape = ball\n"
        "  set Radius = 1\n  set Rigid = true\n end\nend\nsubsection Supports\n subsection outer\n"
        "  set Where = rim 0, 0 : 2\n  set Type = clamp\n end\nend\nsubsection Loads\n subsection pull\n"
        "  set Where = body disc\n  set Total force = 12*pi/(ln(2)-0.6); 0\n end\nend\n"
        "subsection FEM\n set Cells = " +
        std::to_string(n) + ", " + std::to_string(8 * n) + "\nend\n");
      return s.run().at("disc_displacement_x_m"); // in 1 s
    };
    const double coarse = speed(2) - 1., fine = speed(4) - 1.;
    EXPECT_LT(std::abs(fine), 2e-3);
    EXPECT_GT(std::log2(coarse / fine), 3.);
  }

  /// A tank with two rigid boxes, one with its pivot off its middle. What holds them as they move as given moves them so.
  TEST(MpiRigid, ForcesMoveBodiesInAFluidAsGivenOnesGo)
  {
    const auto tank = [](const std::string &motions) {
      return "subsection Materials\n subsection water\n  set Law = fluid\n  set Viscosity = 2\n end\nend\n"
             "subsection Bodies\n subsection tank\n  set Shape = box\n  set Upper corner = 8, 8\n end\n"
             " subsection left\n  set Shape = box\n  set Rigid = true\n  set Lower corner = 2, 2\n  set Upper corner = 3, 4\n"
             "  set Pivot = 2.2, 3\n end\n"
             " subsection right\n  set Shape = box\n  set Rigid = true\n  set Lower corner = 5, 4\n  set Upper corner = 6, 5\n"
             " end\nend\nsubsection FEM\n set Cells = 8, 8\n set Degree = 2\nend\n"
             "subsection Linear solver\n set Tolerance = 1e-12\nend\n"
             "subsection Supports\n subsection wall\n  set Where = side x-min\n  set Type = clamp\n end\n"
             " subsection floor\n  set Where = side y-min\n  set Type = clamp\n end\n" +
             motions + "end\n";
    };
    StokesFixture<2> given(
      tank(" subsection left\n  set Where = body left\n  set Type = velocity\n  set Velocity = 0.1; -0.2\n"
           "  set Angular velocity = 0.3\n end\n subsection right\n  set Where = body right\n"
           "  set Type = velocity\n  set Velocity = 0; 0.1\n  set Angular velocity = 0\n end\n"));
    auto       found  = given.run();
    const auto number = [&](const std::string &name) { return std::to_string(found.at(name)); };
    // The right one slides along x as given and is free along y, where it has a force.
    StokesFixture<2> driven(
      tank(" subsection right\n  set Where = body right\n  set Type = velocity\n  set Velocity = 0; free\n end\n"
           "end\nsubsection Loads\n subsection left\n  set Where = body left\n  set Total force = " +
           number("left_force_x_N") + "; " + number("left_force_y_N") + "\n  set Torque = " + number("left_torque_Nm") +
           "\n end\n subsection right\n  set Where = body right\n  set Total force = 0; " + number("right_force_y_N") +
           "\n end\n"));
    auto moved = driven.run();
    for (const std::string name :
         {"left_displacement_x_m", "left_displacement_y_m", "left_rotation_rad", "right_displacement_y_m"})
      EXPECT_NEAR(moved.at(name), found.at(name), 1e-5) << name; // forces are given to six places
    for (const std::string name : {"left_force_x_N", "left_torque_Nm", "right_force_y_N", "reaction_wall_x_N"})
      EXPECT_NEAR(moved.at(name), found.at(name), 1e-5) << name;
  }

  /// A fluid that its weight drives past a box with the pivot off its middle; @p motion is that of the box.
  std::string
  driven_past_a_box(const std::string &motion, const std::string &periodic, const std::string &supports = "")
  {
    return "subsection Materials\n subsection water\n  set Law = fluid\n  set Viscosity = 2\n end\nend\n"
           "subsection Bodies\n subsection tank\n  set Shape = box\n  set Upper corner = 8, 8\n end\n"
           " subsection stone\n  set Shape = box\n  set Rigid = true\n  set Lower corner = 2, 2\n  set Upper corner = 3, 4\n"
           "  set Pivot = 2.5, 2.2\n end\nend\nsubsection FEM\n set Cells = 8, 8\nend\n"
           "subsection Linear solver\n set Tolerance = 1e-12\nend\n"
           "subsection Loads\n subsection weight\n  set Where = all\n  set Force density = 1; 0\n end\nend\n"
           "subsection Supports\n subsection stone\n  set Where = body stone\n  set Type = velocity\n" +
           motion + " end\n" + supports + "end\n" + periodic;
  }

  TEST(MpiRigid, WhatIsGivenOfABodyThatForcesMoveHoldsTheFluid)
  {
    const std::string along_both = "subsection Periodic\n set Directions = x, y\nend\n";
    StokesFixture<2>  turned(driven_past_a_box("  set Velocity = 0; 0\n  set Angular velocity = free\n", along_both));
    auto              found = turned.run();
    std::string       spin  = std::to_string(found.at("stone_rotation_rad"));
    EXPECT_LT(found.at("stone_rotation_rad"), -1.); // most of it is above the pivot
    EXPECT_NEAR(found.at("stone_torque_Nm"), 0., 1e-8);
    EXPECT_NEAR(found.at("stone_force_x_N"), -62., 1e-8); // all of the fluid's weight
    StokesFixture<2> given(
      driven_past_a_box("  set Velocity = 0; 0\n  set Angular velocity = " + spin + "\n", along_both));
    EXPECT_NEAR(given.run().at("stone_torque_Nm"), 0., 1e-4); // the spin is given to six places

    const std::string along_x = "subsection Periodic\n set Directions = x\nend\n",
                      slip    = " subsection floor\n  set Where = side y-min\n  set Type = symmetry\n end\n"
                                " subsection top\n  set Where = side y-max\n  set Type = symmetry\n end\n";
    StokesFixture<2> risen(driven_past_a_box("  set Velocity = 0; free\n", along_x, slip));
    found = risen.run();
    EXPECT_NEAR(found.at("stone_force_x_N"), -62., 1e-8);
    EXPECT_NEAR(found.at("stone_force_y_N"), 0., 1e-8);
    EXPECT_NEAR(found.at("stone_displacement_y_m"), 0., 1e-9); // it is the same seen from behind
    const auto refused = [](const std::string &scene) {
      try
        {
          StokesFixture<2>(scene).run();
        }
      catch (const UserError &error)
        {
          return std::string(error.what());
        }
      return std::string();
    };
    const std::string start = "test.prm:8: nothing determines the fluid's velocity ",
                      end   = "; hold a side or a rigid body there, or set 'FEM/Inertia = true'";
    EXPECT_EQ(refused(driven_past_a_box("  set Velocity = free; 0\n", along_x, slip)), start + "along x" + end);
    EXPECT_EQ(refused(driven_past_a_box("  set Velocity = 0; 0\n  set Angular velocity = free\n", "")),
              start + "of a rotation in the plane" + end);
  }

  /// Of the torque on a disc of radius 1 in a square of @p n cells a side, which does not fit it. The sides go where those of
  /// a ring of radius 2 round the disc would.
  double
  torque_error_on_steps(const unsigned int n)
  {
    const double angle = 1e-4;
    std::string  sides;
    for (const std::string side : {"x-min", "x-max", "y-min", "y-max"})
      sides += " subsection " + side + "\n  set Where = side " + side +
               "\n  set Displacement = -y*4/3*c*(1/(x^2+y^2)-0.25)*t; x*4/3*c*(1/(x^2+y^2)-0.25)*t\n end\n";
    SolidFixture<2> s(
      one("Materials", "gel", "  set Law = linear elastic\n  set Shear modulus = 2\n  set Bulk modulus = 5\n") +
      "subsection Constants\n set c = 1e-4\nend\nsubsection Bodies\n subsection square\n  set Shape = box\n"
      "  set Lower corner = -2, -2\n  set Upper corner = 2, 2\n end\n subsection disc\n  set Shape = ball\n"
      "  set Radius = 1\n  set Rigid = true\n end\nend\nsubsection Supports\n" +
      sides + on_disc("  set Displacement = 0; 0\n  set Rotation = c*t\n") +
      "end\nsubsection FEM\n set Kinematics = small\n set Material at = quadrature point\n set Cells = " +
      std::to_string(n) + ", " + std::to_string(n) + "\nend\n");
    s.method->setup(nullptr);
    EXPECT_TRUE(s.advance(0., 1.));
    EXPECT_NEAR(s.scalars().at("disc_force_x_N"), 0., 1e-9);
    return s.scalars().at("disc_torque_Nm") / (4. * dealii::numbers::PI * 2. * couette_B * angle) - 1.;
  }

  TEST(MpiRigid, ADiscThatCutsCellsHoldsTheirSteps)
  {
    const double coarse = torque_error_on_steps(12), fine = torque_error_on_steps(48);
    EXPECT_GT(fine, 0.); // steps stand out of the disc
    EXPECT_LT(fine, .08);
    EXPECT_GT(coarse, 3. * fine); // first order
    EXPECT_LT(coarse, .4);        // as a disc larger by .36 cells
  }

  /// A block held at one end with a rigid box inside.
  std::string
  box_in_block(const std::string &drive, const std::string &rest = "")
  {
    return gel() +
           "subsection Bodies\n subsection block\n  set Shape = box\n end\n subsection core\n  set Shape = box\n"
           "  set Lower corner = 0.25, 0.25, 0.25\n  set Upper corner = 0.75, 0.75, 0.75\n"
           "  set Pivot = 0.3, 0.5, 0.6\n  set Rigid = true\n end\nend\n"
           "subsection Supports\n subsection end\n  set Where = side z-min\n  set Type = clamp\n end\n"
           " subsection drive\n  set Where = body core\n" +
           drive + " end\nend\n" + rest +
           "subsection FEM\n set Cells = 4, 4, 4\n set Degree = 1\nend\n"
           "subsection Newton\n set Displacement tolerance = 1e-10\n set Energy tolerance = 1e-16\nend\n"
           "subsection Linear solver\n set Tolerance = 1e-12\nend\n";
  }

  const std::string core_path = "  set Displacement = 0.02*t; 0; 0.03*t^2\n";

  TEST(MpiRigid, ForceAndTorqueDoTheWorkOfTheMaterial)
  {
    SolidFixture<3> s(box_in_block(core_path + "  set Rotation = 0.6*t; -0.4*t; 0.8*t^2\n"));
    s.method->setup(nullptr);
    const double h = 1e-3, t = .8;
    ASSERT_TRUE(s.advance(0., t - h, 2));
    const double before = s.scalars().at("strain_energy_J");
    ASSERT_TRUE(s.advance(t - h, t));
    const auto now = s.scalars();
    ASSERT_TRUE(s.advance(t, t + h));
    const double power = (s.scalars().at("strain_energy_J") - before) / (2. * h);
    const auto   twist = s.scene.rigid_bodies[0].twist(t, 1e-5);
    double       work  = 0.;
    for (unsigned int c = 0; c < 3; ++c)
      work += now.at(std::string("core_force_") + "xyz"[c] + "_N") * twist.velocity[c] +
              now.at(std::string("core_torque_") + "xyz"[c] + "_Nm") * twist.angular_velocity[c];
    EXPECT_GT(power, .01);
    EXPECT_NEAR(work / power, 1., 1e-5);
  }

  TEST(MpiRigid, TheSameTorqueTurnsAsFar)
  {
    SolidFixture<3> turned(box_in_block(core_path + "  set Rotation = 0.3*t; -0.2*t; 0.4*t\n"));
    turned.method->setup(nullptr);
    ASSERT_TRUE(turned.advance(0., 1., 2));
    auto        driven = turned.scalars();
    std::string torque;
    for (unsigned int c = 0; c < 3; ++c)
      {
        char number[40];
        std::snprintf(number, sizeof(number), "%s%.15g*t", c > 0 ? "; " : "",
                      driven.at(std::string("core_torque_") + "xyz"[c] + "_Nm"));
        torque += number;
      }
    SolidFixture<3> free(
      box_in_block(core_path + "  set Rotation = free; free; free\n",
                   one("Loads", "turn", "  set Where = body core\n  set Torque = " + torque + "\n")));
    free.method->setup(nullptr);
    ASSERT_TRUE(free.advance(0., 1., 2));
    EXPECT_NEAR(free.scalars().at("core_rotation_x_rad"), .3, 1e-6);
    EXPECT_NEAR(free.scalars().at("core_rotation_y_rad"), -.2, 1e-6);
    EXPECT_NEAR(free.scalars().at("core_rotation_z_rad"), .4, 1e-6);
    EXPECT_NEAR(free.scalars().at("core_torque_z_Nm"), driven.at("core_torque_z_Nm"), 1e-8);
  }

  std::string
  refusal_of_block(const std::string &drive, const std::string &rest, const std::vector<std::string> &set = {})
  {
    try
      {
        SolidFixture<3> s(box_in_block(drive, rest), set);
        s.method->setup(nullptr);
      }
    catch (const UserError &error)
      {
        return error.what();
      }
    return "";
  }

  TEST(MpiRigid, BodiesThatTouchMustBeAtRest)
  {
    const auto message = [](const std::string &drive) -> std::string {
      SolidFixture<2> s(
        one("Materials", "gel", "  set Law = linear elastic\n  set Shear modulus = 2\n  set Bulk modulus = 5\n") +
        "subsection Bodies\n subsection block\n  set Shape = box\n  set Upper corner = 8, 8\n end\n"
        " subsection left\n  set Shape = box\n  set Lower corner = 2, 3\n  set Upper corner = 4, 5\n"
        "  set Rigid = true\n end\n"
        " subsection right\n  set Shape = box\n  set Lower corner = 4, 3\n  set Upper corner = 6, 5\n"
        "  set Rigid = true\n end\nend\nsubsection Supports\n subsection bottom\n  set Where = side y-min\n"
        "  set Type = clamp\n end\n subsection top\n  set Where = side y-max\n  set Displacement = 0; 0.1*t\n end\n" +
        drive + "end\nsubsection FEM\n set Cells = 8, 8\nend\n");
      try
        {
          s.method->setup(nullptr);
          EXPECT_TRUE(s.advance(0., 1.));
        }
      catch (const UserError &error)
        {
          return error.what();
        }
      return "";
    };
    EXPECT_EQ(message(""), "");
    EXPECT_NE(message(" subsection drive\n  set Where = body right\n  set Displacement = 0; 0.1*t\n end\n")
                .find("rigid bodies 'left' and 'right' touch each other"),
              std::string::npos);
  }

  TEST(Rigid, WhatDoesNotTurn)
  {
    const std::string turn = core_path + "  set Rotation = 0.3*t; 0; 0\n";
    EXPECT_NE(refusal_of_block(turn, "", {"Supports/end/Where=ball 0.5, 0.5, 0.2 : 0.2"})
                .find("support 'end' reaches the surface of rigid body 'core', which turns"),
              std::string::npos);
    EXPECT_NE(refusal_of_block(turn, "", {"FEM/Inertia=true", "Materials/gel/Density=1"})
                .find("rigid body 'core' turns, which finite elements solve only without inertia"),
              std::string::npos);
  }
} // namespace
