#include <stroma/mpm/balance.h>
#include <stroma/mpm/points.h>

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
  /// The largest number of material points of a rank over the mean: the lower half of the grid is full, the upper one empty but
  /// for a speck.
  double
  crowding(const bool balanced)
  {
    const auto file = ParameterFile::parse(
      "subsection Materials\n subsection gel\n  set Law = neo-Hookean\n"
      "  set Shear modulus = 1\n  set Bulk modulus = 2\n end\nend\n"
      "subsection Bodies\n subsection block\n  set Shape = box\n"
      "  set Upper corner = 2, 1, 1\n end\n subsection speck\n  set Shape = box\n"
      "  set Lower corner = 1.8, 1.8, 0\n  set Upper corner = 2, 2, 0.2\n end\nend\n"
      "subsection MPM\n set Cells = 16, 16, 8\nend\n",
      "test.prm");
    Parameters       parameters(file);
    const Scene<3>   scene(parameters, MPI_COMM_WORLD);
    Mpm::Settings<3> settings;
    {
      const auto section = parameters.section("MPM");
      settings.add(parameters, scene);
    }
    BackgroundGrid<3> grid(settings.grid_box(scene), settings.shape_functions(), MPI_COMM_WORLD);
    if (balanced)
      Mpm::balance_by_material(grid, scene);
    const Mpm::Points<3> points(scene, settings, grid, false);
    const double         mine = points.handler.n_locally_owned_particles();
    return dealii::Utilities::MPI::max(mine, MPI_COMM_WORLD) * dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) /
           points.handler.n_global_particles();
  }
} // namespace

TEST(Balance, MpiPointsAreSharedOutWithinATenth)
{
  EXPECT_LT(crowding(true), 1.1);
  if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
    {
      EXPECT_GT(crowding(false), 1.5); // what the weights are for
    }
}
