// Voxels that stay an image against the points that they stand for; what is seen of points that the solve does not take.

#include "../base/message_of.h"
#include "label_file.h"
#include "method_fixture.h"
#include "solve.h"

#include <stroma/base/memory.h>
#include <stroma/mpm/size.h>
#include <stroma/output/point_results.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace
{
  using namespace Stroma;

  /// Labels 0 to 2 at random.
  LabelFile
  random_labels(const unsigned int nx, const unsigned int ny, const unsigned int seed)
  {
    std::mt19937 random(seed);
    return {nx, ny, [&](unsigned int, unsigned int) { return random() % 8 == 0 ? 2 : random() % 3 == 0 ? 1 : 0; }};
  }

  /// Two images, the second over a part of the first, whose voxels cells cut; label 2 is empty in the second.
  std::string
  two_images(const LabelFile &one, const LabelFile &other, const std::string &more)
  {
    const auto body = [](const std::string &name, const LabelFile &labels, const std::string &entries) {
      return " subsection " + name + "\n set Shape = image\n set File = " + labels.path.string() + "\n" + entries +
             " end\n";
    };
    return "set Dimension = 2\nsubsection Units\n set Length = um\nend\n"
           "subsection Materials\n"
           " subsection soft\n set Law = neo-Hookean\n set Shear modulus = 100\n set Bulk modulus = 200\n end\n"
           " subsection stiff\n set Law = neo-Hookean\n set Shear modulus = 900\n set Bulk modulus = 1500\n end\nend\n"
           "subsection Bodies\n" +
           body("below", one, " set Materials = 0: soft, 1: stiff, 2: soft\n") +
           body("above", other, " set Corner = 8.5, 4.25, 0\n set Materials = 0: soft, 1: stiff, 2: empty\n") +
           "end\n"
           "subsection Supports\n subsection bottom\n set Where = side y-min\n set Type = clamp\n end\n"
           " subsection top\n set Where = side y-max\n set Displacement = 0.3*t; 2*t\n end\nend\n"
           "subsection MPM\n set Cells = 5, 3\n set Interface = composite cells\n set Integration = two moments\nend\n"
           "subsection Newton\n set Displacement tolerance = 1e-10\n set Energy tolerance = 1e-16\nend\n" +
           more;
  }

  /// What a run of a step says of its state.
  std::map<std::string, double>
  results_of(const std::string &text, bool &are_voxels)
  {
    MethodFixture run(text, "mpm");
    EXPECT_TRUE(run.advance(0., 1., 1));
    auto       results = run.scalars();
    const auto state   = run.method->state(false);
    Output::add_point_results(*state, {2, true, false, {}}, MPI_COMM_WORLD, results);
    double volume = 0, first = 0;
    state->for_each_point([&](const auto &point) {
      volume += point.V0;
      first += point.V0 * point.X[0] * point.u[1] * point.J;
    });
    results["volume"] = dealii::Utilities::MPI::sum(volume, MPI_COMM_WORLD);
    results["first"]  = dealii::Utilities::MPI::sum(first, MPI_COMM_WORLD);
    Output::Summary summary;
    run.method->describe(summary);
    results["n"] = summary.n_points;
    are_voxels = std::find(summary.used.begin(), summary.used.end(), "voxels instead of points") != summary.used.end();
    EXPECT_EQ(summary.bytes_per_point == 1., are_voxels);
    return results;
  }

  TEST(MpiVoxels, GiveWhatTheirPointsGive)
  {
    const LabelFile one = random_labels(24, 18, 1), other = random_labels(13, 11, 2);
    bool            are_voxels = false;
    const auto      found      = results_of(two_images(one, other, ""), are_voxels);
    EXPECT_TRUE(are_voxels);
    const auto kept = results_of(two_images(one, other,
                                            "subsection Loads\n subsection none\n set Where = all\n"
                                            " set Total force = 0; 0\n end\nend\n"),
                                 are_voxels);
    EXPECT_FALSE(are_voxels); // a load acts on points
    ASSERT_EQ(found.size(), kept.size());
    for (const auto &[name, value] : kept)
      EXPECT_NEAR(found.at(name), value, 1e-11 * std::abs(value) + 1e-18) << name;
    EXPECT_GT(found.at("von_mises_p99_Pa"), 1.);
  }

  /// An image of its own under the supports of two_images(), with a voxel or a part of one in each cell.
  std::string
  one_image(const LabelFile &labels, const std::string &cells, const std::string &points)
  {
    std::string text  = two_images(labels, labels, "");
    const auto  above = text.find(" subsection above");
    text.erase(above, text.find(" end\n", above) + 5 - above);
    const auto mpm = text.find("subsection MPM"), newton = text.find("subsection Newton");
    text.replace(mpm, newton - mpm, "subsection MPM\n set Cells = " + cells + "\n" + points + "end\n");
    return text;
  }

  /// A cell that a voxel fills has its Gauss points, and so has each part of one that several cells share.
  TEST(MpiVoxels, AsBoxesFillTheirCells)
  {
    const LabelFile labels = random_labels(12, 9, 4);
    for (const std::string cells : {"12, 9", "24, 18"})
      {
        bool       are_voxels = false;
        const auto whole      = results_of(one_image(labels, cells, " set Integration = two moments\n"), are_voxels);
        EXPECT_TRUE(are_voxels);
        const auto gauss = results_of(one_image(labels, cells, " set Points at = Gauss points\n"), are_voxels);
        EXPECT_FALSE(are_voxels);
        for (const std::string name : {"reaction_bottom_y_N", "reaction_bottom_x_N", "strain_energy_J"})
          EXPECT_NEAR(whole.at(name), gauss.at(name), 1e-9 * std::abs(gauss.at(name))) << name;
      }
  }

  TEST(MpiVoxels, StayAnImageByDefaultWhereNoPointIsKept)
  {
    const LabelFile labels = random_labels(24, 18, 6);
    const auto      stay   = [&](const std::string &mpm, const std::string &more = "") {
      SCOPED_TRACE(mpm + more);
      bool are_voxels = false;
      results_of(one_image(labels, "12, 9", mpm) + more, are_voxels);
      return are_voxels;
    };
    EXPECT_TRUE(stay(""));
    for (const auto &mpm :
         {" set Integration = all points\n", " set Grid reset = when distorted\n set Margin above = 6, 6\n",
          " set Points at = Gauss points\n", " set Shape functions = quadratic B-spline\n",
          " set Dilatation = projected\n"})
      EXPECT_FALSE(stay(mpm)) << mpm;
    EXPECT_FALSE(
      stay("", "subsection Loads\n subsection push\n set Where = all\n set Total force = 0; 0\n end\nend\n"));
    auto beside = one_image(labels, "12, 9", "");
    beside.insert(beside.find("end\nsubsection Supports"),
                  " subsection drawn\n set Shape = box\n set Upper corner = 2, 2\n set Material = stiff\n end\n");
    bool are_voxels = true;
    results_of(beside, are_voxels);
    EXPECT_FALSE(are_voxels);
  }

  /// Moments of all of a cell that holds all of an image.
  Solid::Moments<3>
  moments_of(const LabelFile &labels, bool &are_of_boxes)
  {
    SystemFixture<3> s(
      "subsection Units\n set Length = um\nend\nsubsection Materials\n subsection gel\n set Shear modulus = 1\n"
      " set Bulk modulus = 2\n end\nend\nsubsection Bodies\n subsection block\n set Shape = image\n set File = " +
      labels.path.string() +
      "\n set Materials = 0: empty, 1: gel\n end\nend\nsubsection MPM\n set Cells = 1, 1, 1\n"
      " set Integration = two moments\nend\n");
    const auto moments = Mpm::cell_moments(*s.points, s.grid->active_cells().front(), s.grid->box().cell_size, 1,
                                           false);
    are_of_boxes       = moments.whole_voxels;
    return moments.of_material[0];
  }

  TEST(TwoMomentPoints, CutCellsHaveMomentsInAllDirections)
  {
    using Place             = std::array<unsigned int, 3>;
    bool       are_of_boxes = false;
    const auto covariance   = [&](const auto &is_there) {
      const LabelFile labels(8, 8, 8, [&](const unsigned int x, const unsigned int y, const unsigned int z) {
        return is_there(Place{{x, y, z}}) ? 1 : 0;
      });
      return moments_of(labels, are_of_boxes).covariance() / 1e-12; // [um^2]
    };
    const auto few = covariance([](const Place &x) { return x[0] + x[1] + x[2] == 0; });
    EXPECT_TRUE(are_of_boxes);
    EXPECT_NEAR(determinant(few), std::pow(1. / 12., 3), 1e-12);
    const auto row = covariance([](const Place &x) { return x[1] + x[2] == 0; });
    EXPECT_TRUE(are_of_boxes);
    EXPECT_NEAR(row[0][0], 64. / 12., 1e-9);
    EXPECT_NEAR(row[1][1], 1. / 12., 1e-9);
    const auto layer = covariance([](const Place &x) { return x[2] == 7; });
    EXPECT_TRUE(are_of_boxes);
    EXPECT_NEAR(layer[2][2], 1. / 12., 1e-9);
    const auto two_layers = covariance([](const Place &x) { return x[2] > 5; });
    EXPECT_FALSE(are_of_boxes);
    EXPECT_NEAR(two_layers[2][2], 1. / 4., 1e-9);
  }

  /// Whether the room for a grid with cells @p cells may be so little that its cells share their stiffness.
  bool
  may_share(const std::string &cells)
  {
    const LabelFile  labels = random_labels(24, 18, 5);
    const auto       text   = one_image(labels, cells, " set Integration = two moments\n");
    const auto       begin  = text.find("subsection Units"); // of what a system reads
    SystemFixture<2> s(text.substr(begin, text.find("subsection Newton") - begin));
    bool             shares = false;
    std::string      refused;
    for (double limit = 1e12; limit > 1. && refused.empty(); limit *= .99)
      {
        Memory::set_limit(limit);
        refused = message_of([&] {
          const bool now = Mpm::check_size(s.scene, s.settings, s.settings.grid_box(s.scene), false, 0.);
          EXPECT_GE(now, shares); // the less room, the more so
          shares = now;
        });
      }
    Memory::set_limit(0.);
    EXPECT_FALSE(refused.empty());
    return shares;
  }

  TEST(Voxels, AsFineAsCellsShareStiffnessWhereMemoryLacks)
  {
    EXPECT_TRUE(may_share("240, 180"));
    EXPECT_FALSE(may_share("12, 9")); // 2 x 2 voxels a cell
  }

  /// Whether all points can be where @p u takes them, by a look at each and as the method finds it.
  template <int dim>
  std::pair<StepStatus, StepStatus>
  statuses(SystemFixture<dim> &s, const Vector &u)
  {
    return {s.system->for_each_cell(u, [](const auto &, const auto &) { return StepStatus::ok; }),
            s.system->check_all_points(u)};
  }

  TEST(TwoMomentPoints, NoInvertedPointIsMissedBehindThem)
  {
    SystemFixture<2> s(two_material_box(
      2, "subsection MPM\n set Cells = 2, 2\n set Points per cell = 9, 9\n set Integration = two moments\nend\n"));
    std::mt19937     random(3);
    unsigned int     n_inverted = 0, n_hidden = 0;
    for (unsigned int trial = 0; trial < 400; ++trial)
      {
        Vector u = s.system->new_vector(), r = u;
        for (auto &value : u)
          value = (.2 + .002 * trial) * (random() / 4294967295. - .5);
        const auto [all, found] = statuses(s, u);
        EXPECT_EQ(all, found);
        n_inverted += all != StepStatus::ok;
        n_hidden += all != StepStatus::ok && s.system->residual(r, u) == StepStatus::ok;
      }
    EXPECT_GT(n_inverted, 50u);
    EXPECT_GT(n_hidden, 5u); // the solve does not see these
    EXPECT_LT(n_inverted, 350u);
  }
} // namespace
