// Stokes flow by Taylor-Hood elements: orders, exact solutions, symmetry of the operator, forces, ranks, bad input.

#include "stokes_fixture.h"

#include <stroma/simulation/saved_state.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

namespace
{
  using namespace Stroma;

  /// A scene of parameters/, without the sections that belong to the run loop or to other methods.
  template <int dim>
  struct Scenario : StokesFixture<dim>
  {
    Scenario(const std::string &path, const std::vector<std::string> &set = {})
      : StokesFixture<dim>(text(path), set)
    {}

    static std::string
    text(const std::string &path)
    {
      std::ifstream in(STROMA_SOURCE_DIR "/parameters/" + path);
      std::string   kept, section;
      for (std::string line; std::getline(in, line);)
        {
          if (line.rfind("subsection ", 0) == 0)
            section = line.substr(11);
          const bool not_read = std::set<std::string>{"Time", "Output", "Study", "NSPH", "SPH", "MPM"}.count(section) ||
                                line.rfind("set Method", 0) == 0 || line.rfind("set Dimension", 0) == 0;
          kept += (not_read ? "" : line) + "\n";
          if (line == "end")
            section.clear();
        }
      return kept;
    }
  };

  /// A box of fluid with what @p more says.
  std::string
  box(const std::string &more, const std::string &fluid = "", const std::string &fem = "")
  {
    return "subsection Materials\n subsection water\n  set Law = fluid\n  set Viscosity = 2\n" + fluid +
           " end\nend\n"
           "subsection Bodies\n subsection tank\n  set Shape = box\n end\nend\n"
           "subsection FEM\n set Cells = 4, 4\n" +
           fem + "end\n" + more;
  }

  const std::string walls = "subsection Supports\n"
                            " subsection bottom\n  set Where = side y-min\n  set Type = clamp\n end\n"
                            " subsection top\n  set Where = side y-max\n  set Type = clamp\n end\nend\n";
  const std::string drive =
    "subsection Loads\n subsection drive\n  set Where = all\n  set Force density = 3; 0\n end\nend\n";
  const std::string along_x = "subsection Periodic\n set Directions = x\nend\n";

  void
  expect_orders(const std::string &degree, const double k)
  {
    const auto errors = [&degree](const std::string &cells) {
      return Scenario<2>("verification/stokes_manufactured.prm", {"Constants/cells=" + cells, "FEM/Degree=" + degree})
        .run();
    };
    auto                                coarse = errors("16"), fine = errors("32");
    const std::map<std::string, double> theory{{"velocity_error_L2_relative", k + 1.},
                                               {"velocity_error_H1_relative", k},
                                               {"pressure_error_L2_relative", k}};
    for (const auto &[name, order] : theory)
      EXPECT_NEAR(std::log2(coarse[name] / fine[name]), order, .1) << name << " " << coarse[name] << " " << fine[name];
  }

  TEST(Stokes, OrdersOfDegree2)
  {
    expect_orders("2", 2.);
  }

  TEST(Stokes, OrdersOfDegree3)
  {
    expect_orders("3", 3.);
  }

  TEST(MpiStokes, PoiseuilleIsExactWithHangingNodes)
  {
    const std::string refinement = " subsection Refinement\n  subsection spot\n   set Where = ball 0.7, 0.3 : 0.2\n"
                                   "   set Levels = 2\n  end\n end\n";
    StokesFixture<2>  s(box(walls + drive + along_x +
                              "subsection Exact solution\n set Velocity = 3/4*y*(1-y); 0\n"
                               "end\nset Thickness = 0.5\n",
                            "", refinement));
    auto              result = s.run();
    EXPECT_LT(result["velocity_error_L2_relative"], 1e-9);
    EXPECT_NEAR(result["max_speed_m_per_s"], 3. / 16., 1e-10);
    EXPECT_NEAR(result["flow_rate_x_m3_per_s"], .5 * 3. / 24., 1e-10);
    // The walls hold all of the force, and what the force does is dissipated.
    EXPECT_NEAR(result["reaction_bottom_x_N"] + result["reaction_top_x_N"], -1.5, 1e-8);
    EXPECT_NEAR(result["dissipation_W"], 3. * result["flow_rate_x_m3_per_s"], 1e-8);
  }

