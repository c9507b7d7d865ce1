#include <stroma/mpm/balance.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>

namespace Stroma::Mpm
{
  namespace
  {
    /// Places along each axis of a cell at which it is looked whether there is material.
    constexpr unsigned int n_places = 3;
    /// What such a place weighs, where an empty cell weighs 1.
    constexpr unsigned int weight_of_place = 8;
  } // namespace

  template <int dim>
  void
  balance_by_material(BackgroundGrid<dim> &grid, const Scene<dim> &scene)
  {
    if (dealii::Utilities::MPI::n_mpi_processes(scene.comm) == 1)
      return;
    const dealii::QIterated<dim> places(dealii::QMidpoint<1>(), n_places);
    const auto                   size   = grid.box().cell_size;
    const auto                   weight = [&](const auto &cell, const auto) {
      unsigned int sum = 1;
      for (const auto &xi : places.get_points())
        {
          dealii::Point<dim> X = cell->vertex(0);
          for (unsigned int d = 0; d < dim; ++d)
            X[d] += xi[d] * size[d];
          sum += scene.material_at(X) ? weight_of_place : 0;
        }
      return sum;
    };
    auto                                    &triangulation = grid.triangulation;
    const boost::signals2::scoped_connection connected     = triangulation.signals.weight.connect(weight);
    triangulation.repartition();
  }

  template void balance_by_material(BackgroundGrid<2> &, const Scene<2> &);
  template void balance_by_material(BackgroundGrid<3> &, const Scene<3> &);
} // namespace Stroma::Mpm
