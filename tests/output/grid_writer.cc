#include "../world.h"
#include "temporary_folder.h"

#include <stroma/base/output_error.h>
#include <stroma/output/grid_writer.h>

#include <deal.II/base/function.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_nothing.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/hp/fe_collection.h>
#include <deal.II/numerics/vector_tools.h>

#include <gtest/gtest.h>

using namespace dealii;
using namespace Stroma;
using namespace Stroma::Output;

namespace
{
  /// Vector with ghosts whose values are 1, 2, ... by index: enough to see that it arrives.
  template <int dim>
  Stroma::Vector
  numbered(const DoFHandler<dim> &dofs)
  {
    IndexSet relevant;
    DoFTools::extract_locally_relevant_dofs(dofs, relevant);
    Stroma::Vector owned(dofs.locally_owned_dofs(), world), ghosted(dofs.locally_owned_dofs(), relevant, world);
    for (const auto i : dofs.locally_owned_dofs())
      owned[i] = 1. + i;
    owned.compress(VectorOperation::insert);
    ghosted = owned;
    return ghosted;
  }

  /// Sum over the pieces of an attribute such as NumberOfCells.
  unsigned int
  total(const TemporaryFolder &folder, const std::string &base, const std::string &attribute)
  {
    unsigned int sum = 0;
    for (unsigned int rank = 0; rank < Utilities::MPI::n_mpi_processes(world); ++rank)
      {
        const std::string text = read_text(folder / (base + "." + std::to_string(rank) + ".vtu"));
        sum += std::stoul(text.substr(text.find(attribute + "=\"") + attribute.size() + 2));
      }
    return sum;
  }
} // namespace

TEST(GridWriter, MpiWritesCellsWithUnknownsOnly)
{
  const TemporaryFolder                   folder;
  parallel::distributed::Triangulation<2> triangulation(world);
  GridGenerator::subdivided_hyper_rectangle(triangulation, {8, 4}, Point<2>(), Point<2>(2., 1.));
  const hp::FECollection<2> elements(FESystem<2>(FE_Q<2>(1), 2), FESystem<2>(FE_Nothing<2>(), 2));
  DoFHandler<2>             dofs(triangulation);
  for (const auto &cell : dofs.active_cell_iterators())
    if (cell->is_locally_owned())
      cell->set_active_fe_index(cell->center()[0] < 1. ? 0 : 1); // with several ranks one of them may have none
  dofs.distribute_dofs(elements);
  const Stroma::Vector   u = numbered(dofs);
  dealii::Vector<double> mises(triangulation.n_active_cells());
  mises = 3.;

  EXPECT_EQ(write_grid<2>({folder.path, 3, {}, {}}, dofs, {{"displacement", "m", &u}}, {{"von_mises", "Pa", &mises}}),
            "grid_0003.pvtu");
  EXPECT_EQ(total(folder, "grid_0003", "NumberOfCells"), 16u);
  EXPECT_EQ(total(folder, "grid_0003", "NumberOfPoints"), 64u);
  const std::string record = read_text(folder / "grid_0003.pvtu");
  EXPECT_NE(record.find("Name=\"displacement_m\" NumberOfComponents=\"3\""), std::string::npos) << record;
  EXPECT_NE(record.find("Name=\"von_mises_Pa\""), std::string::npos);
  for (unsigned int rank = 0; rank < Utilities::MPI::n_mpi_processes(world); ++rank)
    EXPECT_NE(record.find("Source=\"grid_0003." + std::to_string(rank) + ".vtu\""), std::string::npos);
}

TEST(GridWriter, MpiQuadraticElementsAreSubdivided)
{
  const TemporaryFolder                   folder;
  parallel::distributed::Triangulation<3> triangulation(world);
  GridGenerator::subdivided_hyper_cube(triangulation, 2);
  DoFHandler<3> dofs(triangulation);
  dofs.distribute_dofs(FESystem<3>(FE_Q<3>(2), 3));
  const Stroma::Vector u = numbered(dofs);
  write_grid<3>({folder.path, 0, {}, {}}, dofs, {{"displacement", "m", &u}, {"residual", "N", &u}}, {});
  EXPECT_EQ(total(folder, "grid_0000", "NumberOfCells"), 64u);
  EXPECT_EQ(total(folder, "grid_0000", "NumberOfPoints"), 8u * 27u);
}

TEST(GridWriter, MpiUnwritableFolderThrowsOnAllRanks)
{
  const TemporaryFolder                   folder;
  parallel::distributed::Triangulation<2> triangulation(world);
  GridGenerator::subdivided_hyper_cube(triangulation, 2);
  DoFHandler<2> dofs(triangulation);
  dofs.distribute_dofs(FESystem<2>(FE_Q<2>(1), 2));
  const Stroma::Vector u       = numbered(dofs);
  const std::string    message = message_of<OutputError>([&] {
    write_grid<2>({folder / "missing", 0, {}, {}}, dofs, {{"u", "m", &u}}, {});
  });
  EXPECT_NE(message.find("missing/grid_0000.0.vtu: the file cannot be written (No such file"), std::string::npos)
    << message;
}