  TEST(Stokes, OneStepOfACompressibleColumnIsThatOfBackwardEuler)
  {
    // p <- (p + K dt/mu_P p_end) / (1 + K dt/mu_P): nsph.md, section 8.
    for (const std::string law : {"central", "morris", "deviatoric"})
      {
        const double ratio = law == "central" ? 3. : law == "morris" ? 1. : 4. / 3.;
        Scenario<2>  s("verification/stokes_nearly_incompressible.prm",
                       {"FEM/Scheme=backward Euler", "Materials/fluid/Viscous operator=" + law});
        s.run(.1, 1);
        const auto   samples = sampled(*s.method, 2, {"pressure"}, {{{.002, .009, 0.}}});
        const double x       = 2. * .1 / (ratio * .05);
        EXPECT_NEAR(samples.values[0], .3 * (.009 - .005) * x / (1. + x), 1e-11) << law;
      }
  }

  TEST(Stokes, TimeSchemesHaveTheirOrders)
  {
    const std::map<std::string, double> theory{{"backward Euler", 1.}, {"SDIRK 2", 2.}, {"SDIRK 3", 3.}};
    for (const auto &[scheme, order] : theory)
      {
        double error[2];
        for (const unsigned int k : {0, 1})
          error[k] = Scenario<2>("verification/stokes_nearly_incompressible.prm",
                                 {"FEM/Scheme=" + scheme, "Linear solver/Tolerance=1e-12"})
                       .run(.1, 16u << k)["pressure_error_L2_relative"];
        EXPECT_NEAR(std::log2(error[0] / error[1]), order, .15) << scheme;
      }
  }

  TEST(Stokes, TheFlowThatStartsFromRestFollowsItsSeries)
  {
    // v(y, t) = sum over odd n of 4 b/(rho nu) L^2/(n pi)^3 (1 - exp(-nu (n pi / L)^2 t)) sin(n pi y / L).
    StokesFixture<2> s(
      box(walls + drive + along_x, "  set Density = 10\n", " set Inertia = true\n set Scheme = SDIRK 3\n"));
    const double end = .4;
    s.run(end, 40);
    const auto samples = sampled(*s.method, 2, {"velocity"}, {{{.3, .5, 0.}}});
    double     exact   = 0.;
    for (int n = 1; n < 40; n += 2)
      {
        const double k = n * M_PI;
        exact += 4. * 3. / 2. / (k * k * k) * (1. - std::exp(-.2 * k * k * end)) * std::sin(k * .5);
      }
    EXPECT_NEAR(samples.values[0], exact, 1e-3 * exact);
    EXPECT_NEAR(samples.values[1], 0., 1e-9 * exact);
  }

