#include <stroma/grid/background_grid.h>

#include <deal.II/base/mpi.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>

#include <algorithm>

namespace Stroma
{
  namespace
  {
    /// A coarse mesh of so many cells is not worth cells beyond the box.
    constexpr double small_mesh = 4096.;

    /// A coarse cell weighs about as much as so many of the empty cells that a rank gets to make it one of fewer: every rank
    /// has all coarse cells, but only its share of the others.
    constexpr double coarse_weight = 16.;

    template <int dim>
    double
    n_coarse(const CoarseMesh<dim> &mesh)
    {
      double n = 1.;
      for (const unsigned int k : mesh.n_cells)
        n *= k;
      return n;
    }
  } // namespace

  template <int dim>
  CoarseMesh<dim>
  coarse_mesh(const std::array<unsigned int, dim> &n_cells)
  {
    CoarseMesh<dim> best{n_cells, 0};
    while (std::all_of(best.n_cells.begin(), best.n_cells.end(), [](const unsigned int n) { return n % 2 == 0; }))
      {
        ++best.refinements;
        for (unsigned int &n : best.n_cells)
          n /= 2;
      }
    if (n_coarse(best) <= small_mesh)
      return best;
    const auto cost = [](const CoarseMesh<dim> &mesh) {
      return n_coarse(mesh) * (coarse_weight + std::pow(2., dim * mesh.refinements));
    };
    for (CoarseMesh<dim> mesh = best; n_coarse(mesh) > 1.;)
      {
        ++mesh.refinements;
        for (unsigned int &n : mesh.n_cells)
          n = (n + 1) / 2;
        if (cost(mesh) < cost(best))
          best = mesh;
      }
    return best;
  }

  template <int dim>
  BackgroundGrid<dim>::BackgroundGrid(const GridBox<dim> &box, const ShapeFunctionsEntry<dim> &shape,
                                      const MPI_Comm comm)
    : grid_box(box)
    , triangulation(comm, dealii::Triangulation<dim>::MeshSmoothing::none,
                    dealii::parallel::distributed::Triangulation<dim>::Settings::communicate_vertices_to_p4est)
    , shape(shape.make(box))
    , nodes(*this->shape, comm)
  {
    const auto   mesh  = coarse_mesh<dim>(box.n_cells);
    GridBox<dim> whole = box;
    for (unsigned int d = 0; d < dim; ++d)
      whole.n_cells[d] = mesh.n_cells[d] << mesh.refinements;
    const std::vector<unsigned int> coarse(mesh.n_cells.begin(), mesh.n_cells.end());
    dealii::GridGenerator::subdivided_hyper_rectangle(triangulation, coarse, whole.lower, whole.upper());
    triangulation.refine_global(mesh.refinements);
  }

  template <int dim>
  void
  BackgroundGrid<dim>::distribute_unknowns(const std::vector<bool> &holds_material)
  {
    active = holds_material;
    dealii::GridTools::exchange_cell_data_to_ghosts<int, dealii::Triangulation<dim>>(
      triangulation, [&](const CellIterator &cell) { return int(active[cell->active_cell_index()]); },
      [&](const CellIterator &cell, const int is_active) { active[cell->active_cell_index()] = is_active; });

    const auto         n_here = std::count(active.begin(), active.end(), true); // with ghosts
    std::vector<Index> indices;
    indices.reserve(n_here);
    cells.clear();
    cells.reserve(n_here);
    for_owned_cells([&](const CellIterator &cell, const Index &index) {
      if (!is_active(cell))
        return;
      cells.push_back({cell, index, static_cast<unsigned int>(cells.size()), nullptr});
      indices.push_back(index);
    });
    nodes.distribute(indices);
    for (auto &active_cell : cells)
      active_cell.node = nodes.of_cell(active_cell.number);
    n_active = dealii::Utilities::MPI::sum(static_cast<unsigned long long>(cells.size()),
                                           triangulation.get_communicator());
  }

  template class BackgroundGrid<2>;
  template class BackgroundGrid<3>;
  template CoarseMesh<2> coarse_mesh<2>(const std::array<unsigned int, 2> &);
  template CoarseMesh<3> coarse_mesh<3>(const std::array<unsigned int, 3> &);
} // namespace Stroma
