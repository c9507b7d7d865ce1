// The tangent kept as matrices of cells against the assembled one, and its multigrid.

#include "label_file.h"
#include "solve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace
{
  using namespace Stroma;

  /// Both ends of the box clamped or not, the upper one moved; @p cells of the grid, @p more in section MPM.
  std::string
  stretched_box(const int dim, const std::string &cells, const std::string &more = "")
  {
    const std::string zero = dim == 2 ? "0; 0" : "0; 0; 0", motion = dim == 2 ? "free; 0.1*t" : "free; 0.1*t; free";
    return two_material_box(dim, "subsection Supports\n subsection bottom\n  set Where = side y-min\n  set "
                                 "Displacement = " +
                                   zero + "\n end\n subsection top\n  set Where = side y-max\n  set Displacement = " +
                                   motion + "\n end\nend\nsubsection MPM\n set Cells = " + cells +
                                   "\n set Interface = composite cells\n" + more + "end\n");
  }

  template <int dim>
  void
  keep_tangent(SystemFixture<dim> &s)
  {
    s.system->keep_tangent();
    ASSERT_NE(s.system->kept_tangent(), nullptr);
  }

  /// A displacement that does not depend on the ranks.
  template <int dim>
  Vector
  wavy(const SystemFixture<dim> &s)
  {
    Vector u = s.system->new_vector();
    for (std::size_t i = 0; i < s.grid->nodes.n_nodes(); ++i)
      if (const auto node = s.grid->nodes.node(i); s.grid->nodes.owned.is_element(node.unknown))
        for (unsigned int c = 0; c < dim; ++c)
          u(node.unknown + c) = .02 * std::sin(5. * node.X[c] + 3. * node.X[(c + 1) % dim] + c);
    u.compress(dealii::VectorOperation::insert);
    return u;
  }

  template <int dim>
  void
  compare_with_assembled(const std::string &text)
  {
    SystemFixture<dim> assembled(text), kept(text);
    keep_tangent(kept);
    const Vector u           = wavy(kept);
    Vector       r_assembled = u, r_kept = u;
    Matrix       K, none;
    ASSERT_EQ(assembled.system->residual(r_assembled, u), StepStatus::ok);
    ASSERT_EQ(assembled.system->tangent(K, r_assembled, u), StepStatus::ok);
    ASSERT_EQ(kept.system->residual(r_kept, u), StepStatus::ok);
    ASSERT_EQ(kept.system->tangent(none, r_kept, u), StepStatus::ok);
    EXPECT_EQ(none.m(), 0u);
    Vector difference(r_kept);
    difference -= r_assembled;
    EXPECT_LT(difference.l2_norm(), 1e-7 * r_assembled.l2_norm()); // with the lifted jumps

    Vector x(u), y = u, y_kept = u;
    x *= 7.;
    x.add(.1);
    K.vmult(y, x);
    auto &A = *kept.system->kept_tangent();
    A.vmult(y_kept, x);
    y_kept -= y;
    EXPECT_LT(y_kept.linfty_norm(), 2e-7 * y.linfty_norm());
    Vector diagonal = u;
    A.diagonal(diagonal);
    for (const auto i : diagonal.locally_owned_elements())
      EXPECT_NEAR(diagonal(i), K.diag_element(i), 1e-6 * K.diag_element(i));
  }

  TEST(MpiCellTangent, IsTheAssembledOne)
  {
    compare_with_assembled<2>(stretched_box(2, "7, 5"));
    compare_with_assembled<2>(stretched_box(2, "7, 5", " set Lower corner = -0.5, 0\n set Upper corner = 2, 1\n"));
    compare_with_assembled<3>(stretched_box(3, "4, 3, 5"));
  }

  /// Of the kept tangent's solution from the assembled one's, over its size.
  double
  difference_of_solutions(const std::string &text)
  {
    SystemFixture<2> assembled(text), kept(text);
    keep_tangent(kept);
    Vector u, u_kept;
    solve_exactly(assembled, u);
    solve_exactly(kept, u_kept);
    u_kept -= u;
    return u_kept.l2_norm() / u.l2_norm();
  }

  TEST(MpiCellTangent, LeadsToTheSameSolution)
  {
    EXPECT_LT(difference_of_solutions(stretched_box(2, "31, 27")), 1e-11);
  }

  /// Iterations to 1e-8 of the first linear solve, or of one for forces @p at_random.
  template <int dim>
  unsigned int
  iterations(const std::string &text, const bool at_random = false)
  {
    SystemFixture<dim> s(text);
    keep_tangent(s);
    Solvers::LinearSolver solver({Solvers::Preconditioner::geometric, 1e-8, 500});
    Vector                u = s.system->new_vector(), r = u, du = u;
    Matrix                none;
    EXPECT_EQ(s.system->residual(r, u), StepStatus::ok);
    EXPECT_EQ(s.system->tangent(none, r, u), StepStatus::ok);
    if (at_random)
      std::generate(r.begin(), r.end(), [random = std::mt19937(1)]() mutable {
        return std::uniform_real_distribution<double>(-1., 1.)(random);
      });
    const auto result = solver.solve_lifted(*s.system->kept_tangent(), du, r, 1e-8);
    EXPECT_TRUE(result.converged);
    return result.iterations;
  }

  TEST(CellTangent, IterationsDoNotGrowWithTheGrid)
  {
    const unsigned int coarse = iterations<2>(stretched_box(2, "24, 24")),
                       fine   = iterations<2>(stretched_box(2, "96, 96")),
                       odd    = iterations<2>(stretched_box(2, "95, 97")),
                       flat   = iterations<2>(stretched_box(2, "96, 24"));
    std::cout << "iterations in the plane " << coarse << " " << fine << " " << odd << " " << flat;
    EXPECT_LE(fine, coarse + 3);
    EXPECT_LE(odd, coarse + 4);
    EXPECT_LE(flat, coarse + 4);
    EXPECT_LE(fine, 14u);
    const unsigned int small = iterations<3>(stretched_box(3, "8, 8, 8")),
                       large = iterations<3>(stretched_box(3, "16, 15, 17")),
                       thin  = iterations<3>(stretched_box(3, "12, 16, 3"));
    std::cout << ", in space " << small << " " << large << " " << thin << std::endl;
    EXPECT_LE(large, small + 4);
    EXPECT_LE(thin, small + 8);
    EXPECT_LE(large, 14u);
  }

  /// A box that slides between two plates, held against that by @p edge and @p corner.
  std::string
  sliding_box(const std::string &corner, const std::string &edge)
  {
    return two_material_box(3,
                            "subsection Supports\n"
                            " subsection bottom\n  set Where = side y-min\n  set Displacement = free; 0; free\n end\n"
                            " subsection top\n  set Where = side y-max\n  set Displacement = free; 0.1*t; free\n end\n"
                            " subsection corner\n" +
                              corner + " end\n subsection edge\n" + edge +
                              " end\nend\nsubsection MPM\n set Cells = 16, 16, 16\nend\n");
  }

  /// Coarse grids hold more than a single node, which must not cost iterations.
  TEST(CellTangent, SingleNodesCostFewIterations)
  {
    const unsigned int nodes = iterations<3>(
                         sliding_box("  set Where = nearest 0, 0, 0\n  set Displacement = 0; free; 0\n",
                                     "  set Where = nearest 1, 0, 0\n  set Displacement = free; free; 0\n")),
                       sides = iterations<3>(
                         sliding_box("  set Where = side x-min\n  set Displacement = 0; free; free\n",
                                     "  set Where = side z-min\n  set Displacement = free; free; 0\n"));
    std::cout << "iterations with single nodes held " << nodes << ", with sides " << sides << std::endl;
    EXPECT_LE(nodes, sides + 4);
  }

  /// Nine posts with gaps of a cell between them, on a bar: no coarse function may move two posts together.
  std::string
  comb(const unsigned int n)
  {
    std::string bodies;
    for (unsigned int post = 0; post < 9; ++post)
      bodies += " subsection post " + std::to_string(post) +
                "\n  set Material = gel\n  set Shape = box\n  set Lower corner = " + std::to_string(7 * post) + "/" +
                std::to_string(n) + ", 8/" + std::to_string(n) +
                "\n  set Upper corner = " + std::to_string(7 * post + 6) + "/" + std::to_string(n) + ", 1\n end\n";
    return "subsection Materials\n subsection gel\n  set Shear modulus = 1\n  set Bulk modulus = 3\n end\nend\n"
           "subsection Bodies\n subsection bar\n  set Material = gel\n  set Shape = box\n  set Upper corner = 1, 8/" +
           std::to_string(n) + "\n end\n" + bodies +
           "end\nsubsection Supports\n subsection bottom\n  set Where = side y-min\n  set Type = clamp\n end\n"
           " subsection side\n  set Where = side x-min\n  set Displacement = .1*t*y; free\n end\nend\n"
           "subsection MPM\n set Cells = " +
           std::to_string(n) + ", " + std::to_string(n) + "\nend\n";
  }

  TEST(MpiCellTangent, CoarseFunctionsDoNotJoinTheBanksOfThinGaps)
  {
    const unsigned int n = iterations<2>(comb(64));
    std::cout << "iterations of a comb " << n << std::endl;
    EXPECT_LE(n, 14u);
  }

  /// A soft square with a net of thin stiff bars, which coarse grids of linear functions stretch where they should bend.
  std::string
  net(const unsigned int contrast)
  {
    std::string bars;
    for (unsigned int i = 0; i < 9; ++i)
      for (const bool lies : {false, true})
        {
          const std::string from = std::to_string(7 * i + 3) + "/64", to = std::to_string(7 * i + 4) + "/64";
          bars += " subsection bar " + std::to_string(2 * i + lies) +
                  "\n  set Material = stiff\n  set Shape = box\n  set Lower corner = " +
                  (lies ? "0, " + from : from + ", 0") + "\n  set Upper corner = " + (lies ? "1, " + to : to + ", 1") +
                  "\n end\n";
        }
    return "subsection Materials\n subsection soft\n  set Shear modulus = 1\n  set Bulk modulus = 2\n end\n"
           " subsection stiff\n  set Shear modulus = " +
           std::to_string(contrast) + "\n  set Bulk modulus = " + std::to_string(2 * contrast) +
           "\n end\nend\nsubsection Bodies\n subsection matrix\n  set Material = soft\n  set Shape = box\n"
           "  set Upper corner = 1, 1\n end\n" +
           bars +
           "end\nsubsection Supports\n subsection bottom\n  set Where = side y-min\n  set Type = clamp\n end\n"
           " subsection top\n  set Where = side y-max\n  set Displacement = .1*t; free\n end\nend\n"
           "subsection MPM\n set Cells = 64, 64\nend\n";
  }

  TEST(MpiCellTangent, CoarseFunctionsFollowThinStiffBars)
  {
    const unsigned int n = iterations<2>(net(1000));
    std::cout << "iterations of a net " << iterations<2>(net(2)) << ", " << n << std::endl;
    EXPECT_LE(n, 36u);
  }

  /// A slice of vessels that are 100 times as stiff.
  TEST(MpiCellTangent, StiffVesselsCostNoMoreOnFineGrids)
  {
    const auto slice = [](const std::string &cells) {
      return "subsection Units\n set Length = um\nend\nsubsection Materials\n subsection collagen\n  set Shear modulus = 1\n"
             "  set Bulk modulus = 2\n end\n subsection vessel\n  set Shear modulus = 100\n  set Bulk modulus = 200\n end\n"
             "end\nsubsection Bodies\n subsection slice\n  set Shape = image\n  set File = phantom\n"
             "  set Materials = 0: collagen, 255: vessel\n  subsection Phantom\n   set Size = 512, 512, 1\n"
             "   set Voxel size = 1.05, 1.05, 1\n   set Vessel fraction = 0.1936\n   set Radius = 8\n  end\n end\nend\n"
             "subsection Supports\n subsection bottom\n  set Where = side y-min\n  set Displacement = free; 0\n end\n"
             " subsection top\n  set Where = side y-max\n  set Displacement = free; .1*y*t\n end\n"
             " subsection middle\n  set Where = nearest 268.8, 0\n  set Displacement = 0; free\n end\nend\n"
             "subsection MPM\n set Integration = two moments\n set Cells = " +
             cells + "\nend\n";
    };
    const unsigned int coarse = iterations<2>(slice("128, 128")), fine = iterations<2>(slice("256, 256"));
    std::cout << "iterations of stiff vessels " << coarse << ", " << fine << std::endl;
    EXPECT_LE(fine, coarse + 2);
  }

  /// A ball between two plates, which cuts cells anywhere: nodes of which a cell holds a corner alone cost no iterations.
  TEST(MpiCellTangent, SmallCutsCostFewIterations)
  {
    const auto text = [](const std::string &shape) {
      return "subsection Materials\n subsection gel\n  set Shear modulus = 1\n  set Bulk modulus = 2\n end\nend\n"
             "subsection Bodies\n subsection below\n  set Material = gel\n  set Shape = box\n  set Upper corner = 1, .25, 1\n end\n"
             " subsection above\n  set Material = gel\n  set Shape = box\n  set Lower corner = 0, .75, 0\n"
             "  set Upper corner = 1, 1, 1\n end\n subsection between\n  set Material = gel\n" +
             shape +
             " end\nend\nsubsection Supports\n subsection bottom\n  set Where = side y-min\n  set Type = clamp\n end\n"
             " subsection top\n  set Where = side y-max\n  set Displacement = .1*t; free; free\n end\nend\n"
             "subsection MPM\n set Cells = 16, 16, 16\n set Points per cell = 5, 5, 5\nend\n";
    };
    const unsigned int
      ball = iterations<3>(text("  set Shape = ball\n  set Centre = .51, .52, .53\n  set Radius = .43\n"), true),
      box  = iterations<3>(
        text("  set Shape = box\n  set Lower corner = .125, .25, .125\n  set Upper corner = .875, .75, .875\n"), true);
    std::cout << "iterations of a ball " << ball << ", of a box " << box << std::endl;
    EXPECT_LE(ball, box + 6);
  }

  /// A body with spherical holes, whose rims leave one voxel or two in many cells: these resist all shapes of their cell.
  TEST(MpiCellTangent, CutCellsOfFewVoxelsAreStiff)
  {
    std::mt19937                                     random(3);
    std::vector<std::pair<dealii::Point<3>, double>> holes;
    while (holes.size() < 12)
      {
        dealii::Point<3> x;
        for (unsigned int d = 0; d < 3; ++d)
          x[d] = 48. * (random() / 4294967296.);
        const double radius = 4. + 6. * (random() / 4294967296.);
        if (std::all_of(holes.begin(), holes.end(),
                        [&](const auto &h) { return x.distance(h.first) > radius + h.second + 5.; }))
          holes.emplace_back(x, radius);
      }
    const auto is_hole = [&](const unsigned int x, const unsigned int y, const unsigned int z) {
      return std::any_of(holes.begin(), holes.end(), [&](const auto &h) {
        return dealii::Point<3>(x + .5, y + .5, z + .5).distance(h.first) < h.second;
      });
    };
    const LabelFile porous(48, 48, 48, is_hole);
    const auto      n = iterations<3>(
      "subsection Units\n set Length = um\nend\nsubsection Materials\n subsection gel\n  set Shear modulus = 1\n"
           "  set Bulk modulus = 2\n end\nend\nsubsection Bodies\n subsection block\n  set Shape = image\n  set File = " +
        porous.path.string() +
        "\n  set Materials = 0: gel, 1: empty\n end\nend\n"
             "subsection Supports\n subsection bottom\n  set Where = side y-min\n  set Type = clamp\n end\n"
             " subsection top\n  set Where = side y-max\n  set Displacement = .1*t; free; free\n end\nend\n"
             "subsection MPM\n set Cells = 24, 24, 24\n set Integration = two moments\nend\n",
      true);
    std::cout << "iterations of a porous block " << n << std::endl;
    EXPECT_LE(n, 16u);
  }

  /// Part of the grid is empty, a corner of the rest is held by one node: coarse grids keep both.
  TEST(MpiCellTangent, ServesEmptyCellsAndSingleNodes)
  {
    const std::string text = two_material_box(
      2, "subsection Supports\n subsection corner\n  set Where = nearest 0.35, 0.65\n"
         "  set Displacement = 0; 0\n end\n subsection top\n  set Where = side y-max\n"
         "  set Displacement = free; 0.05*t\n end\nend\n"
         "subsection MPM\n set Cells = 36, 29\n set Lower corner = -0.5, -0.3\n"
         " set Upper corner = 1.5, 1\nend\n");
    EXPECT_LT(difference_of_solutions(text), 1e-10);
    EXPECT_LE(iterations<2>(text), 40u);
  }

  /// A slender strip that is pressed beyond its buckling has a tangent with negative directions, on coarse grids too.
  TEST(MpiCellTangent, ServesABodyThatBuckles)
  {
    SystemFixture<2> s(
      "subsection Materials\n subsection gel\n  set Shear modulus = 1\n  set Bulk modulus = 3\n end\nend\n"
      "subsection Bodies\n subsection strip\n  set Shape = box\n  set Upper corner = 1, 20\n end\nend\n"
      "subsection Supports\n subsection bottom\n  set Where = side y-min\n  set Type = clamp\n end\n"
      " subsection top\n  set Where = side y-max\n  set Displacement = 0; -2*t\n end\nend\n"
      "subsection MPM\n set Cells = 4, 80\nend\n");
    keep_tangent(s);
    Vector u = s.system->new_vector();
    for (std::size_t i = 0; i < s.grid->nodes.n_nodes(); ++i)
      if (const auto node = s.grid->nodes.node(i); s.grid->nodes.owned.is_element(node.unknown))
        u(node.unknown + 1) = -.1 * node.X[1];
    u.compress(dealii::VectorOperation::insert);
    Solvers::LinearSolver solver({Solvers::Preconditioner::geometric, 1e-8, 500});
    Vector                r = u, du = u;
    Matrix                none;
    ASSERT_EQ(s.system->residual(r, u), StepStatus::ok);
    ASSERT_EQ(s.system->tangent(none, r, u), StepStatus::ok);
    EXPECT_TRUE(solver.solve_lifted(*s.system->kept_tangent(), du, r, 1e-8).converged);
    Vector bent = s.system->new_vector(), K_bent = bent;
    for (std::size_t i = 0; i < s.grid->nodes.n_nodes(); ++i)
      if (const auto node = s.grid->nodes.node(i); s.grid->nodes.owned.is_element(node.unknown))
        {
          const double wave      = .1 * dealii::numbers::PI;
          bent(node.unknown)     = 1. - std::cos(wave * node.X[1]);
          bent(node.unknown + 1) = -wave * std::sin(wave * node.X[1]) / .9 * (node.X[0] - .5); // so that sections turn
        }
    bent.compress(dealii::VectorOperation::insert);
    s.system->kept_tangent()->vmult(K_bent, bent);
    EXPECT_LT(bent * K_bent, 0.); // so it is beyond
  }

  /// As where memory lacks for matrices of their own.
  void
  keep_shared_tangent(SystemFixture<2> &s)
  {
    s.settings.shares_stiffness = true;
    s.system->rebuild();
    s.system->set_committed(1., 0.);
    keep_tangent(s);
  }

  std::string
  with_few_points()
  {
    return stretched_box(2, "17, 14", " set Points per cell = 3, 3\n set Integration = two moments\n");
  }

  /// Before anything moved cells that share their stiffness have their own.
  TEST(MpiCellTangent, IsSharedByCellsThatAreAlike)
  {
    SystemFixture<2> own(with_few_points()), sharing(with_few_points());
    keep_tangent(own);
    keep_shared_tangent(sharing);
    Vector u = own.system->new_vector(), r = u, r_sharing = u, x = wavy(own), y = u, y_sharing = u;
    Matrix none;
    ASSERT_EQ(own.system->residual(r, u), StepStatus::ok);
    ASSERT_EQ(own.system->tangent(none, r, u), StepStatus::ok);
    ASSERT_EQ(sharing.system->residual(r_sharing, u), StepStatus::ok);
    ASSERT_EQ(sharing.system->tangent(none, r_sharing, u), StepStatus::ok);
    r_sharing -= r;
    EXPECT_LT(r_sharing.l2_norm(), 1e-6 * r.l2_norm());
    own.system->kept_tangent()->vmult(y, x);
    sharing.system->kept_tangent()->vmult(y_sharing, x);
    y_sharing -= y;
    EXPECT_LT(y_sharing.l2_norm(), 1e-6 * y.l2_norm());
    EXPECT_GT(y.l2_norm(), 0.);
  }

  TEST(MpiCellTangent, SharedLeadsToTheSameSolution)
  {
    SystemFixture<2> own(with_few_points()), sharing(with_few_points());
    keep_tangent(own);
    keep_shared_tangent(sharing);
    Vector     u, u_sharing;
    const auto with_own = solve_exactly(own, u).size(), with_shared = solve_exactly(sharing, u_sharing).size();
    u_sharing -= u;
    EXPECT_LT(u_sharing.l2_norm(), 1e-11 * u.l2_norm());
    EXPECT_GT(with_shared, with_own); // not quadratically
    EXPECT_LT(with_shared, 25u);
  }

  TEST(CellTangent, IsNotKeptWhereMoreThanCellsActs)
  {
    const auto acts_in_cells_only = [](const std::string &more) {
      return SystemFixture<2>(two_material_box(2, more)).system->acts_in_cells_only();
    };
    const std::string driven = "subsection Supports\n subsection top\n  set Where = layer y-max 0.2\n"
                               "  set Displacement = free; 0.1*t\n end\nend\n";
    EXPECT_TRUE(acts_in_cells_only("subsection MPM\n set Cells = 3, 3\nend\n"));
    EXPECT_FALSE(
      acts_in_cells_only("subsection MPM\n set Cells = 3, 3\n set Shape functions = quadratic B-spline\nend\n"));
    EXPECT_FALSE(acts_in_cells_only(driven + "subsection MPM\n set Cells = 3, 3\nend\n"));
  }
} // namespace
