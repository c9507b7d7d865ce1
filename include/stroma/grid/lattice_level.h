#pragma once

#include <stroma/grid/bent_weights.h>
#include <stroma/grid/node_lattice.h>

#include <deal.II/base/subscriptor.h>
#include <deal.II/lac/la_parallel_vector.h>

namespace Stroma
{
  /**
   * The unassembled stiffness of a grid: matrices of its cells (of this rank) that carry unknowns, on the nodes of these, with
   * unknowns that are held. A grid of a multigrid hierarchy, which knows the next coarser one.
   */
  template <int dim>
  class LatticeLevel : public dealii::Subscriptor
  {
  public:
    using Index = typename ShapeFunctions<dim>::Index;
    template <typename Number>
    using Values = dealii::LinearAlgebra::distributed::Vector<Number>;

    static constexpr unsigned int no_kind = static_cast<unsigned int>(-1);

    /// @param nodes of linear shape functions, given unknowns by @p cells
    /// @param kinds of each cell, where cells of a kind (counted from 0) share a matrix, or no_kind; empty: none do. Collective.
    LatticeLevel(const NodeLattice<dim> &nodes, std::vector<Index> cells, MPI_Comm comm,
                 const std::vector<unsigned int> &kinds = {});

    /// The matrix of cell @p k of no kind, as they were given.
    void set(std::size_t k, const dealii::FullMatrix<double> &K_cell);
    /// That of all cells of a kind.
    void set_kind(unsigned int kind, const dealii::FullMatrix<double> &K_cell);

    /// Holds the unknowns @p dofs, of those that are relevant on this rank. Those @p is_single belong to single nodes: coarser grids,
    /// which would hold far more than a node, have springs there, as stiff as such a node is to all others.
    void hold(const std::vector<dealii::types::global_dof_index> &dofs, const std::vector<bool> &is_single);

    /// y = K x, where x is zero on held unknowns; y is too. Collective.
    template <typename Number>
    void vmult(Values<Number> &y, const Values<Number> &x) const;
    /// The same without regard to what is held.
    template <typename Number>
    void multiply_all(Values<Number> &y, const Values<Number> &x) const;

    /// Diagonal of the sum of all cells, of held unknowns too. Collective.
    template <typename Number>
    void find_diagonal(Values<Number> &d) const;

    /// Sets @p x to zero where unknowns are held.
    template <typename Number>
    void set_held_to_zero(Values<Number> &x) const;

    /// Cells of the next coarser grid.
    struct Parents
    {
      std::vector<Index>         cells;
      std::vector<std::uint32_t> copies; ///< of each node of each; empty: all nodes are whole
      std::vector<unsigned int>  kinds;  ///< those of all whose children are of one kind; empty: none are
    };

    /// Places the cells in those of a grid with @p next cells along each axis; returns the latter as far as this rank has any.
    /// @param splits whether coarse nodes are split, see NodeCopies; cells of a parent that differ in these have parents of
    /// their own. Collective.
    Parents place_in_parents(const std::array<unsigned int, dim> &n_cells, const std::array<unsigned int, dim> &next,
                             bool splits);

    /// To be called when the coarser grid has ordered its cells by kinds.
    void
    follow(const LatticeLevel &coarse)
    {
      for (auto &place : places)
        place.parent = coarse.slot.empty() ? place.parent : coarse.slot[place.parent];
    }

    /// Cells of all ranks. Collective.
    std::uint64_t
    n_cells() const
    {
      return dealii::Utilities::MPI::sum(std::uint64_t(cells.size()), partition->get_mpi_communicator());
    }

    /// Holds on the next coarser grid what moves held unknowns here. Collective.
    void hold_coarser(LatticeLevel &coarse) const;

    /// Finds the functions of the next coarser grid for the present matrices, its matrices and its springs. Collective.
    void coarsen(LatticeLevel &coarse);

    /// Frees what coarsen() has found of functions.
    void
    release_weights()
    {
      weights.clear();
    }

    /// Residuals @p r of this grid on the next coarser one. Collective.
    void restrict_to(const LatticeLevel &coarse, Values<float> &r_coarse, const Values<float> &r) const;

    /// Adds functions of the next coarser grid. Collective.
    void add_prolonged(const LatticeLevel &coarse, Values<float> &x, const Values<float> &x_coarse) const;

    template <typename Number>
    Values<Number>
    new_vector() const
    {
      return Values<Number>(partition);
    }

    dealii::types::global_dof_index
    m() const
    {
      return partition->size();
    }

    /// deal.II's smoothers look at the diagonal with it where they are given none.
    float
    el(dealii::types::global_dof_index, dealii::types::global_dof_index) const
    {
      AssertThrow(false, dealii::ExcNotImplemented());
      return 0.f;
    }

    CellMatrices<dim>                                          matrices;
    std::shared_ptr<const dealii::Utilities::MPI::Partitioner> partition;
    std::vector<unsigned int>                                  held; ///< places in vectors, ghosts too
    std::vector<std::pair<unsigned int, float>> springs;             ///< at owned unknowns: place in vectors, stiffness

  private:
    std::vector<unsigned int> order_by_kind(const std::vector<unsigned int> &kinds);
    static Index              parent_of(const Index &cell, const std::array<unsigned int, dim> &n_cells,
                                        const std::array<unsigned int, dim> &next, PlaceInParent<dim> &place);
    void                      coarsen_springs(LatticeLevel &coarse) const;
    void                      find_weights();
    std::vector<bool>         find_uneven() const;
    std::vector<unsigned int> find_kinds() const;
    std::vector<unsigned int> kinds_of_parents(const Parents &parents, const std::array<unsigned int, dim> &next) const;
    void                      coarsen_kinds(LatticeLevel &coarse, const std::vector<unsigned int> &kinds) const;
    template <typename Visit>
    void for_parents(const LatticeLevel &coarse, const Visit &visit) const;

    std::vector<unsigned int>              single;    ///< owned held unknowns of single nodes, places in vectors
    std::vector<Index>                     cells;     ///< in the order of their matrices
    std::vector<unsigned int>              slot;      ///< which of these each given cell is; empty: the same
    std::vector<unsigned int>              shared;    ///< kinds of the first cells, eight by eight
    std::vector<std::vector<unsigned int>> left_over; ///< by kind, which of the cells have a copy of its matrix
    std::vector<PlaceInParent<dim>>        places;
    std::array<unsigned int, dim>          n_box; ///< cells of the grid along each axis
    BentWeights<dim>                       weights;
    std::vector<std::uint32_t>             first_cell; ///< of each owned node: cell * n_nodes + which of its nodes
  };
} // namespace Stroma
