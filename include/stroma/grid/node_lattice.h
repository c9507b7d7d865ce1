#pragma once

#include <stroma/grid/shape_functions.h>

#include <deal.II/base/index_set.h>
#include <deal.II/base/mpi.h>

namespace Stroma
{
  /**
   * The nodes of the background grid that carry unknowns, dim each. A node's name is its number on the lattice of all nodes (x
   * fastest), the same on any number of ranks; which rank it belongs to and which unknowns it has is found by arithmetic on
   * names, so that cells that share nodes need not be neighbours. A node belongs to the lowest rank that has a cell with
   * it; a rank numbers its own in the order in which its cells meet them.
   */
  template <int dim>
  class NodeLattice
  {
  public:
    using Index = typename ShapeFunctions<dim>::Index;

    NodeLattice(const ShapeFunctions<dim> &shape, MPI_Comm comm);

    /// Gives unknowns to the nodes of @p cells, those of this rank that carry unknowns. Collective.
    /// @param copies where a node of the lattice is several ones: which it is, for each node of each cell; empty: none is
    void distribute(const std::vector<Index> &cells, const std::vector<std::uint32_t> &copies = {});

    dealii::IndexSet owned, relevant; ///< unknowns of this rank's nodes, and of all nodes of its cells

    unsigned long long
    n_unknowns() const
    {
      return owned.size();
    }

    /// For each node of cell @p k of those distributed, where in the relevant set its first unknown stands.
    const int *
    of_cell(const std::size_t k) const
    {
      return cell_nodes.data() + k * shape.n_nodes();
    }

    /// A node of this rank's cells.
    struct Node
    {
      std::uint64_t                   name;
      Index                           index;
      dealii::types::global_dof_index unknown; ///< its first
      dealii::Point<dim>              X;       ///< its place [m]
    };

    /// Node @p i, in the order of unknowns.
    Node node(std::size_t i) const;
    std::size_t
    n_nodes() const
    {
      return names.size();
    }

    /// The node whose first unknown stands at @p place of the relevant set.
    Node
    at(const int place) const
    {
      return node(place / dim);
    }

  private:
    using Names = std::vector<std::uint64_t>;

    std::uint64_t name_of(const Index &node) const;
    Index         index_of(std::uint64_t name) const;
    std::uint64_t n_lattice() const;
    Names         find_owners(const Names &known) const;
    Names         find_unknowns(const Names &known, const Names &owner);

    const ShapeFunctions<dim>                   &shape;
    MPI_Comm                                     comm;
    std::array<std::uint64_t, dim>               size; ///< of the lattice
    std::vector<int>                             cell_nodes;
    Names                                        names; ///< of this rank's nodes, in the order of unknowns
    std::vector<dealii::types::global_dof_index> first_unknown;
  };
} // namespace Stroma
