// Meshes that fit the bodies: lattices with holes and inclusions, refinement, drawn shapes, periodicity, bad input.

#include "solid_fixture.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_nothing.h>
#include <deal.II/fe/fe_values.h>

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace
{
  using namespace Stroma;

  std::string
  fem(const std::string &cells, const std::string &more = "")
  {
    return "subsection FEM\n set Cells = " + cells + "\n" + more + "end\n";
  }

  std::string
  refinement(const std::string &where, const unsigned int levels)
  {
    return " subsection Refinement\n  subsection spot\n   set Where = " + where +
           "\n   set Levels = " + std::to_string(levels) + "\n  end\n end\n";
  }

  const std::string square = one("Bodies", "block", "  set Shape = box\n");
  const std::string two_materials =
    "subsection Materials\n subsection soft\n  set Shear modulus = 1\n  set Bulk modulus = 2\n end\n"
    " subsection stiff\n  set Shear modulus = 3\n  set Bulk modulus = 7\n end\nend\n";

  /// A unit square of the soft material with a box of the stiff one, or a rigid box, inside.
  std::string
  with_inner_box(const std::string &lower, const std::string &upper, const std::string &made_of)
  {
    return two_materials +
           "subsection Bodies\n subsection block\n  set Shape = box\n  set Material = soft\n end\n"
           " subsection inner\n  set Shape = box\n  set Lower corner = " +
           lower + "\n  set Upper corner = " + upper + "\n  set " + made_of + "\n end\nend\n";
  }

  template <int dim>
  unsigned int
  n_cells(const Fem::Mesh<dim> &mesh)
  {
    return mesh.triangulation.n_global_active_cells();
  }

  /// Volume of all cells, or of those of one material, with the mesh's mapping.
  template <int dim>
  double
  volume(const Fem::Mesh<dim> &mesh, const int material = -1)
  {
    const dealii::FE_Nothing<dim> nothing;
    dealii::FEValues<dim>         values(mesh.mapping(), nothing, dealii::QGauss<dim>(5), dealii::update_JxW_values);
    double                        sum = 0.;
    for (const auto &cell : mesh.triangulation.active_cell_iterators())
      if (cell->is_locally_owned() && (material < 0 || cell->material_id() == unsigned(material)))
        {
          values.reinit(cell);
          for (const double part : values.get_JxW_values())
            sum += part;
        }
    return dealii::Utilities::MPI::sum(sum, MPI_COMM_WORLD);
  }

  /// Names of all cells, with their level.
  template <int dim>
  std::set<std::string>
  cells(const Fem::Mesh<dim> &mesh)
  {
    std::vector<std::string> own;
    for (const auto &cell : mesh.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        own.push_back(cell->id().to_string());
    std::set<std::string> all;
    for (const auto &part : dealii::Utilities::MPI::all_gather(MPI_COMM_WORLD, own))
      all.insert(part.begin(), part.end());
    return all;
  }

  template <int dim>
  std::string
  complaint(const std::string &text)
  {
    try
      {
        PartsFixture<dim> s(text);
      }
    catch (const UserError &error)
      {
        return error.what();
      }
    return "";
  }

  TEST(MpiMesh, ALatticeHoldsItsCellsAndItsVolume)
  {
    for (const std::string count : {"4, 4", "7, 3", "6, 10", "1, 1"})
      {
        PartsFixture<2> s(gel() + square + fem(count));
        EXPECT_EQ(n_cells(s.mesh), s.settings.cells[0] * s.settings.cells[1]) << count;
        EXPECT_NEAR(volume(s.mesh), 1., 1e-13) << count;
        EXPECT_NEAR(s.mesh.smallest_cell(), 1. / std::max(s.settings.cells[0], s.settings.cells[1]), 1e-15) << count;
      }
    PartsFixture<3> s(gel() + square + fem("4, 2, 3"));
    EXPECT_EQ(n_cells(s.mesh), 24u);
    EXPECT_NEAR(volume(s.mesh), 1., 1e-13);
  }

  TEST(MpiMesh, ARigidBodyCutsAHole)
  {
    // By even numbers the hole is cut out of coarse cells that are split later, by odd ones out of the cells themselves.
    for (const auto &[count, n] : std::map<std::string, unsigned int>{{"8, 8", 48}, {"16, 16", 192}, {"12, 12", 108}})
      {
        PartsFixture<2> s(with_inner_box("0.25, 0.5", "0.75, 1", "Rigid = true") + fem(count));
        EXPECT_EQ(n_cells(s.mesh), n) << count;
        EXPECT_NEAR(volume(s.mesh), .75, 1e-13) << count;
        unsigned int inner = 0;
        for (const auto &cell : s.mesh.triangulation.active_cell_iterators())
          if (cell->is_locally_owned())
            for (const auto &face : cell->face_iterators())
              inner += face->at_boundary() && face->boundary_id() == 4;
        EXPECT_EQ(dealii::Utilities::MPI::sum(inner, MPI_COMM_WORLD), 3 * s.settings.cells[0] / 2) << count;
      }
  }

  TEST(MpiMesh, CellsKnowTheirMaterial)
  {
    for (const std::string count : {"4, 4", "20, 12"})
      {
        PartsFixture<2> s(with_inner_box("0.25, 0.5", "0.5, 1", "Material = stiff") +
                          fem(count, refinement("ball 0.3, 0.6 : 0.1", 2)));
        EXPECT_NEAR(volume(s.mesh, 1), .125, 1e-13) << count;
        EXPECT_NEAR(volume(s.mesh, 0), .875, 1e-13) << count;
        for (const auto &cell : s.mesh.triangulation.active_cell_iterators())
          EXPECT_TRUE(cell->is_artificial() || // ghosts too
                      cell->material_id() == *s.scene.material_at(cell->center()));
      }
  }

  TEST(MpiMesh, RegionsAreRefined)
  {
    // A side: its row of cells, halved twice. A place: the cell around it. One level of difference between neighbours.
    PartsFixture<2> side(gel() + square + fem("4, 4", refinement("side y-max", 2)));
    EXPECT_EQ(n_cells(side.mesh), 12u + 8u + 32u);
    PartsFixture<2> place(gel() + square + fem("4, 4", refinement("nearest 0.1, 0.1", 1)));
    EXPECT_EQ(n_cells(place.mesh), 15u + 4u);
    PartsFixture<2> all(gel() + square + fem("3, 5", refinement("all", 2)));
    EXPECT_EQ(n_cells(all.mesh), 15u * 16u);
    PartsFixture<2> stiff(with_inner_box("0, 0", "0.5, 0.5", "Material = stiff") +
                          fem("4, 4", refinement("material stiff", 1)));
    EXPECT_EQ(n_cells(stiff.mesh), 12u + 16u);
    PartsFixture<2> none(gel() + square + fem("4, 4", refinement("all", 0)));
    EXPECT_EQ(n_cells(none.mesh), 16u);
    PartsFixture<3> block(gel() + square + fem("2, 2, 2", refinement("box 0, 0, 0 : 0.4, 0.4, 0.4", 1)));
    EXPECT_EQ(n_cells(block.mesh), 7u + 8u);
    PartsFixture<3> face(gel() + square + fem("2, 2, 2", refinement("side z-min", 1)));
    EXPECT_EQ(n_cells(face.mesh), 4u + 4u * 8u);
  }

  TEST(MpiMesh, RepeatingTheHistoryGivesTheSameMesh)
  {
    const std::string text = gel() + square + fem("6, 4", refinement("side y-max", 1));
    PartsFixture<2>   first(text), second(text);
    for (unsigned int cycle = 0; cycle < 3; ++cycle)
      {
        for (const auto &cell : first.mesh.triangulation.active_cell_iterators())
          if (cell->is_locally_owned() && cell->center().distance(dealii::Point<2>(.3, .3 + .1 * cycle)) < .25)
            cell->set_refine_flag();
        first.mesh.refine();
      }
    EXPECT_GT(n_cells(first.mesh), 100u);
    second.mesh.repeat(first.mesh.history());
    EXPECT_EQ(cells(first.mesh), cells(second.mesh));
    EXPECT_EQ(first.mesh.history(), second.mesh.history());
  }

  TEST(MpiMesh, DrawnShapesConvergeToTheirVolumes)
  {
    const auto ring = [](const std::string &k, const std::string &angles) {
      return gel() +
             one("Bodies", "tube",
                 "  set Shape = ring\n  set Centre = 1, 2\n  set Inner radius = 1\n"
                 "  set Outer radius = 2\n  set Angles = " +
                   angles + "\n") +
             fem("2, 4", " set Degree = " + k + "\n");
    };
    const double    quarter = M_PI / 4. * 3.;
    PartsFixture<2> ring_2(ring("2", "0, 90")), ring_3(ring("3", "0, 90")), wide(ring("3", "-45, 225"));
    EXPECT_NEAR(volume(ring_2.mesh), quarter, 1e-4 * quarter);
    EXPECT_NEAR(volume(ring_3.mesh), quarter, 1e-6 * quarter);
    EXPECT_NEAR(volume(wide.mesh), 3. * quarter, 1e-3 * quarter);
    // On the axes exactly, so that symmetric sides are found.
    unsigned int on_axis = 0;
    for (const auto &cell : ring_2.mesh.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int v : cell->vertex_indices())
          on_axis += cell->vertex(v)[0] == 1. || cell->vertex(v)[1] == 2.;
    EXPECT_EQ(dealii::Utilities::MPI::sum(on_axis, MPI_COMM_WORLD), 8u);

    PartsFixture<2> quadrilateral(gel() +
                                  one("Bodies", "membrane",
                                      "  set Shape = quadrilateral\n"
                                      "  set Corners = 0, 0, 48, 44, 48, 60, 0, 44\n") +
                                  fem("3, 5"));
    EXPECT_NEAR(volume(quadrilateral.mesh), 48. * (44. + 16.) / 2., 1e-10); // Cook's membrane
    EXPECT_EQ(n_cells(quadrilateral.mesh), 15u);

    const auto ball = [](const std::string &k, const std::string &cells) {
      return gel() + one("Bodies", "cell", "  set Shape = ball\n  set Centre = 1, 2, 3\n  set Radius = 2\n") +
             fem(cells, " set Degree = " + k + "\n");
    };
    double error[2];
    for (const unsigned int i : {0, 1})
      error[i] = std::abs(
        volume(PartsFixture<3>(ball("2", i == 0 ? "4, 4, 4" : "8, 8, 8")).mesh) / (4. / 3. * M_PI * 8.) - 1.);
    EXPECT_LT(error[0], 1e-2);
    EXPECT_GT(std::log2(error[0] / error[1]), 3.5);
    PartsFixture<2> disc(gel() + one("Bodies", "cell", "  set Shape = ball\n  set Centre = 1, 2\n  set Radius = 2\n") +
                         fem("16, 16"));
    EXPECT_NEAR(volume(disc.mesh), 4. * M_PI, 1e-4);
  }

  TEST(MpiMesh, PeriodicSidesMoveTogether)
  {
    const std::string periodic = "subsection Periodic\n set Directions = x\nend\n";
    for (const std::string count : {"4, 4", "3, 5", "1, 2"})
      {
        PartsFixture<2> s(gel() + square + periodic + fem(count, refinement("nearest 0.1, 0.6", 1)));
        s.number();
        Vector u(s.unknowns->owned, MPI_COMM_WORLD);
        for (const auto &[dof, component, X] : s.unknowns->owned_nodes())
          u(dof) = std::cos(2. * M_PI * X[0]) + 3. * X[0] + X[1] + component;
        u.compress(dealii::VectorOperation::insert);
        s.unknowns->distribute(u);
        // Equal heights on both sides have equal values.
        std::vector<std::array<double, 3>> own;
        for (const auto &[dof, component, X] : s.unknowns->owned_nodes())
          if (X[0] == 0. || X[0] == 1.)
            own.push_back({{std::round(1e9 * X[1]) + component * 1e12, X[0], u(dof)}});
        std::map<double, std::map<double, double>> sides;
        for (const auto &part : dealii::Utilities::MPI::all_gather(MPI_COMM_WORLD, own))
          for (const auto &[height, x, value] : part)
            sides[height][x] = value;
        unsigned int pairs = 0;
        for (const auto &[height, values] : sides)
          if (values.size() == 2)
            {
              EXPECT_NEAR(values.at(0.), values.at(1.), 1e-13) << count << " at " << height;
              ++pairs;
            }
        EXPECT_GE(pairs, 2 * (2 * s.settings.cells[1] + 1)) << count;
      }
  }

  TEST(MpiMesh, AQuadraturePointSeesTheBodyItLiesIn)
  {
    // A ball in a box: the mesh is the box's, and points inside the circle are of the ball.
    PartsFixture<2> s(
      two_materials +
      "subsection Bodies\n subsection block\n  set Shape = box\n  set Material = soft\n end\n"
      " subsection drop\n  set Shape = ball\n  set Centre = 0.5, 0.5\n  set Radius = 0.3\n  set Material = stiff\n"
      " end\nend\n" +
      fem("16, 16", " set Material at = quadrature point\n"));
    EXPECT_EQ(n_cells(s.mesh), 256u);
    const dealii::FE_Nothing<2> nothing;
    dealii::FEValues<2>         values(s.mesh.mapping(), nothing, dealii::QGauss<2>(3),
                                       dealii::update_JxW_values | dealii::update_quadrature_points);
    double                      area = 0.;
    for (const auto &cell : s.mesh.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          values.reinit(cell);
          for (unsigned int q = 0; q < values.n_quadrature_points; ++q)
            area += s.mesh.material(cell, values.quadrature_point(q)) == 1 ? values.JxW(q) : 0.;
        }
    EXPECT_NEAR(dealii::Utilities::MPI::sum(area, MPI_COMM_WORLD), M_PI * .09, .02 * M_PI * .09);
  }

  TEST(Mesh, BadInputIsRefusedInOneLine)
  {
    EXPECT_EQ(
      complaint<2>(with_inner_box("0.25, 0.5", "0.6, 1", "Material = stiff") + fem("4, 4")),
      "test.prm:24: the cell at 0.625, 0.625 m holds soft and stiff; choose cells whose edges meet the bodies' edges, "
      "or 'Material at = quadrature point'");
    EXPECT_EQ(
      complaint<2>(with_inner_box("0.25, 0.5", "0.7, 1", "Rigid = true") + fem("4, 4")),
      "test.prm:24: the cell at 0.625, 0.625 m holds nothing and soft; choose cells whose edges meet the bodies' "
      "edges, or 'Material at = quadrature point'");
    EXPECT_EQ(
      complaint<2>(with_inner_box("0.25, 0.5", "0.6, 1", "Rigid = true") + fem("4, 4")),
      "test.prm:24: the cell at 0.625, 0.625 m holds soft and nothing; choose cells whose edges meet the bodies' "
      "edges, or 'Material at = quadrature point'");
    EXPECT_EQ(complaint<2>(with_inner_box("0.25, 0.5", "0.6, 1", "Material = stiff") +
                           fem("4, 4", " set Material at = quadrature point\n")),
              "");
    EXPECT_EQ(
      complaint<2>(gel() +
                   "subsection Bodies\n subsection block\n  set Shape = box\n end\n"
                   " subsection drop\n  set Shape = ball\n  set Centre = 3, 3\n  set Radius = 1\n end\nend\n" +
                   fem("4, 4")),
      "test.prm:11: a mesh cannot fit body 'drop' beside other bodies; use boxes or images, this body alone, or "
      "'Material at = quadrature point' in section FEM");
    EXPECT_EQ(
      complaint<2>(with_inner_box("0.3, 0", "0.35, 1", "Material = stiff") + fem("4, 4")),
      "test.prm:24: the cell at 0.375, 0.125 m holds soft and stiff; choose cells whose edges meet the bodies' edges, "
      "or 'Material at = quadrature point'"); // neither its centre nor its vertices are in the strip
    EXPECT_EQ(complaint<2>(with_inner_box("0.3, 0.3", "0.301, 0.301", "Material = stiff") +
                           fem("4, 4", " set Material at = quadrature point\n")),
              "test.prm:16: body 'inner' lies between the quadrature points of the mesh; use more 'FEM/Cells'");
    const std::string halves = "subsection Bodies\n subsection lower\n  set Shape = box\n end\n"
                               " subsection upper\n  set Shape = box\n  set Lower corner = 0, 1\n  set Upper corner = ";
    EXPECT_EQ(
      complaint<2>(gel() + halves + "0.5, 2\n end\nend\n" + fem("1, 1", refinement("all", 1))),
      "test.prm:18: the cell at 0.5, 1 m holds gel and nothing; choose cells whose edges meet the bodies' edges, "
      "or 'Material at = quadrature point'");
    EXPECT_EQ(complaint<2>(gel() + square + fem("4, 4", refinement("ball 7, 7 : 1", 1))),
              "test.prm:15: refinement of 'ball 7, 7 : 1' selects no cell; enlarge it or move it into the bodies");
    EXPECT_EQ(complaint<2>(gel() +
                           one("Bodies", "cell", "  set Shape = ball\n  set Centre = 0, 0\n  set Radius = 1\n") +
                           "subsection Periodic\n set Directions = y\nend\n" + fem("4, 4")),
              "test.prm:15: only scenes of boxes and images can be periodic");
  }
} // namespace