  TEST(Stokes, TheOperatorIsSymmetric)
  {
    StokesFixture<2>   s(box(walls + along_x, "  set Bulk modulus = 3\n  set Density = 5\n", " set Inertia = true\n"));
    const Fem::Mesh<2> mesh(s.scene, s.settings);
    const Fem::StokesSpace<2>  space(mesh, s.scene, s.settings, 1.);
    const Fem::StokesSystem<2> system(space, s.settings);
    Fem::StokesMatrices        m;
    system.assemble(m, 7.);
    for (const Matrix *matrix : {&m.A, &m.C, &m.S, &m.L})
      for (const auto &entry : *matrix)
        EXPECT_NEAR(entry.value(), matrix->el(entry.column(), entry.row()), 1e-13 * matrix->linfty_norm());

    // And it is the derivative of the residual: r(x) = r(0) - [A B^T; B -C] x.
    Fem::StokesFlow x{space.new_velocity(), space.new_pressure()}, r, r_0;
    for (unsigned int i = 0; i < x.v.size(); ++i)
      x.v[i] = std::sin(1. + i);
    for (unsigned int i = 0; i < x.p.size(); ++i)
      x.p[i] = std::cos(1. + i);
    x.v.compress(dealii::VectorOperation::insert);
    x.p.compress(dealii::VectorOperation::insert);
    space.fixed_velocity.distribute(x.v);
    space.tied_pressure.distribute(x.p);
    Fem::StokesRates rates;
    rates.rate = 7.;
    system.residual(r_0, {space.new_velocity(), space.new_pressure()}, rates);
    system.residual(r, x, rates);
    Vector change_v(r_0.v), change_p(r_0.p), K_v(r.v), K_p(r.p), C_p(r.p);
    change_v -= r.v;
    change_p -= r.p;
    Fem::StokesFlow free(x);
    space.fixed_velocity.set_zero(free.v);
    space.tied_pressure.set_zero(free.p);
    m.A.vmult(K_v, free.v);
    m.B.Tvmult_add(K_v, free.p);
    m.B.vmult(K_p, free.v);
    m.C.vmult(C_p, free.p);
    K_p -= C_p;
    K_v -= change_v;
    K_p -= change_p;
    space.fixed_velocity.set_zero(K_v);
    space.tied_pressure.set_zero(K_p);
    EXPECT_LT(K_v.linfty_norm(), 1e-12 * change_v.linfty_norm());
    EXPECT_LT(K_p.linfty_norm(), 1e-12 * change_p.linfty_norm());
  }

  TEST(MpiStokes, ThePillarHoldsTheSameForceOnAnyNumberOfRanks)
  {
    Scenario<2> s("heck2017/pillars.prm", {"Constants/cells=20", "Linear solver/Tolerance=1e-12"});
    auto        result = s.run(.5, 2);
    // All of the force on the fluid, b times its volume, ends in the walls and the pillar.
    EXPECT_NEAR(result["reaction_pillar_x_N"] + result["reaction_top_x_N"] + result["reaction_bottom_x_N"],
                -.22 * (1e-4 - 1.6e-5), 1e-13);
    const double reference = -1.1307747848683744e-05; // found on one rank
    EXPECT_NEAR(result["reaction_pillar_x_N"], reference, 1e-10 * std::abs(reference));
  }

  TEST(MpiStokes, ATractionDrivesAFlowThroughASpace)
  {
    // A square duct of length 1 in 3D: in and out flow balance, the walls hold the traction.
    StokesFixture<3> s(
      "subsection Materials\n subsection water\n  set Law = fluid\n  set Viscosity = 2\n end\nend\n"
      "subsection Bodies\n subsection duct\n  set Shape = box\n end\nend\n"
      "subsection Supports\n"
      " subsection y0\n  set Where = side y-min\n  set Type = clamp\n end\n"
      " subsection y1\n  set Where = side y-max\n  set Type = clamp\n end\n"
      " subsection z0\n  set Where = side z-min\n  set Type = clamp\n end\n"
      " subsection z1\n  set Where = side z-max\n  set Type = clamp\n end\nend\n"
      "subsection Loads\n subsection push\n  set Where = side x-min\n  set Total force = 5; 0; 0\n end\nend\n"
      "subsection FEM\n set Cells = 3, 3, 3\nend\n");
    auto   result = s.run();
    double sum    = 0.;
    for (const std::string wall : {"y0", "y1", "z0", "z1"})
      sum += result["reaction_" + wall + "_x_N"];
    EXPECT_NEAR(sum, -5., 1e-8);
    EXPECT_GT(result["flow_rate_x_m3_per_s"], 0.);
    EXPECT_NEAR(result["flow_rate_y_m3_per_s"], 0., 1e-9 * result["flow_rate_x_m3_per_s"]);
    EXPECT_NEAR(result["reaction_y0_x_N"], result["reaction_y1_x_N"], 1e-8);
    EXPECT_NEAR(result["reaction_z0_x_N"], result["reaction_z1_x_N"], 1e-8);
  }

