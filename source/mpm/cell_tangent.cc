#include <stroma/mpm/cell_tangent.h>

#include <algorithm>

namespace Stroma::Mpm
{
  namespace
  {
    template <int dim>
    std::vector<typename ShapeFunctions<dim>::Index>
    indices_of(const std::vector<ActiveCell<dim>> &cells)
    {
      std::vector<typename ShapeFunctions<dim>::Index> indices;
      for (const auto &active : cells)
        indices.push_back(active.index);
      return indices;
    }

    template <int dim>
    LatticeLevel<dim>
    finest_grid(const BackgroundGrid<dim> &grid, const std::vector<dealii::types::global_dof_index> &held,
                const std::vector<bool> &is_single, const std::vector<unsigned int> &kinds)
    {
      LatticeLevel<dim> level(grid.nodes, indices_of(grid.active_cells()), grid.triangulation.get_communicator(),
                              kinds);
      level.hold(held, is_single);
      return level;
    }
  } // namespace

  template <int dim>
  CellTangent<dim>::CellTangent(const BackgroundGrid<dim>                          &grid,
                                const std::vector<dealii::types::global_dof_index> &held,
                                const std::vector<bool> &is_single, const std::vector<unsigned int> &kinds)
    : finest(finest_grid(grid, held, is_single, kinds))
    , multigrid(finest, grid.box(), grid.triangulation.get_communicator())
    , from(finest.template new_vector<double>())
    , to(from)
  {}

  template <int dim>
  void
  CellTangent<dim>::finish()
  {
    finest.find_diagonal(to);
    held_diagonal.clear();
    for (const unsigned int place : finest.held)
      held_diagonal.push_back(to.local_element(place));
  }

  template <int dim>
  void
  CellTangent<dim>::lift(const std::vector<double> &jump, Vector &r) const
  {
    const unsigned int n_own = finest.partition->locally_owned_size();
    from                     = 0.;
    for (std::size_t i = 0; i < jump.size(); ++i)
      if (finest.held[i] < n_own)
        from.local_element(finest.held[i]) = jump[i];
    finest.multiply_all(to, from);
    finest.set_held_to_zero(to);
    double *const values = r.begin();
    for (unsigned int i = 0; i < n_own; ++i)
      values[i] -= to.local_element(i);
    for (std::size_t i = 0; i < jump.size(); ++i)
      if (const unsigned int place = finest.held[i]; place < n_own)
        values[place] += held_diagonal[i] * jump[i];
  }

  template <int dim>
  void
  CellTangent<dim>::vmult(Vector &y, const Vector &x) const
  {
    const unsigned int n_own = finest.partition->locally_owned_size();
    std::copy_n(x.begin(), n_own, from.begin());
    finest.set_held_to_zero(from);
    finest.vmult(to, from);
    std::copy_n(to.begin(), n_own, y.begin());
    for (std::size_t i = 0; i < finest.held.size(); ++i)
      if (const unsigned int place = finest.held[i]; place < n_own)
        y.begin()[place] = held_diagonal[i] * x.begin()[place];
  }

  template <int dim>
  void
  CellTangent<dim>::diagonal(Vector &d) const
  {
    finest.find_diagonal(to);
    std::copy_n(to.begin(), finest.partition->locally_owned_size(), d.begin());
  }

  template <int dim>
  void
  CellTangent<dim>::solve_decoupled(Vector &x, Vector &b) const
  {
    const unsigned int n_own = finest.partition->locally_owned_size();
    x                        = 0.;
    for (std::size_t i = 0; i < finest.held.size(); ++i)
      if (const unsigned int place = finest.held[i]; place < n_own)
        {
          x.begin()[place] = b.begin()[place] / held_diagonal[i];
          b.begin()[place] = 0.;
        }
  }

  template <int dim>
  void
  CellTangent<dim>::set_up_multigrid()
  {
    multigrid.set_up();
  }

  /// Scaled to numbers that single precision can hold.
  template <int dim>
  void
  CellTangent<dim>::apply_multigrid(Vector &y, const Vector &x) const
  {
    const double       scale = x.linfty_norm();
    const unsigned int n_own = finest.partition->locally_owned_size();
    if (!(scale > 0.))
      {
        y = x;
        return;
      }
    for (unsigned int i = 0; i < n_own; ++i)
      multigrid.right_side().local_element(i) = static_cast<float>(x.begin()[i] / scale);
    multigrid.apply();
    for (unsigned int i = 0; i < n_own; ++i)
      y.begin()[i] = scale * multigrid.solution().local_element(i);
  }

  template class CellTangent<2>;
  template class CellTangent<3>;
} // namespace Stroma::Mpm
