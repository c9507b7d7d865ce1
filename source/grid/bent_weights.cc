#include <stroma/grid/bent_weights.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace Stroma
{
  namespace
  {
    /// Length of the step. On slices with holes and at contrasts .6 to 1 differ by two iterations.
    constexpr float omega = .8f;
    /// Largest change of a weight.
    constexpr float longest_step = .5f;
  } // namespace

  template <int dim>
  void
  BentWeights<dim>::clear()
  {
    number  = {};
    between = {};
    weights = {};
  }

  template <int dim>
  void
  BentWeights<dim>::find(const CellMatrices<dim> &K, const std::vector<PlaceInParent<dim>> &places,
                         const std::vector<bool> &may_bend, const Values &diagonal)
  {
    clear();
    number_nodes(K, places, may_bend);
    if (dealii::Utilities::MPI::sum(between.size(), diagonal.get_mpi_communicator()) == 0)
      return;
    add_forces(K, places);
    sum_over_ranks(diagonal);
    descend(diagonal);
  }

  /// Nodes that coincide with a coarse one follow it.
  template <int dim>
  void
  BentWeights<dim>::number_nodes(const CellMatrices<dim> &K, const std::vector<PlaceInParent<dim>> &places,
                                 const std::vector<bool> &may_bend)
  {
    number.assign(may_bend.size(), straight);
    for (std::size_t k = 0; k < K.n_cells(); ++k)
      for (unsigned int a = 0; a < n_nodes; ++a)
        if (const auto node = K.first(k, a) / dim; may_bend[node] && number[node] == straight)
          if (const unsigned int axes = places[k].between(a); axes != 0)
            {
              number[node] = between.size();
              between.push_back(axes);
            }
    if (between.empty())
      number = {};
    weights.assign(between.size() * n_nodes * dim * dim, 0.f);
  }

  template <int dim>
  bool
  BentWeights<dim>::has_bent(const CellMatrices<dim> &K, const std::size_t k) const
  {
    for (unsigned int a = 0; a < n_nodes && !number.empty(); ++a)
      if (number[K.first(k, a) / dim] != straight)
        return true;
    return false;
  }

  /// Of cells of this rank, where weights will stand: B.
  template <int dim>
  void
  BentWeights<dim>::add_forces(const CellMatrices<dim> &K, const std::vector<PlaceInParent<dim>> &places)
  {
    dealii::FullMatrix<double> K_cell;
    for (std::size_t k = 0; k < K.n_cells(); ++k)
      if (has_bent(K, k))
        {
          K.get(k, K_cell);
          for (unsigned int a = 0; a < n_nodes; ++a)
            for (unsigned int p = 0; p < n_nodes; ++p)
              if (of_node(K.first(k, a) / dim, p) && places[k].weight(a, p) > 0.f)
                {
                  float *const B = &weights[index(K.first(k, a) / dim, p)];
                  for (unsigned int b = 0; b < n_nodes; ++b)
                    if (const float w = places[k].weight(b, p); w > 0.f)
                      for (unsigned int i = 0; i < dim; ++i)
                        for (unsigned int j = 0; j < dim; ++j)
                          B[i * dim + j] += w * static_cast<float>(K_cell(a * dim + i, b * dim + j));
                }
        }
  }

  /// @param sum any vector of the grid
  template <int dim>
  void
  BentWeights<dim>::sum_over_ranks(Values sum)
  {
    if (dealii::Utilities::MPI::n_mpi_processes(sum.get_mpi_communicator()) == 1)
      return;
    sum.zero_out_ghost_values();
    const auto for_bent = [&](const auto &visit) {
      for (std::size_t node = 0; node < number.size(); ++node)
        if (number[node] != straight)
          visit(sum.begin() + node * dim, &weights[std::size_t(number[node]) * n_nodes * dim * dim]);
    };
    for (unsigned int p = 0; p < n_nodes; ++p)
      for (unsigned int j = 0; j < dim; ++j)
        {
          sum = 0.f;
          for_bent([&](float *to, const float *B) {
            for (unsigned int i = 0; i < dim; ++i)
              to[i] = B[(p * dim + i) * dim + j];
          });
          sum.compress(dealii::VectorOperation::add);
          sum.update_ghost_values();
          for_bent([&](const float *from, float *B) {
            for (unsigned int i = 0; i < dim; ++i)
              B[(p * dim + i) * dim + j] = from[i];
          });
          sum.zero_out_ghost_values();
        }
  }

  /// A step that would be long is none: K is hardly definite there, and the energy has no least value.
  template <int dim>
  void
  BentWeights<dim>::descend(const Values &diagonal)
  {
    constexpr unsigned int size = dim * dim;
    for (std::size_t node = 0; node < number.size(); ++node)
      if (number[node] != straight)
        {
          const unsigned int axes       = between[number[node]];
          unsigned int       n          = 0; // coarse nodes
          float              mean[size] = {}, longest = 0.f;
          float *const       W = &weights[std::size_t(number[node]) * n_nodes * size];
          for (unsigned int p = 0; p < n_nodes; ++p)
            if ((p & axes) == p)
              {
                ++n;
                for (unsigned int i = 0; i < size; ++i)
                  mean[i] += W[p * size + i];
              }
          for (unsigned int p = 0; p < n_nodes; ++p)
            for (unsigned int i = 0; i < size; ++i)
              if ((p & axes) == p)
                {
                  const float d   = diagonal.begin()[node * dim + i / dim];
                  W[p * size + i] = d > 0.f ? omega / d * (W[p * size + i] - mean[i] / n) : 2.f * longest_step;
                  longest         = std::max(longest, std::abs(W[p * size + i]));
                }
          for (unsigned int p = 0; p < n_nodes; ++p)
            for (unsigned int i = 0; i < size; ++i)
              if ((p & axes) == p)
                W[p * size + i] = (i % (dim + 1) == 0 ? 1.f / n : 0.f) -
                                  (longest > longest_step ? 0.f : W[p * size + i]);
        }
  }

  template <int dim>
  void
  BentWeights<dim>::coarsen(const CellMatrices<dim> &K, const std::vector<PlaceInParent<dim>> &places,
                            std::vector<bool> done, CellMatrices<dim> &coarse) const
  {
    done.resize(K.n_cells(), false);
    dealii::FullMatrix<double> PKP;
    for (std::size_t k = 0; k < K.n_cells() && !number.empty(); ++k)
      if (!done[k] && has_bent(K, k))
        {
          PKP.reinit(n_rows, n_rows);
          add_parent(K, k, places[k], PKP);
          coarse.add(places[k].parent, PKP);
          done[k] = true;
        }
    coarse.add_coarsened(K, places, done);
  }

  /// Calls visit(row, column, entry) for the entries of P of cell @p k that may differ from zero.
  template <int dim>
  template <typename Visit>
  void
  BentWeights<dim>::for_entries(const CellMatrices<dim> &K, const std::size_t k, const PlaceInParent<dim> &place,
                                const Visit &visit) const
  {
    for (unsigned int a = 0; a < n_nodes; ++a)
      for (unsigned int p = 0; p < n_nodes; ++p)
        if (const double w = place.weight(a, p); w > 0.)
          {
            const float *const W = of_node(K.first(k, a) / dim, p);
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int j = 0; j < dim; ++j)
                if (W || i == j)
                  visit(a * dim + i, p * dim + j, W ? W[i * dim + j] : w);
          }
  }

  template <int dim>
  void
  BentWeights<dim>::add_parent(const CellMatrices<dim> &K, const std::size_t k, const PlaceInParent<dim> &place,
                               dealii::FullMatrix<double> &sum) const
  {
    dealii::FullMatrix<double> K_cell, KP(n_rows, n_rows);
    K.get(k, K_cell);
    for_entries(K, k, place, [&](const unsigned int fine, const unsigned int coarse, const double entry) {
      for (unsigned int row = 0; row < n_rows; ++row)
        KP(row, coarse) += K_cell(row, fine) * entry;
    });
    for_entries(K, k, place, [&](const unsigned int fine, const unsigned int coarse, const double entry) {
      for (unsigned int column = 0; column < n_rows; ++column)
        sum(coarse, column) += entry * KP(fine, column);
    });
  }

  template class BentWeights<2>;
  template class BentWeights<3>;
} // namespace Stroma
