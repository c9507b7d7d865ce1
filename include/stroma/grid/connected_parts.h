#pragma once

#include <deal.II/base/point.h>
#include <deal.II/distributed/tria.h>

#include <cstdint>
#include <vector>

namespace Stroma
{
  /**
   * The pieces that the cells with material fall into: two cells belong to one piece if a chain of cells leads from one to
   * the other across faces (periodic ones too). Pieces that share no more than a corner or an edge are joined there as by
   * a hinge.
   */
  template <int dim>
  class ConnectedParts
  {
  public:
    using Cell = typename dealii::Triangulation<dim>::active_cell_iterator;

    /// @param holds_material by active_cell_index; owned cells count. Collective
    ConnectedParts(const dealii::parallel::distributed::Triangulation<dim> &triangulation,
                   const std::vector<bool>                                 &holds_material);

    /// Number of pieces on all ranks.
    unsigned int
    size() const
    {
      return n_pieces;
    }

    /// Piece of an owned or ghost cell with material, the same on all ranks; none() if it has no material.
    template <typename AnyCell>
    unsigned int
    piece_of(const AnyCell &cell) const
    {
      return piece[cell->active_cell_index()];
    }
    static constexpr unsigned int
    none()
    {
      return static_cast<unsigned int>(-1);
    }

    /// Whether pieces of this rank touch themselves, or each other, across a period.
    const std::vector<bool> &
    across_period() const
    {
      return periodic;
    }

    /// Two pieces that share a vertex.
    struct Joint
    {
      unsigned int       first, second;
      dealii::Point<dim> X;
    };
    /// Those that this rank sees: all of its own cells.
    std::vector<Joint> joints() const;

    /// Number of groups of pieces, on all ranks: pieces that are joined belong to one group. Collective.
    unsigned int n_groups() const;

  private:
    using Label = std::uint64_t;
    void find_labels(const std::vector<bool> &holds_material);
    void number_pieces();

    const dealii::parallel::distributed::Triangulation<dim> &triangulation;
    std::vector<Label>        label; ///< smallest cell of the piece, by active_cell_index
    std::vector<unsigned int> piece;
    std::vector<bool>         periodic;
    unsigned int              n_pieces = 0;
  };
} // namespace Stroma
