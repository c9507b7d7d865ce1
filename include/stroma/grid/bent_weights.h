#pragma once

#include <stroma/grid/cell_matrices.h>

#include <deal.II/lac/la_parallel_vector.h>

namespace Stroma
{
  /**
   * How the nodes of a grid follow those of the next coarser one where linear functions would cost much energy: at holes, and
   * between materials of very different stiffness. Of w_p, the weights of linear functions, one step of steepest descent of the energy of
   * the coarse functions is made with blocks of dim x dim,
   *   W_p = w_p I - omega D^-1 (B_p - mean of all B_q),   B_p = sum_b K_ab w_p(b),   D = diagonal of K,
   * with the same coarse nodes p as before, so that coarse grids couple no more nodes than before. Their sum is I: translations
   * stay what they are. (J. Mandel, M. Brezina, P. Vanek, Computing 62 (1999) 205: more steps, and other patterns.)
   */
  template <int dim>
  class BentWeights
  {
  public:
    using Values = dealii::LinearAlgebra::distributed::Vector<float>;

    /// Weights of the nodes of this rank that @p may_bend, ghosts too. @param diagonal of K, ghosts too. Collective.
    void find(const CellMatrices<dim> &K, const std::vector<PlaceInParent<dim>> &places,
              const std::vector<bool> &may_bend, const Values &diagonal);

    void clear();

    /// Of @p node, where it lies between the coarse nodes that move it: W of the one that the bits of @p p tell there, row by row.
    /// Null: its weights are linear.
    const float *
    of_node(const std::size_t node, const unsigned int p) const
    {
      return number.empty() || number[node] == straight ? nullptr : &weights[index(node, p)];
    }

    /// Adds to @p coarse what the cells, but for those that are @p done (none if empty), are to its functions, each in its parent:
    /// sum of P^T K P.
    void coarsen(const CellMatrices<dim> &K, const std::vector<PlaceInParent<dim>> &places, std::vector<bool> done,
                 CellMatrices<dim> &coarse) const;

    /// Adds what cell @p k is to the functions of its parent.
    void add_parent(const CellMatrices<dim> &K, std::size_t k, const PlaceInParent<dim> &place,
                    dealii::FullMatrix<double> &sum) const;

  private:
    static constexpr unsigned int n_nodes = CellMatrices<dim>::n_nodes, n_rows = CellMatrices<dim>::n_rows,
                                  straight = static_cast<unsigned int>(-1);

    std::size_t
    index(const std::size_t node, const unsigned int p) const
    {
      return (std::size_t(number[node]) * n_nodes + (p & between[number[node]])) * dim * dim;
    }
    template <typename Visit>
    void for_entries(const CellMatrices<dim> &K, std::size_t k, const PlaceInParent<dim> &place,
                     const Visit &visit) const;
    bool has_bent(const CellMatrices<dim> &K, std::size_t k) const;
    void number_nodes(const CellMatrices<dim> &K, const std::vector<PlaceInParent<dim>> &places,
                      const std::vector<bool> &may_bend);
    void add_forces(const CellMatrices<dim> &K, const std::vector<PlaceInParent<dim>> &places);
    void sum_over_ranks(Values sum);
    void descend(const Values &diagonal);

    std::vector<unsigned int>  number;  ///< by node, among those that are bent; empty: none is
    std::vector<unsigned char> between; ///< of these, axes along which they lie between coarse nodes
    std::vector<float>         weights; ///< of these, for each set of bits in it, dim x dim
  };
} // namespace Stroma
