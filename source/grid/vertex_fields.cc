#include <stroma/grid/vertex_fields.h>

#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_nothing.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>

namespace Stroma
{
  template <int dim>
  VertexFields<dim>::VertexFields(const BackgroundGrid<dim> &grid)
    : grid(grid)
    , elements(dealii::FESystem<dim>(dealii::FE_Q<dim>(1), dim), dealii::FESystem<dim>(dealii::FE_Nothing<dim>(), dim))
    , dofs(grid.triangulation)
  {
    for (const auto &cell : dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        cell->set_active_fe_index(grid.is_active(cell) ? 0 : 1);
    dofs.distribute_dofs(elements);
  }

  template <int dim>
  Vector
  VertexFields<dim>::values(const Vector &nodal) const
  {
    const MPI_Comm comm = grid.triangulation.get_communicator();
    Vector         own(dofs.locally_owned_dofs(), comm), with_ghosts(grid.nodes.owned, grid.nodes.relevant, comm);
    with_ghosts = nodal;
    std::vector<dealii::types::global_dof_index> unknowns(dim << dim);
    for (const auto &active : grid.active_cells())
      {
        typename dealii::DoFHandler<dim>::active_cell_iterator(&grid.triangulation, active.cell->level(),
                                                               active.cell->index(), &dofs)
          ->get_dof_indices(unknowns);
        for (unsigned int vertex = 0; vertex < (1u << dim); ++vertex)
          {
            const auto shapes = grid.shape->at(active.index, dealii::GeometryInfo<dim>::unit_cell_vertex(vertex));
            for (unsigned int c = 0; c < dim; ++c)
              {
                double value = 0;
                for (unsigned int a = 0; a < grid.shape->n_nodes(); ++a)
                  value += shapes.value[a] * with_ghosts.begin()[active.node[a] + c];
                if (const auto unknown = unknowns[vertex * dim + c]; own.in_local_range(unknown))
                  own(unknown) = value;
              }
          }
      }
    own.compress(dealii::VectorOperation::insert);
    dealii::IndexSet relevant;
    dealii::DoFTools::extract_locally_relevant_dofs(dofs, relevant);
    Vector result(dofs.locally_owned_dofs(), relevant, comm);
    result = own;
    return result;
  }

  template class VertexFields<2>;
  template class VertexFields<3>;
} // namespace Stroma
