#pragma once

#include <stroma/grid/lattice_level.h>

namespace Stroma
{
  /**
   * The inverse of the diagonal of a grid's stiffness, to smooth with; of weak nodes that of blocks. A node is weak that in
   * each of its cells has less than a tenth of the stiffness of the strongest one: one at the rim of a body, of whose cells only
   * small cuts hold material. There shape functions are all but linearly dependent, so that motions of several weak nodes
   * of a cell cost next to no energy: no polynomial of the diagonal smooths these, and no coarse function follows them. So
   * weak nodes that have their strongest cell in common make a block. (F. de Prenter, C. V. Verhoosel, E. H. van Brummelen,
   * Comput. Methods Appl. Mech. Eng. 350 (2019) 604: Schwarz smoothers of cut cells.)
   *
   * A block is assembled of the cells of the rank that owns the nodes; of those of other ranks it has the diagonal.
   */
  template <int dim>
  class BlockDiagonal : public dealii::Subscriptor
  {
  public:
    using Values = dealii::LinearAlgebra::distributed::Vector<float>;

    /// Of the present matrices of @p level; zero where unknowns are held. Collective.
    explicit BlockDiagonal(const LatticeLevel<dim> &level);

    /// y = D^-1 x.
    void vmult(Values &y, const Values &x) const;

    /// That of the diagonal of all nodes, weak ones too.
    const Values &
    without_blocks() const
    {
      return inverse;
    }

    /// Whether this rank has weak nodes.
    bool
    has_blocks() const
    {
      return !blocks.empty();
    }

  private:
    struct Block
    {
      std::vector<unsigned int>  unknowns; ///< places in vectors
      dealii::FullMatrix<double> inverse;
    };

    void invert(Block &block, const dealii::FullMatrix<double> &sum, const Values &diagonal) const;

    Values             inverse; ///< of the diagonal
    std::vector<Block> blocks;
  };
} // namespace Stroma