  TEST(MpiStokes, AResumedRunRepeatsTheUninterruptedOne)
  {
    const std::string scene = "verification/stokes_nearly_incompressible.prm";
    const auto        path  = std::filesystem::temp_directory_path() /
                      ("stroma_stokes_" + std::to_string(dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD)));
    StepWork    work;
    Scenario<2> whole(scene);
    whole.run(.05, 4);
    {
      Output::ArchiveWriter archive(path, MPI_COMM_WORLD);
      save_state(*whole.method, archive, MPI_COMM_WORLD);
      archive.commit();
    }
    Scenario<2> resumed(scene);
    {
      const Output::ArchiveReader archive(path, MPI_COMM_WORLD);
      load_state(*resumed.method, archive, MPI_COMM_WORLD);
    }
    ASSERT_EQ(whole.method->advance(.05, .07, work), StepStatus::ok);
    ASSERT_EQ(resumed.method->advance(.05, .07, work), StepStatus::ok);
    EXPECT_EQ(resumed.method->scalars, whole.method->scalars);
    MPI_Barrier(MPI_COMM_WORLD);
    std::filesystem::remove(path);
  }

  TEST(MpiStokes, FieldsAreWrittenAndSampled)
  {
    StokesFixture<2> s(box(walls + drive + along_x + "set Thickness = 0.5\n"));
    s.run();
    const std::string folder = std::filesystem::temp_directory_path().string() + "/stroma_stokes_fields_" +
                               std::to_string(dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD));
    std::filesystem::create_directories(folder);
    std::ifstream     record(folder + "/" + s.method->write_grid({folder, 7u, {}, true, Output::Format::vtu, {}, {}}));
    const std::string text((std::istreambuf_iterator<char>(record)), {});
    for (const std::string field : {"velocity_m_per_s", "pressure_Pa", "von_mises_Pa", "material"})
      EXPECT_NE(text.find(field), std::string::npos) << field;

    // On a vertex, and outside.
    const auto samples = sampled(*s.method, 2, {"velocity_gradient", "von_mises"}, {{{.25, .25, 0.}}, {{.3, 2., 0.}}});
    EXPECT_EQ(samples.found, std::vector<bool>({true, false}));
    EXPECT_NEAR(samples.values[1], .375, 1e-9);                // dv_x/dy = 3/4 (1 - 2 y)
    EXPECT_NEAR(samples.values[4], std::sqrt(3.) * .75, 1e-8); // of the shear stress 2 dv_x/dy
    const auto own    = all_own_samples(*s.method, 2, {"velocity"});
    double     volume = 0.;
    for (const double weight : own.weight)
      volume += weight;
    EXPECT_NEAR(volume, .5, 1e-12);
    EXPECT_EQ(own.values.size(), 2 * own.X.size());
    MPI_Barrier(MPI_COMM_WORLD);
    if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::filesystem::remove_all(folder);
  }

  /// The line that comes out for an unusable scene.
  std::string
  complaint(const std::string &text)
  {
    try
      {
        StokesFixture<2>(text).run();
      }
    catch (const UserError &error)
      {
        return error.what();
      }
    return "";
  }

  std::string
  support(const std::string &entries)
  {
    return "subsection Supports\n subsection wall\n" + entries + " end\nend\n";
  }

  std::string
  load(const std::string &entries)
  {
    return "subsection Loads\n subsection drive\n" + entries + " end\nend\n";
  }

  TEST(Stokes, BadInputIsRefusedInOneLine)
  {
    EXPECT_EQ(complaint(box(drive + along_x)),
              "test.prm:8: nothing determines the fluid's velocity along x; hold a side or a rigid body there, or set "
              "'FEM/Inertia = true'");
    EXPECT_EQ(
      complaint(box(support("  set Where = side y-min\n  set Displacement = 0; 0.1*t\n"))),
      "test.prm:16: support 'wall' displaces a fluid; use 'Type = velocity' with 'Velocity', or 'Type = clamp'");
    EXPECT_EQ(complaint(box(support("  set Where = nearest 0, 0\n  set Type = clamp\n"))),
              "test.prm:16: support 'wall' holds one point, which a fluid does not feel; hold a side, box or ball");
    EXPECT_EQ(
      complaint(box(support("  set Where = ball 7, 7 : 1\n  set Type = clamp\n"))),
      "test.prm:16: support 'wall' (ball 7, 7 : 1) holds no node of the mesh; enlarge it or move it into the bodies");
    EXPECT_EQ(complaint(box(support("  set Where = side x-min\n  set Type = clamp\n") + along_x)),
              "test.prm:16: support 'wall' acts on side x-min, where the scene repeats; take that direction out of "
              "'Periodic/Directions'");
    EXPECT_EQ(
      complaint(box(walls + load("  set Where = nearest 0, 0\n  set Total force = 1; 0\n"))),
      "test.prm:26: load 'drive' acts on one point, where a fluid would move without bound; spread it over a ball");
    EXPECT_EQ(
      complaint(box(walls + load("  set Where = ball 7, 7 : 1\n  set Force density = 1; 0\n"))),
      "test.prm:26: load 'drive' (ball 7, 7 : 1) selects no part of the mesh; enlarge it or move it into the bodies");
    EXPECT_EQ(
      complaint(box(walls, "", " set Inertia = true\n")),
      "test.prm:2: material 'water': 'Density' is missing, but 'FEM/Inertia' is true; give the density or leave inertia out");
    EXPECT_EQ(
      complaint(box("subsection Supports\n subsection bottom\n  set Where = side y-min\n  set Type = clamp\n end\n"
                    " subsection left\n  set Where = side x-min\n  set Type = velocity\n  set Velocity = 1; 0\n"
                    " end\nend\n")),
      "test.prm:20: 'bottom' and 'left' contradict each other: at t = 0 s one moves a shared node with 0 m/s along "
      "x, the other with 1 m/s; make them agree or free one of them");
  }

  TEST(MpiStokes, ABodyThatForcesMoveSharesNoNodes)
  {
    const auto standing = [](const std::string &floor, const std::string &stone, const std::string &more = "") {
      return complaint("subsection Materials\n subsection water\n  set Law = fluid\n  set Viscosity = 2\n end\nend\n"
                       "subsection Bodies\n subsection tank\n  set Shape = box\n  set Upper corner = 8, 8\n end\n"
                       " subsection stone\n  set Shape = box\n  set Rigid = true\n  set Lower corner = 2, 0\n"
                       "  set Upper corner = 3, 4\n end\n" +
                       more + "end\nsubsection FEM\n set Cells = 8, 8\nend\nsubsection Supports\n" +
                       " subsection wall\n  set Where = side x-min\n  set Type = clamp\n end\n"
                       " subsection floor\n  set Where = side y-min\n  set Type = " +
                       floor + "\n end\n" + stone +
                       "end\nsubsection Loads\n subsection push\n  set Where = body stone\n  set Total force = 1; 0\n"
                       " end\nend\n");
    };
    const auto motion = [](const std::string &entries) {
      return " subsection stone\n  set Where = body stone\n  set Type = velocity\n" + entries + " end\n";
    };
    const std::string neighbour = " subsection brick\n  set Shape = box\n  set Rigid = true\n"
                                  "  set Lower corner = 3, 3\n  set Upper corner = 4, 5\n end\n";
    const auto        line      = [](const std::string &other) {
      return "test.prm:12: the balance of forces moves rigid body 'stone', which shares nodes with '" + other +
             "' that it would move; leave a cell of fluid between them, or give the body's motion by a support on "
                         "'body stone'";
    };
    EXPECT_EQ(standing("clamp", ""), line("floor"));
    EXPECT_EQ(standing("clamp", motion("  set Velocity = free; 0\n")), line("floor"));
    EXPECT_EQ(standing("symmetry", motion("  set Velocity = free; 0\n  set Angular velocity = free\n")), line("floor"));
    EXPECT_EQ(standing("symmetry", motion("  set Velocity = free; 0\n"), neighbour), line("brick"));
    // Of half a body on a plane of symmetry, along which it moves, the shared component is given.
    EXPECT_EQ(standing("symmetry", motion("  set Velocity = free; 0\n")), "");
  }
} // namespace
