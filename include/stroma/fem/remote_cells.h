#pragma once

#include <stroma/fem/mesh.h>
#include <stroma/output/state_view.h>

#include <deal.II/base/mpi_remote_point_evaluation.h>

#include <functional>
#include <map>

namespace Stroma::Fem
{
  /**
   * Any places in a mesh, on whatever rank their cells are. A place that several cells share, whatever their ranks, gets
   * the mean of their values.
   */
  template <int dim>
  class RemoteCells
  {
  public:
    using Cell = typename dealii::Triangulation<dim>::active_cell_iterator;

    /// Places that ranks ask for in one cell of this rank.
    struct Asked
    {
      std::vector<dealii::Point<dim>> unit;  ///< in the unit cell
      std::size_t                     first; ///< place of the first one's values
    };

    /// Finds the cells around the places @p X of this rank. Collective.
    RemoteCells(const Mesh<dim> &mesh, const std::vector<Output::Place> &X);

    /// What is asked of a cell, or nullptr.
    const Asked *in(const Cell &cell) const;

    /// Number of all places asked of this rank.
    std::size_t
    n_asked() const
    {
      return n;
    }

    /// Fills values and found of @p samples, at the places given to the constructor.
    /// @param values of the places asked of this rank, @p width numbers a place
    /// Collective.
    void answer(const std::vector<double> &values, unsigned int width, Output::Samples &samples) const;

  private:
    dealii::Utilities::MPI::RemotePointEvaluation<dim> remote;
    std::map<Cell, Asked>                              asked;
    std::size_t                                        n = 0;
  };
} // namespace Stroma::Fem
