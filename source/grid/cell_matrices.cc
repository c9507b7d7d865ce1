#include <stroma/grid/cell_matrices.h>

#include <algorithm>
#include <cstring>

namespace Stroma
{
  namespace
  {
    /// Of nodes at the lower and upper end of an axis, by those of the parent.
    constexpr float linear_weight[3][2][2] = {{{1.f, 0.f}, {.5f, .5f}},
                                              {{.5f, .5f}, {0.f, 1.f}},
                                              {{1.f, 0.f}, {0.f, 1.f}}};

    /// Calls @p visit(number, a, b) for the pairs of nodes a < b of a cell, in the order in which their blocks are kept.
    template <int dim, typename Visit>
    void
    for_each_pair(const Visit &visit)
    {
      unsigned int number = 0;
      for (unsigned int a = 0; a < CellMatrices<dim>::n_nodes; ++a)
        for (unsigned int b = a + 1; b < CellMatrices<dim>::n_nodes; ++b, ++number)
          visit(number, a, b);
    }

    /// Calls @p visit(what is kept, row, column) for the entries that @p batch keeps of each of its cells.
    template <int dim, typename Batch, typename Visit>
    void
    for_each_kept(Batch &batch, const Visit &visit)
    {
      for_each_pair<dim>([&](const unsigned int pair, const unsigned int a, const unsigned int b) {
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            visit(batch[pair][i * dim + j], a * dim + i, b * dim + j);
      });
    }
  } // namespace

  template <int dim>
  float
  PlaceInParent<dim>::weight(const unsigned int a, const unsigned int p) const
  {
    float product = 1.f;
    for (unsigned int d = 0; d < dim; ++d)
      product *= linear_weight[part[d]][a >> d & 1][p >> d & 1];
    return product;
  }

  template <int dim>
  unsigned int
  PlaceInParent<dim>::between(const unsigned int a) const
  {
    unsigned int axes = 0;
    for (unsigned int d = 0; d < dim; ++d)
      if (part[d] == (a >> d & 1 ? lower_half : upper_half))
        axes |= 1u << d;
    return axes;
  }

  template <int dim>
  void
  CellMatrices<dim>::reinit(const std::vector<int> &first, const std::vector<unsigned int> &shared)
  {
    Assert(width * shared.size() <= first.size() / n_nodes, dealii::ExcInternalError());
    this->shared           = shared;
    n_shared               = shared.empty() ? 0 : *std::max_element(shared.begin(), shared.end()) + 1;
    size                   = first.size() / n_nodes;
    const std::size_t full = (size + width - 1) / width;
    nodes                  = first;
    nodes.resize(full * width * n_nodes, 0); // what fills up the last batch adds zeros there
    batches.clear();
  }

  template <int dim>
  void
  CellMatrices<dim>::release()
  {
    batches.clear();
  }

  template <int dim>
  void
  CellMatrices<dim>::allocate()
  {
    if (!batches.empty())
      return;
    batches.resize_fast(n_shared + nodes.size() / (width * n_nodes) - shared.size());
    set_zero();
  }

  template <int dim>
  void
  CellMatrices<dim>::set_zero()
  {
    std::fill(batches.begin(), batches.end(), Batch{});
  }

  template <int dim>
  void
  CellMatrices<dim>::set_lane(Batch &batch, const unsigned int lane, const dealii::FullMatrix<double> &K_cell)
  {
    for_each_kept<dim>(batch, [&](Floats &kept, const unsigned int row, const unsigned int column) {
      kept[lane] = static_cast<float>(K_cell(row, column));
    });
  }

  template <int dim>
  void
  CellMatrices<dim>::set(const std::size_t k, const dealii::FullMatrix<double> &K_cell)
  {
    Assert(k >= n_sharing(), dealii::ExcInternalError());
    set_lane(batches[batch_of(k / width)], k % width, K_cell);
  }

