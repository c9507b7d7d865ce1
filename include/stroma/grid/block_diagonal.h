#pragma once

#include <stroma/grid/lattice_level.h>

namespace Stroma
{
  /**
   * The inverse of the diagonal of a grid's stiffness, to smooth with; of weak nodes that of blocks. A node is weak that in each of
   * its cells has less than a tenth of the stiffness of the strongest one: one at the rim of a body, of whose cells only
   * small cuts hold material. There shape functions are all but linearly dependent, so that motions of several weak nodes of a
   * cell cost next to no energy: no polynomial of the diagonal smooths these, and no coarse function follows them. So weak nodes that
   * have their strongest cell in common make a block. (F. de Prenter, C. V. Verhoosel, E. H. van Brummelen, Comput. Methods Appl. Mech. Eng.
   * 350 (2019) 604: Schwarz smoothers of cut cells.)
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

    /// Nodes of this rank that stand in blocks.
    std::size_t
    n_weak() const
    {
      return weak.size();
    }

  private:
    static constexpr unsigned int n_nodes = CellMatrices<dim>::n_nodes, none = static_cast<unsigned int>(-1);

    /// A node of this rank.
    struct Weak
    {
      unsigned int node;             ///< its number on this rank
      unsigned int block     = none; ///< the cell with the most stiffness at the node, then which block it is in
      unsigned int place     = 0;    ///< in the block
      float        stiffness = 0.f;  ///< of that cell there
    };
    struct Block
    {
      std::vector<unsigned int>  unknowns; ///< places in vectors
      dealii::FullMatrix<double> inverse;
    };

    void find_weak(const LatticeLevel<dim> &level, const Values &diagonal);
    void make_blocks(const LatticeLevel<dim> &level);
    void invert(const std::vector<dealii::FullMatrix<double>> &sums, const Values &diagonal);
    std::vector<dealii::FullMatrix<double>> assemble(const LatticeLevel<dim> &level) const;
    template <typename Visit>
    void for_weak_cells(const CellMatrices<dim> &matrices, const Visit &visit) const;

    Values                    inverse; ///< of the diagonal
    std::vector<Weak>         weak;
    std::vector<unsigned int> weak_of; ///< by node of this rank: which weak one it is, or none; empty: there are none
    std::vector<Block>        blocks;
  };
} // namespace Stroma
