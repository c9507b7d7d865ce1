// What the supports and loads of a scene make of its rigid bodies.

#include <stroma/rigid/motion.h>
#include <stroma/scene/scene.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace
{
  using namespace Stroma;
  using Rigid::DrivenBy;

  /// A block with a rigid box inside; @p supports and @p loads are subsections.
  template <int dim>
  struct Block
  {
    explicit Block(const std::string &supports, const std::string &loads = "", const std::string &of_box = "",
                   const std::vector<std::string> &set = {})
      : file(with(ParameterFile::parse(text(supports, loads, of_box), "test.prm"), set))
      , parameters(file)
      , scene(parameters, MPI_COMM_WORLD)
    {}

    static ParameterFile
    with(ParameterFile file, const std::vector<std::string> &set)
    {
      for (const auto &assignment : set)
        file.set(assignment);
      return file;
    }

    static std::string
    text(const std::string &supports, const std::string &loads, const std::string &of_box)
    {
      const std::string one = dim == 2 ? "1, 1" : "1, 1, 1";
      const std::string low = dim == 2 ? "0.2, 0.2" : "0.2, 0.2, 0.2", high = dim == 2 ? "0.6, 0.4" : "0.6, 0.4, 0.4";
      return "subsection Materials\n subsection gel\n  set Law = neo-Hookean\n  set Shear modulus = 1\n"
             "  set Poisson's ratio = 0.3\n end\nend\n"
             "subsection Bodies\n subsection block\n  set Shape = box\n  set Upper corner = " +
             one + "\n end\n subsection core\n  set Shape = box\n  set Lower corner = " + low +
             "\n  set Upper corner = " + high + "\n  set Rigid = true\n" + of_box + " end\nend\nsubsection Supports\n" +
             supports + "end\nsubsection Loads\n" + loads + "end\n";
    }

    const Rigid::Body<dim> &
    core() const
    {
      return scene.rigid_bodies.at(0);
    }

    ParameterFile file;
    Parameters    parameters;
    Scene<dim>    scene;
  };

  std::string
  on_core(const std::string &entries, const std::string &name = "drive")
  {
    return " subsection " + name + "\n  set Where = body core\n" + entries + " end\n";
  }

  template <int dim>
  std::string
  message(const std::string &supports, const std::vector<std::string> &set = {})
  {
    try
      {
        Block<dim> block(supports, "", "", set);
      }
    catch (const UserError &error)
      {
        return error.what();
      }
    return "";
  }

  const std::string turning = on_core("  set Displacement = 0.1*t; free\n  set Rotation = 0.3*sin(t)\n");

  TEST(RigidBody, RestsWithoutSupportsAndLoads)
  {
    const Block<2> block("");
    EXPECT_FALSE(block.core().drive.moves());
    EXPECT_NEAR(block.core().pivot.distance(dealii::Point<2>(.4, .3)), 0., 1e-15);
    EXPECT_EQ(block.core().displacement({.2, .2}, 3.).norm(), 0.);
  }

  TEST(RigidBody, EachComponentHasItsDrive)
  {
    const Block<2> block(turning);
    const auto    &drive = block.core().drive;
    EXPECT_EQ(drive.translation[0], DrivenBy::displacement);
    EXPECT_EQ(drive.translation[1], DrivenBy::free);
    EXPECT_EQ(drive.rotation[0], DrivenBy::displacement);
    const Block<2> pushed(turning,
                          on_core("  set Total force = 1; 2\n", "push") + on_core("  set Torque = 3\n", "turn"));
    EXPECT_EQ(pushed.core().drive.translation[0], DrivenBy::displacement);
    EXPECT_EQ(pushed.core().drive.translation[1], DrivenBy::force);
    EXPECT_EQ(pushed.core().drive.rotation[0], DrivenBy::displacement);
    EXPECT_EQ(pushed.core().drive.force(0.)[1], 2.);
    EXPECT_EQ(pushed.core().drive.torque(0.)[0], 3.);
    const Block<2> turned("", on_core("  set Torque = 3\n"));
    EXPECT_EQ(turned.core().drive.translation[0], DrivenBy::rest);
    EXPECT_EQ(turned.core().drive.rotation[0], DrivenBy::force);
    const Block<2> clamped(on_core("  set Type = clamp\n"), on_core("  set Torque = 3\n", "turn"));
    EXPECT_FALSE(clamped.core().drive.moves());
    const Block<3> spun(on_core("  set Type = velocity\n  set Velocity = 0; 0; 1\n  set Angular velocity = 0; t; 0\n"));
    EXPECT_EQ(spun.core().drive.translation[0], DrivenBy::rest);
    EXPECT_EQ(spun.core().drive.translation[2], DrivenBy::velocity);
    EXPECT_EQ(spun.core().drive.rotation[0], DrivenBy::velocity);
  }

  TEST(RigidBody, TurnsAboutItsPivot)
  {
    const Block<2>         block(turning, "", "  set Pivot = 0.2, 0.3\n");
    const dealii::Point<2> X(.6, .3);
    const double           t = .7, angle = .3 * std::sin(t);
    const auto             u = block.core().displacement(X, t);
    EXPECT_NEAR(u[0], .1 * t + .4 * (std::cos(angle) - 1.), 1e-15);
    EXPECT_NEAR(u[1], .4 * std::sin(angle), 1e-15);
    const auto v = block.core().velocity(X, t, 1e-5);
    EXPECT_NEAR(v[0], .1 - .4 * std::sin(angle) * .3 * std::cos(t), 1e-9);
    EXPECT_NEAR(v[1], .4 * std::cos(angle) * .3 * std::cos(t), 1e-9);
    EXPECT_NEAR(block.core().velocity(X, 0., 1e-5)[1], .4 * .3, 1e-9);
  }

  TEST(RigidBody, VelocityIsTheRateOfDisplacementInSpace)
  {
    const Block<3>         block(on_core("  set Displacement = t^2; 0; -t\n  set Rotation = 0.5*t; t^2; 0.3*sin(t)\n"));
    const dealii::Point<3> X(.6, .2, .4);
    const double           t = .8, h = 1e-5;
    const auto difference = (block.core().displacement(X, t + h) - block.core().displacement(X, t - h)) / (2. * h);
    EXPECT_LT((block.core().velocity(X, t, h) - difference).norm(), 1e-9);
  }

  TEST(RigidBody, ResultsAreNamedAfterIt)
  {
    const auto names = [](const auto &results) {
      std::string all;
      for (const auto &[name, value] : results)
        all += name + " ";
      return all;
    };
    const Block<2> plane(turning);
    EXPECT_EQ(
      names(plane.core().results({}, {}, {})),
      "core_displacement_x_m core_displacement_y_m core_rotation_rad core_force_x_N core_force_y_N core_torque_Nm ");
    const Block<3> space("");
    EXPECT_EQ(names(space.core().results({}, {}, {})),
              "core_force_x_N core_force_y_N core_force_z_N core_torque_x_Nm core_torque_y_Nm core_torque_z_Nm ");
  }

  TEST(RigidMotion, IntegratesVelocitiesAndGoesThroughACheckpoint)
  {
    const Block<2>   block(on_core("  set Type = velocity\n  set Velocity = 1; 2*t\n  set Angular velocity = 4\n"));
    Rigid::Motion<2> motion(block.core());
    for (unsigned int i = 0; i < 10; ++i)
      motion.commit(motion.next(.1 * i, .1 * (i + 1)));
    EXPECT_NEAR(motion.pose().translation[0], 1., 1e-14);
    EXPECT_NEAR(motion.pose().translation[1], 1.1, 1e-14); // with the velocity at the end of each step
    EXPECT_NEAR(motion.pose().rotation[0], 4., 1e-14);
    const std::string path = ::testing::TempDir() + "stroma_rigid_motion.h5";
    {
      Output::ArchiveWriter archive(path, MPI_COMM_WORLD);
      motion.save(archive);
      archive.commit();
    }
    Rigid::Motion<2> other(block.core());
    other.load(Output::ArchiveReader(path, MPI_COMM_WORLD));
    EXPECT_EQ(other.pose().translation, motion.pose().translation);
    EXPECT_EQ(other.pose().rotation, motion.pose().rotation);
    std::remove(path.c_str());
  }

  TEST(RigidMotion, FollowsDisplacements)
  {
    const Block<2>         block(turning);
    const Rigid::Motion<2> motion(block.core());
    const auto             next = motion.next(.2, .3);
    EXPECT_EQ(next.translation[0], .1 * .3);
    EXPECT_EQ(next.translation[1], 0.);
    EXPECT_EQ(next.rotation[0], .3 * std::sin(.3));
  }

  TEST(RigidBody, WhatHasNoMeaning)
  {
    const std::string clamp = "  set Type = clamp\n";
    EXPECT_NE(message<2>(on_core(clamp) + on_core(clamp, "more")).find("rigid body 'core' has two supports"),
              std::string::npos);
    EXPECT_NE(message<3>(on_core("  set Displacement = 0; 0; 0\n  set Rotation = free; 0; 0\n"))
                .find("leaves some components of a rotation free"),
              std::string::npos);
    EXPECT_NE(message<2>(on_core("  set Displacement = 0; 0\n  set Rotation = x*t\n")).find("depends on place"),
              std::string::npos);
    EXPECT_NE(message<2>(turning, {"Periodic/Directions=x", "Bodies/core/Lower corner=0, 0.2"})
                .find("turns, but reaches a side where the scene repeats"),
              std::string::npos);
  }

  TEST(RigidBody, MethodsSayWhatTheyHandle)
  {
    Scene<2>::Abilities can;
    can.rigid_bodies   = true;
    const auto refusal = [&](const Block<2> &block) -> std::string {
      try
        {
          block.scene.require("fem", can);
        }
      catch (const UserError &error)
        {
          return error.what();
        }
      return "";
    };
    const std::string end = ", which 'Method = fem' does not solve; ";
    EXPECT_EQ(refusal(Block<2>("")), "");
    EXPECT_NE(refusal(Block<2>(turning)).find("'core' is left free to move" + end), std::string::npos);
    EXPECT_NE(refusal(Block<2>("", on_core("  set Total force = 1; 0\n"))).find("'core' is moved by a force" + end),
              std::string::npos);
    can.rigid_forces = true;
    EXPECT_NE(refusal(Block<2>(turning)).find("'core' turns" + end), std::string::npos);
    can.rigid_rotations = true;
    EXPECT_EQ(refusal(Block<2>(turning)), "");
    EXPECT_NE(refusal(Block<2>("", on_core("  set Torque = 1\n"))).find("'core' is turned by a torque" + end),
              std::string::npos);
    can.rigid_torques = true;
    EXPECT_EQ(refusal(Block<2>("", on_core("  set Torque = 1\n"))), "");
  }
} // namespace
