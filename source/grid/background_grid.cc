#include <stroma/grid/background_grid.h>

#include <deal.II/base/mpi.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_nothing.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/grid/grid_generator.h>

#include <algorithm>

namespace Stroma
{
  namespace
  {
    /// How often all cell numbers can be halved: a small coarse grid refined is much quicker than a large coarse one.
    template <int dim>
    unsigned int
    common_refinements(const std::array<unsigned int, dim> &n_cells)
    {
      unsigned int refinements = 0;
      while (
        std::all_of(n_cells.begin(), n_cells.end(), [&](const unsigned int n) { return n % (2u << refinements) == 0; }))
        ++refinements;
      return refinements;
    }
  } // namespace

  template <int dim>
  BackgroundGrid<dim>::BackgroundGrid(const GridBox<dim> &box, const MPI_Comm comm)
    : triangulation(comm, dealii::Triangulation<dim>::MeshSmoothing::none,
                    dealii::parallel::distributed::Triangulation<dim>::Settings::communicate_vertices_to_p4est)
    , dofs(triangulation)
    , grid_box(box)
  {
    const unsigned int        refinements = common_refinements<dim>(box.n_cells);
    std::vector<unsigned int> coarse(dim);
    for (unsigned int d = 0; d < dim; ++d)
      coarse[d] = box.n_cells[d] >> refinements;
    dealii::GridGenerator::subdivided_hyper_rectangle(triangulation, coarse, box.lower, box.upper());
    triangulation.refine_global(refinements);
    elements.push_back(dealii::FESystem<dim>(dealii::FE_Q<dim>(1), dim));
    elements.push_back(dealii::FESystem<dim>(dealii::FE_Nothing<dim>(), dim));
  }

  template <int dim>
  void
  BackgroundGrid<dim>::distribute_unknowns(const std::vector<bool> &holds_material)
  {
    const MPI_Comm     comm  = triangulation.get_communicator();
    unsigned long long count = 0;
    for (const auto &cell : triangulation.active_cell_iterators())
      if (cell->is_locally_owned() && holds_material[cell->active_cell_index()])
        ++count;
    active_cells    = dealii::Utilities::MPI::sum(count, comm);
    has_empty_cells = active_cells < triangulation.n_global_active_cells();

    dofs.clear();
    dofs.reinit(triangulation);
    if (has_empty_cells)
      {
        for (const auto &cell : dofs.active_cell_iterators())
          if (cell->is_locally_owned())
            cell->set_active_fe_index(holds_material[cell->active_cell_index()] ? 0 : 1);
        dofs.distribute_dofs(elements);
      }
    else
      dofs.distribute_dofs(elements[0]);
    owned = dofs.locally_owned_dofs();
    dealii::DoFTools::extract_locally_relevant_dofs(dofs, relevant);
  }

  template class BackgroundGrid<2>;
  template class BackgroundGrid<3>;
} // namespace Stroma
