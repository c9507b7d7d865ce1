// Contact with a rigid circle: Hertz, release, approach.

#include "solid_fixture.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;

  /// A block 2 x 1 under a circle of radius 1 that touches its upper side, or is @p gap above it.
  std::string
  block(const std::string &drive, const std::string &type, const std::string &fem, const double gap = 0.)
  {
    return one("Materials", "gel",
               "  set Law = linear elastic\n  set Young's modulus = 1000\n  set Poisson's ratio = 0.3\n") +
           "subsection Bodies\n subsection block\n  set Shape = box\n  set Lower corner = -1, -1\n  set Upper corner = 1, 0\n end\n"
           " subsection circle\n  set Shape = ball\n  set Rigid = true\n  set Radius = 1\n  set Centre = 0, " +
           std::to_string(1. + gap) + "\n end\nend\n" + drive + one("Contact", "touch", "  set Type = " + type + "\n") +
           "subsection Newton\n set Displacement tolerance = 1e-10\n set Energy tolerance = 1e-16\nend\n"
           "subsection Linear solver\n set Tolerance = 1e-12\nend\n"
           "subsection FEM\n set Contact tolerance = 1e-9\n" +
           fem + "end\n";
  }

  const std::string bottom = " subsection bottom\n  set Where = side y-min\n  set Type = clamp\n end\n";

  std::string
  pressed_by(const std::string &force)
  {
    return "subsection Supports\n" + bottom + "end\n" +
           one("Loads", "weight", "  set Where = body circle\n  set Total force = " + force + "\n");
  }

  std::string
  moved_by(const std::string &displacement)
  {
    return "subsection Supports\n" + bottom +
           " subsection drive\n  set Where = body circle\n  set Displacement = " + displacement + "\n end\nend\n";
  }

  const std::string coarse = " set Cells = 16, 8\n set Degree = 1\n";

  std::string
  box_of(const double size, const unsigned int levels, const std::string &name)
  {
    const std::string s = std::to_string(size);
    return "  subsection " + name + "\n   set Where = box -" + s + ", -" + s + " : " + s +
           ", 0\n   set Levels = " + std::to_string(levels) + "\n  end\n";
  }

  TEST(Contact, HertzPressureAndHalfWidth)
  {
    const double    P = .01, E = 1000. / (1. - .09), a = std::sqrt(4. * P / (dealii::numbers::PI * E));
    SolidFixture<2> s(block(pressed_by("0; -0.01"), "frictionless",
                            " set Kinematics = small\n" + coarse + " subsection Refinement\n" + box_of(.04, 6, "far") +
                              box_of(.016, 1, "near") + box_of(.008, 1, "contact") + " end\n"));
    s.method->setup(nullptr);
    ASSERT_TRUE(s.advance(0., 1.));
    auto result = s.scalars();
    EXPECT_NEAR(result["contact_pressure_max_circle_Pa"], 2. * P / (dealii::numbers::PI * a), 2e-3 * 1.87);
    EXPECT_NEAR(result["contact_half_width_circle_m"], a, 2e-2 * a);
    // Round-off of the gaps, 1e-16 m, times the stiffness of contact is 2e-10 N here.
    EXPECT_NEAR(result["contact_force_circle_y_N"], P, 5e-10);
    EXPECT_NEAR(result["reaction_bottom_y_N"], P, 5e-10);
    EXPECT_NEAR(result["contact_force_circle_x_N"], 0., 5e-10);
  }

  TEST(Contact, LetsGoWithoutTrace)
  {
    for (const std::string type : {"stick", "frictionless"})
      {
        SolidFixture<2> s(block(moved_by("0; -0.2*t*(2-t)"), type, coarse), {}, 2.);
        s.method->setup(nullptr);
        ASSERT_TRUE(s.advance(0., 1., 10)) << type;
        EXPECT_GT(s.scalars()["contact_force_circle_y_N"], 10.) << type;
        EXPECT_GT(s.scalars()["contact_area_circle_m2"], .5) << type;
        ASSERT_TRUE(s.advance(1., 2.2, 12)) << type;
        EXPECT_EQ(s.scalars()["contact_area_circle_m2"], 0.) << type;
        EXPECT_NEAR(s.results()["max_displacement_m"], 0., 1e-12) << type;
        EXPECT_NEAR(s.scalars()["strain_energy_J"], 0., 1e-15) << type;
      }
  }

  TEST(Contact, StickHoldsAgainstSliding)
  {
    // Pressed, then dragged sideways: without friction nothing resists but the slope of the dent.
    const std::string path = "if(t<1, 0, 0.02*(t-1)); -0.1*min(t,1)";
    double            drag[2];
    for (const bool stick : {false, true})
      {
        SolidFixture<2> s(block(moved_by(path), stick ? "stick" : "frictionless", coarse), {}, 2.);
        s.method->setup(nullptr);
        ASSERT_TRUE(s.advance(0., 2., 10));
        drag[stick] = std::abs(s.scalars()["contact_force_circle_x_N"]);
      }
    EXPECT_GT(drag[true], 3. * drag[false]);
  }

  TEST(Contact, TorqueIsAboutThePivot)
  {
    auto text = block(moved_by("0; -0.05*t"), "frictionless", coarse);
    text.replace(text.find("  set Radius = 1\n"), 0, "  set Pivot = 3, 1\n");
    SolidFixture<2> s(text);
    s.method->setup(nullptr);
    ASSERT_TRUE(s.advance(0., 1., 2));
    auto result = s.scalars();
    EXPECT_GT(std::abs(result.at("circle_force_y_N")), 1.);
    // All forces point to the circle's centre, which is 3 m left of the pivot, and their sum goes through it.
    EXPECT_NEAR(result.at("circle_torque_Nm"), -3. * result.at("circle_force_y_N"),
                1e-6 * std::abs(result.at("circle_force_y_N")));
  }

  TEST(Contact, ForceDrivenCircleFindsTheMaterial)
  {
    SolidFixture<2> touching(block(pressed_by("0; -20*t"), "stick", coarse));
    SolidFixture<2> above(block(pressed_by("0; -20*t"), "stick", coarse, .3));
    for (auto *s : {&touching, &above})
      {
        s->method->setup(nullptr);
        ASSERT_TRUE(s->advance(0., 1., 4));
        EXPECT_NEAR(s->scalars()["contact_force_circle_y_N"], 20., 1e-7);
      }
    EXPECT_NEAR(above.scalars()["displacement_circle_y_m"], touching.scalars()["displacement_circle_y_m"] - .3, 1e-9);
  }

  /// A circle of radius 1 about 0, 1 by @p n corners, one of them below.
  std::string
  circle_of_corners(const unsigned int n)
  {
    std::string corners;
    for (unsigned int i = 0; i < n; ++i)
      {
        const double angle = 2. * dealii::numbers::PI * i / n;
        corners += (i ? ", " : "") + std::to_string(std::sin(angle)) + ", " + std::to_string(1. - std::cos(angle));
      }
    return corners;
  }

  TEST(Contact, PolygonActsAsTheCircleThatItApproaches)
  {
    for (const std::string type : {"stick", "frictionless"})
      {
        double force[2];
        for (const bool is_polygon : {false, true})
          {
            auto       text  = block(moved_by("0; -0.1*t"), type, coarse);
            const auto drawn = std::string("Shape = ball\n  set Rigid = true\n  set Radius = 1\n");
            if (is_polygon)
              {
                const auto first = text.find(drawn);
                text.replace(first, text.find("end", first) - first,
                             "Shape = polygon\n  set Rigid = true\n  set Corners = " + circle_of_corners(360) + "\n ");
              }
            SolidFixture<2> s(text);
            s.method->setup(nullptr);
            ASSERT_TRUE(s.advance(0., 1., 4)) << type;
            force[is_polygon] = s.scalars()["contact_force_circle_y_N"];
            EXPECT_NEAR(s.scalars()["contact_force_circle_x_N"], 0., 1e-2 * force[is_polygon]) << type;
          }
        EXPECT_GT(force[0], 10.);
        EXPECT_NEAR(force[1], force[0], 2e-3 * force[0]) << type;
      }
  }

  /// The block with a rigid body of this drawing; it slides along its lower side, which stays in its line.
  std::string
  sliding_block(const std::string &rigid, const std::string &displacement, const std::string &fem)
  {
    return one("Materials", "gel",
               "  set Law = linear elastic\n  set Young's modulus = 1000\n  set Poisson's ratio = 0.3\n") +
           "subsection Bodies\n subsection block\n  set Shape = box\n  set Lower corner = -1, -1\n  set Upper corner = 1, 0\n end\n"
           " subsection punch\n  set Rigid = true\n" +
           rigid +
           " end\nend\nsubsection Supports\n subsection bottom\n  set Where = side y-min\n  set Displacement = free; 0\n end\n"
           " subsection middle\n  set Where = box 0, -2 : 0, 2\n  set Displacement = 0; free\n end\n"
           " subsection drive\n  set Where = body punch\n  set Displacement = " +
           displacement + "\n end\nend\n" + one("Contact", "touch", "  set Type = frictionless\n") +
           "subsection Newton\n set Displacement tolerance = 1e-10\n set Energy tolerance = 1e-16\nend\n"
           "subsection Linear solver\n set Tolerance = 1e-12\nend\n"
           "subsection FEM\n set Contact tolerance = 1e-9\n" +
           fem + "end\n";
  }

  TEST(Contact, WidePunchCompressesAlike)
  {
    // Without friction the block is free to widen: E/(1 - nu^2) times the strain, on a width of 2.
    for (const std::string shape : {"box\n  set Lower corner = -3, 0\n  set Upper corner = 3, 1\n",
                                    "polygon\n  set Corners = -3, 0, 0.1, 0, 3, 0, 3, 1, -3, 2\n"})
      {
        SolidFixture<2> s(sliding_block("  set Shape = " + shape, "0; -0.01*t", " set Kinematics = small\n" + coarse));
        s.method->setup(nullptr);
        ASSERT_TRUE(s.advance(0., 1., 2)) << shape;
        auto result = s.scalars();
        EXPECT_NEAR(result["contact_force_punch_y_N"], 2. * 1000. / .91 * .01, 1e-4) << shape;
        EXPECT_NEAR(result["contact_pressure_max_punch_Pa"], 1000. / .91 * .01, 1e-4) << shape;
      }
  }

  TEST(Contact, WedgeGoesInAndOut)
  {
    SolidFixture<2> s(sliding_block("  set Shape = polygon\n  set Corners = 0, 0, 2, 0.7, -2, 0.7\n",
                                    "0; -0.15*t*(2-t)", coarse),
                      {}, 2.);
    s.method->setup(nullptr);
    ASSERT_TRUE(s.advance(0., 1., 10));
    auto result = s.scalars();
    EXPECT_GT(result["contact_force_punch_y_N"], 10.);
    EXPECT_GT(result["contact_area_punch_m2"], .3);
    EXPECT_NEAR(result["contact_force_punch_x_N"], 0., 1e-6 * result["contact_force_punch_y_N"]);
    ASSERT_TRUE(s.advance(1., 2.2, 12));
    EXPECT_EQ(s.scalars()["contact_area_punch_m2"], 0.);
    EXPECT_NEAR(s.results()["max_displacement_m"], 0., 1e-12);
  }

  TEST(Contact, EachOfTwoBallsHasItsResults)
  {
    const std::string ball = "  set Shape = ball\n  set Rigid = true\n  set Radius = 0.3\n  set Centre = ";
    SolidFixture<2>   s(
        one("Materials", "gel", "  set Young's modulus = 1000\n  set Poisson's ratio = 0.3\n") +
        "subsection Bodies\n subsection block\n  set Shape = box\n  set Lower corner = -1, -1\n"
          "  set Upper corner = 1, 0\n end\n subsection left\n" +
        ball + "-0.5, 0.3\n end\n subsection right\n" + ball + "0.5, 0.3\n end\nend\nsubsection Supports\n" + bottom +
        "end\n"
          "subsection Loads\n subsection one\n  set Where = body left\n  set Total force = 0; -10\n end\n"
          " subsection two\n  set Where = body right\n  set Total force = 0; -20\n end\nend\n"
          "subsection Contact\n subsection a\n  set Body = left\n end\n subsection b\n  set Body = right\n end\nend\n"
          "subsection FEM\n" +
        coarse + "end\n");
    s.method->setup(nullptr);
    ASSERT_TRUE(s.advance(0., 1., 2));
    std::map<std::string, unsigned int> names;
    for (const auto &scalar : s.method->scalars)
      EXPECT_EQ(++names[scalar.first], 1u) << scalar.first;
    auto result = s.scalars();
    EXPECT_NEAR(result["contact_force_left_y_N"], 10., 1e-5);
    EXPECT_NEAR(result["contact_force_right_y_N"], 20., 1e-5);
    EXPECT_NEAR(result["reaction_bottom_y_N"], 30., 1e-5);
    EXPECT_GT(result["contact_pressure_max_left_Pa"], 10.);
    EXPECT_GT(result["contact_pressure_max_right_Pa"], 1.2 * result["contact_pressure_max_left_Pa"]);
  }

  TEST(Contact, MpiABodyWithAMassFallsAndIsThrownBack)
  {
    // 20 N on 10 kg, .3 m above the material, which weighs next to nothing: what is lost is the scheme's.
    SolidFixture<2> s(block(pressed_by("0; -20"), "frictionless", " set Inertia = true\n" + coarse, .3),
                      {"Materials/gel/Density=0.1", "Bodies/circle/Mass=10"});
    s.method->setup(nullptr);
    ASSERT_TRUE(s.advance(0., .4, 8));
    EXPECT_NEAR(s.scalars()["circle_displacement_y_m"], -.16, 1e-9) << "free fall, before it touches";
    EXPECT_NEAR(s.scalars()["kinetic_energy_J"], 20. * .16, 1e-6);
    EXPECT_EQ(s.scalars()["contact_area_circle_m2"], 0.);
    ASSERT_TRUE(s.advance(.4, .7, 15));
    auto       scalars = s.scalars();
    const auto total   = [](auto &at) {
      return at["kinetic_energy_J"] + at["strain_energy_J"] + 20. * at["circle_displacement_y_m"];
    };
    EXPECT_GT(scalars["strain_energy_J"], 1.);
    EXPECT_NEAR(total(scalars), 0., .3);
    ASSERT_TRUE(s.advance(.7, 1., 15));
    scalars = s.scalars();
    std::cout << "energy left over: " << total(scalars) << " of 6 J" << std::endl;
    EXPECT_EQ(scalars["contact_area_circle_m2"], 0.);
    EXPECT_NEAR(total(scalars), 0., .3);
  }

  TEST(Contact, MpiPressedBlock)
  {
    // Measured on one rank; other numbers of ranks must agree.
    SolidFixture<2> s(block(pressed_by("0; -20*t"), "stick", coarse));
    s.method->setup(nullptr);
    ASSERT_TRUE(s.advance(0., 1., 4));
    EXPECT_NEAR(s.scalars()["contact_force_circle_y_N"], 20., 1e-7);
    EXPECT_NEAR(s.scalars()["reaction_bottom_y_N"], 20., 1e-6);
  }
} // namespace