  template <int dim>
  void
  CellMatrices<dim>::add(const std::size_t k, const dealii::FullMatrix<double> &K_cell)
  {
    Assert(k >= n_sharing(), dealii::ExcInternalError());
    for_each_kept<dim>(batches[batch_of(k / width)],
                       [&](Floats &kept, const unsigned int row, const unsigned int column) {
                         kept[k % width] += static_cast<float>(K_cell(row, column));
                       });
  }

  template <int dim>
  void
  CellMatrices<dim>::set_shared(const unsigned int number, const dealii::FullMatrix<double> &K_cell)
  {
    AssertIndexRange(number, n_shared);
    for (unsigned int lane = 0; lane < width; ++lane)
      set_lane(batches[number], lane, K_cell);
  }

  template <int dim>
  void
  CellMatrices<dim>::get(const std::size_t k, dealii::FullMatrix<double> &K_cell) const
  {
    const Batch       &batch = batches[batch_of(k / width)];
    const unsigned int lane  = k % width;
    K_cell.reinit(n_rows, n_rows);
    for_each_pair<dim>([&](const unsigned int pair, const unsigned int a, const unsigned int b) {
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          {
            const double k_ij                = batch[pair][i * dim + j][lane];
            K_cell(a * dim + i, b * dim + j) = K_cell(b * dim + j, a * dim + i) = k_ij;
            K_cell(a * dim + i, a * dim + j) -= k_ij;
            K_cell(b * dim + j, b * dim + i) -= k_ij;
          }
    });
  }

