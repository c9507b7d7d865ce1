#pragma once

#include <stroma/base/power.h>

#include <deal.II/base/aligned_vector.h>
#include <deal.II/lac/full_matrix.h>

#include <array>
#include <cstdint>
#include <vector>

namespace Stroma
{
  /// Where a cell lies in the one that holds it on the next coarser grid.
  template <int dim>
  struct PlaceInParent
  {
    enum Part : std::uint8_t
    {
      lower_half,
      upper_half,
      whole
    };
    std::uint32_t         parent;
    std::array<Part, dim> part; ///< along each axis

    /// What a linear function of the parent that is 1 at its node @p p is at node @p a.
    float weight(unsigned int a, unsigned int p) const;

    /// Axes, as bits, along which node @p a lies between two nodes of the parent: the same from all cells that have the node.
    unsigned int between(unsigned int a) const;
  };

  /**
   * Symmetric matrices K of cells with 2^dim nodes, of which no translation makes a force: sum_b K_ab = 0 over the nodes b, as of
   * internal forces. In single precision, 8 cells side by side. Kept are the blocks between different nodes a < b only,
   *   (K x)_a = sum_{b != a} K_ab (x_b - x_a),
   * so that translations make no force whatever is rounded.
   *
   * Cells whose matrices are equal may share one, eight after eight: the first ones.
   */
  template <int dim>
  class CellMatrices
  {
  public:
    static constexpr unsigned int n_nodes = power(2, dim), n_rows = dim * n_nodes;

    static constexpr unsigned int width = 8;

    /// Cells without matrices yet. @p first where in a vector the unknowns of each node begin, cell by cell
    /// @param shared numbers from 0 of matrices that cells share: of the first eight, the next eight ...
    void reinit(const std::vector<int> &first, const std::vector<unsigned int> &shared = {});

    /// Makes zero matrices, where there are none.
    void allocate();

    /// Frees the memory of the matrices.
    void release();

    void set_zero();

    /// Of a cell that shares none. @param K_cell unknowns node by node; its upper triangle counts
    void set(std::size_t k, const dealii::FullMatrix<double> &K_cell);

    /// That which has @p number among those that are shared.
    void set_shared(unsigned int number, const dealii::FullMatrix<double> &K_cell);

    /// How many cells share theirs: the first ones.
    std::size_t
    n_sharing() const
    {
      return width * shared.size();
    }

    void get(std::size_t k, dealii::FullMatrix<double> &K_cell) const;

    /// y += K x of all cells together.
    template <typename Number>
    void add_product(const Number *x, Number *y) const;

    /// Adds the diagonal of the sum of all cells.
    template <typename Number>
    void add_diagonal(Number *d) const;

    /// Adds to the matrix of cell @p k, which shares none.
    void add(std::size_t k, const dealii::FullMatrix<double> &K_cell);

    /// Adds to the cells that hold those of @p fine, but for the ones @p left_out, what these are to linear functions:
    /// sum of P^T K P.
    void add_coarsened(const CellMatrices &fine, const std::vector<PlaceInParent<dim>> &places,
                       const std::vector<bool> &left_out);

    /// Sum of the diagonal of cell @p k's matrix.
    float trace(std::size_t k) const;

    std::size_t
    n_cells() const
    {
      return size;
    }
    /// Where in a vector the unknowns of node @p a of cell @p k begin.
    int
    first(const std::size_t k, const unsigned int a) const
    {
      return nodes[k * n_nodes + a];
    }

  private:
    static constexpr unsigned int n_pairs = n_nodes * (n_nodes - 1) / 2;

    template <typename Number>
    struct SideBySide
    {
      typedef Number type __attribute__((vector_size(width * sizeof(Number))));
    };
    using Floats = typename SideBySide<float>::type;
    using Batch  = std::array<std::array<Floats, dim * dim>, n_pairs>; ///< [a < b][i * dim + j]
    using Full   = std::array<std::array<Floats, n_rows>, n_rows>;

    /// Which batch the cells from width * @p i on have.
    std::size_t
    batch_of(const std::size_t i) const
    {
      return i < shared.size() ? shared[i] : n_shared + i - shared.size();
    }
    static void set_lane(Batch &batch, unsigned int lane, const dealii::FullMatrix<double> &K_cell);
    static void expand(const Batch &batch, Full &K);
    static void coarsen(Full &K, const PlaceInParent<dim> *places, unsigned int n);

    std::size_t                  size = 0;
    std::vector<int>             nodes;        ///< filled up to whole batches
    std::vector<unsigned int>    shared;       ///< by batch of cells, the first ones
    std::size_t                  n_shared = 0; ///< matrices
    dealii::AlignedVector<Batch> batches;      ///< shared ones, then those of the other cells
  };
} // namespace Stroma