  template <int dim>
  template <typename Number>
  void
  CellMatrices<dim>::add_product(const Number *x, Number *y) const
  {
    using Lanes = typename SideBySide<Number>::type;
    for (std::size_t k = 0; k * width < size; ++k)
      {
        const Batch &batch = batches[batch_of(k)];
        const int   *first = &nodes[k * width * n_nodes];
        Lanes        u[n_nodes][dim], f[n_nodes][dim];
        for (unsigned int a = 0; a < n_nodes; ++a)
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int lane = 0; lane < width; ++lane)
              {
                u[a][i][lane] = x[first[lane * n_nodes + a] + i];
                f[a][i][lane] = 0;
              }
        unsigned int pair = 0;
        for (unsigned int a = 0; a < n_nodes; ++a)
          for (unsigned int b = a + 1; b < n_nodes; ++b, ++pair)
            {
              Lanes apart[dim], on_b[dim] = {};
              for (unsigned int i = 0; i < dim; ++i)
                apart[i] = u[b][i] - u[a][i];
              for (unsigned int i = 0; i < dim; ++i)
                for (unsigned int j = 0; j < dim; ++j)
                  {
                    const Lanes k_ij = __builtin_convertvector(batch[pair][i * dim + j], Lanes);
                    f[a][i] += k_ij * apart[j];
                    on_b[j] += k_ij * apart[i];
                  }
              for (unsigned int i = 0; i < dim; ++i)
                f[b][i] -= on_b[i];
            }
        for (unsigned int lane = 0; lane < width; ++lane)
          for (unsigned int a = 0; a < n_nodes; ++a)
            for (unsigned int i = 0; i < dim; ++i)
              y[first[lane * n_nodes + a] + i] += f[a][i][lane];
      }
  }

  template <int dim>
  template <typename Number>
  void
  CellMatrices<dim>::add_diagonal(Number *d) const
  {
    for (std::size_t k = 0; k < size; ++k)
      {
        const Batch       &batch = batches[batch_of(k / width)];
        const unsigned int lane  = k % width;
        unsigned int       pair  = 0;
        for (unsigned int a = 0; a < n_nodes; ++a)
          for (unsigned int b = a + 1; b < n_nodes; ++b, ++pair)
            for (unsigned int i = 0; i < dim; ++i)
              {
                const float k_ii = batch[pair][i * dim + i][lane];
                d[first(k, a) + i] -= k_ii;
                d[first(k, b) + i] -= k_ii;
              }
      }
  }

  template <int dim>
  float
  CellMatrices<dim>::trace(const std::size_t k) const
  {
    const Batch &batch = batches[batch_of(k / width)];
    float        sum   = 0.f;
    for (unsigned int pair = 0; pair < n_pairs; ++pair)
      for (unsigned int i = 0; i < dim; ++i)
        sum -= 2.f * batch[pair][i * dim + i][k % width];
    return sum;
  }

  template <int dim>
  void
  CellMatrices<dim>::expand(const Batch &batch, Full &K)
  {
    K                 = Full{};
    unsigned int pair = 0;
    for (unsigned int a = 0; a < n_nodes; ++a)
      for (unsigned int b = a + 1; b < n_nodes; ++b, ++pair)
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            {
              const Floats &k_ij          = batch[pair][i * dim + j];
              K[a * dim + i][b * dim + j] = k_ij;
              K[b * dim + j][a * dim + i] = k_ij;
              K[a * dim + i][a * dim + j] -= k_ij;
              K[b * dim + j][b * dim + i] -= k_ij;
            }
  }

  /// K becomes P^T K P, axis by axis.
  template <int dim>
  void
  CellMatrices<dim>::coarsen(Full &K, const PlaceInParent<dim> *places, const unsigned int n)
  {
    for (unsigned int d = 0; d < dim; ++d)
      {
        Floats weight[2][2] = {};
        for (unsigned int lane = 0; lane < n; ++lane)
          for (unsigned int a = 0; a < 2; ++a)
            for (unsigned int p = 0; p < 2; ++p)
              weight[a][p][lane] = linear_weight[places[lane].part[d]][a][p];
        const auto combine = [&](Floats &lower, Floats &upper) {
          const Floats sum = weight[0][0] * lower + weight[1][0] * upper;
          upper            = weight[0][1] * lower + weight[1][1] * upper;
          lower            = sum;
        };
        for (unsigned int row = 0; row < n_rows; ++row)
          if (!(row / dim >> d & 1))
            for (unsigned int column = 0; column < n_rows; ++column)
              combine(K[row][column], K[row + (dim << d)][column]);
        for (unsigned int row = 0; row < n_rows; ++row)
          for (unsigned int column = 0; column < n_rows; ++column)
            if (!(column / dim >> d & 1))
              combine(K[row][column], K[row][column + (dim << d)]);
      }
  }

  template <int dim>
  void
  CellMatrices<dim>::add_coarsened(const CellMatrices &fine, const std::vector<PlaceInParent<dim>> &places,
                                   const std::vector<bool> &left_out)
  {
    Full K;
    for (std::size_t begin = 0; begin < fine.size; begin += width)
      {
        const unsigned int n = std::min<std::size_t>(width, fine.size - begin);
        expand(fine.batches[fine.batch_of(begin / width)], K);
        coarsen(K, &places[begin], n);
        for (unsigned int lane = 0; lane < n; ++lane)
          {
            if (left_out[begin + lane])
              continue;
            const std::size_t  parent = places[begin + lane].parent;
            Batch             &batch  = batches[batch_of(parent / width)];
            const unsigned int to     = parent % width;
            for_each_kept<dim>(batch, [&](Floats &kept, const unsigned int row, const unsigned int column) {
              kept[to] += K[row][column][lane];
            });
          }
      }
  }

#define INSTANTIATE(dim)                                                                                               \
  template struct PlaceInParent<dim>;                                                                                  \
  template class CellMatrices<dim>;                                                                                    \
  template void CellMatrices<dim>::add_product(const float *, float *) const;                                          \
  template void CellMatrices<dim>::add_product(const double *, double *) const;                                        \
  template void CellMatrices<dim>::add_diagonal(float *) const;                                                        \
  template void CellMatrices<dim>::add_diagonal(double *) const;
  INSTANTIATE(2)
  INSTANTIATE(3)
#undef INSTANTIATE
} // namespace Stroma
