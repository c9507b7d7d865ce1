#include "own_block.h"

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace Stroma::Sph
{
  using dealii::Tensor;

  template <int dim>
  OwnBlock<dim>::OwnBlock(const System<dim> &system, const bool is_stiff, const bool has_bodies,
                          const std::vector<std::uint8_t> &held_components, const Islands<dim> *const islands)
    : system(system)
    , pairs(system.pairs)
    , is_stiff(is_stiff)
    , has_bodies(has_bodies)
    , held(held_components)
    , islands(islands)
    , n(system.particles.n_free)
    , n_bodies(system.bodies ? system.bodies->size() : 0)
    , moved(system.bodies ? pairs.n_rows() : 0)
    , place(n, -1)
    , of_bodies(n_bodies)
  {
    if (is_stiff)
      {
        ends.resize(pairs.n_pairs() + pairs.n_rows());
        for (unsigned int k = 0; k < pairs.n_rows(); ++k)
          {
            rows_of.push_back(system.elasticity->row(k));
            set_ends(k);
          }
      }
    if (system.bodies)
      set_moved();
  }

  template <int dim>
  bool
  OwnBlock<dim>::is_across(const unsigned int k, const std::size_t p) const
  {
    return system.interfaces && k < n && system.interfaces->touches(k) && pairs.P[p] == 0. &&
           !pairs.meets_wall_point(p);
  }

  template <int dim>
  void
  OwnBlock<dim>::set_ends(const unsigned int k)
  {
    const auto B_T   = transpose(rows_of[k].correction);
    const auto first = pairs.row_start[k];
    End *const of_k  = ends.data() + first + k;
    End       &own   = of_k[size(k)];
    for (unsigned int e = 0; e < size(k); ++e)
      {
        const double P = rows_of[k].a > 0. ? system.elasticity->weights()[first + e] : 0.;
        of_k[e]        = {B_T * pairs.c[first + e], P * pairs.r[first + e], P};
        own.g -= of_k[e].g;
        own.p -= of_k[e].p;
        own.P += P;
      }
  }

  template <int dim>
  void
  OwnBlock<dim>::set_moved()
  {
    system.bodies->visit_ends(
      [&](const unsigned int k, const std::size_t p, const unsigned int u, const Tensor<1, dim> &velocity) {
        moved[k].push_back({static_cast<unsigned int>(p - pairs.row_start[k]), u, velocity});
      });
  }

  template <int dim>
  unsigned int
  OwnBlock<dim>::find(const unsigned int k, const unsigned int i) const
  {
    const auto begin = pairs.j.begin() + pairs.row_start[k], end = pairs.j.begin() + pairs.row_start[k + 1];
    return static_cast<unsigned int>(std::find(begin, end, i) - begin);
  }

  template <int dim>
  typename OwnBlock<dim>::Block
  OwnBlock<dim>::block(const unsigned int k, const unsigned int a, const unsigned int b) const
  {
    const auto  &row = rows_of[k];
    const End   &A = end(k, a), &B = end(k, b);
    const double w = 1. / (4. * row.volume), G = w * row.G, lambda = w * (row.K - 2. / 3. * row.G);
    double       diagonal = G * (A.g * B.g);
    if (row.a > 0.)
      {
        const unsigned int own = size(k);
        const double       P   = a == b ? A.P : a == own ? -B.P : b == own ? -A.P : 0.;
        diagonal += row.a * (P - A.p * (row.inverse_moment * B.p));
      }
    Block sum;
    for (unsigned int c = 0; c < dim; ++c)
      {
        for (unsigned int e = 0; e < dim; ++e)
          sum[c][e] = G * B.g[c] * A.g[e] + lambda * A.g[c] * B.g[e];
        sum[c][c] += diagonal;
      }
    return sum;
  }

  template <int dim>
  dealii::SymmetricTensor<2, dim>
  OwnBlock<dim>::pair_block(const unsigned int k, const std::size_t p) const
  {
    dealii::SymmetricTensor<2, dim> sum;
    if (system.friction)
      sum += system.friction->pair_block(p);
    if (is_stiff && is_across(k, p))
      sum += system.elasticity->pair_block(k, p);
    return sum;
  }

  template <int dim>
  typename OwnBlock<dim>::Block &
  OwnBlock<dim>::at(const unsigned int j)
  {
    if (place[j] < 0)
      {
        place[j] = static_cast<int>(columns.size());
        columns.push_back(j);
        blocks.emplace_back();
      }
    return blocks[place[j]];
  }

  /// What row @p k, in which particle @p i is end @p a, is between that and all its ends.
  template <int dim>
  void
  OwnBlock<dim>::gather_row(const unsigned int i, const unsigned int k, const unsigned int a)
  {
    for (unsigned int b = 0; b <= size(k); ++b)
      if (const unsigned int j = particle(k, b); j >= i && j < n)
        at(j) += block(k, a, b);
    if (system.bodies)
      for (const auto &end : moved[k])
        of_bodies[end.u] += block(k, a, end.e) * end.velocity;
  }

  template <int dim>
  void
  OwnBlock<dim>::gather_pairs(const unsigned int i)
  {
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
      {
        const Block of_pair(pair_block(i, p));
        at(i) += of_pair;
        if (const unsigned int j = pairs.j[p]; j > i && j < n)
          at(j) -= of_pair;
      }
    if (system.bodies)
      for (const auto &end : moved[i])
        of_bodies[end.u] -= pair_block(i, pairs.row_start[i] + end.e) * end.velocity;
  }

  /// Row @p i of the matrix.
  template <int dim>
  void
  OwnBlock<dim>::gather(const unsigned int i)
  {
    for (const unsigned int j : columns)
      place[j] = -1;
    columns.clear();
    blocks.clear();
    of_bodies.assign(n_bodies, {});
    if (is_stiff)
      {
        gather_row(i, i, size(i));
        for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
          if (const unsigned int k = pairs.j[p]; k < pairs.n_rows())
            if (const unsigned int a = find(k, i); a < size(k))
              gather_row(i, k, a);
      }
    gather_pairs(i);
    if (islands && islands->has(i))
      {
        Block       &own  = at(i);
        const double more = Islands<dim>::shift(trace(own));
        for (unsigned int c = 0; c < dim; ++c)
          own[c][c] += more;
      }
  }

  template <int dim>
  void
  OwnBlock<dim>::write(Solvers::SparseRows &rows, const unsigned int i)
  {
    std::sort(columns.begin(), columns.end());
    for (unsigned int c = 0; c < dim; ++c)
      {
        const std::size_t before = rows.value.size();
        const auto        add    = [&](const unsigned int column, const double value) {
          rows.column.push_back(column);
          rows.value.push_back(value);
        };
        if (held[i] >> c & 1)
          add(i * dim + c, 1.);
        else
          {
            for (const unsigned int j : columns)
              for (unsigned int e = j == i ? c : 0; e < dim; ++e)
                if (!(held[j] >> e & 1))
                  add(j * dim + e, blocks[place[j]][c][e]);
            for (unsigned int u = 0; u < n_bodies && has_bodies; ++u)
              if (of_bodies[u][c] != 0.)
                add(n * dim + u, of_bodies[u][c]);
          }
        rows.length.push_back(rows.value.size() - before);
      }
  }

  /// Between the unknowns of bodies. Collective.
  template <int dim>
  dealii::FullMatrix<double>
  OwnBlock<dim>::sum_of_bodies() const
  {
    dealii::FullMatrix<double> sum(n_bodies, n_bodies);
    for (unsigned int k = 0; k < moved.size(); ++k)
      for (const auto &A : moved[k])
        for (const auto &B : moved[k])
          {
            if (is_stiff)
              sum(A.u, B.u) += A.velocity * (block(k, A.e, B.e) * B.velocity);
            if (A.e == B.e)
              sum(A.u, B.u) += A.velocity * (pair_block(k, pairs.row_start[k] + A.e) * B.velocity);
          }
    dealii::Utilities::MPI::sum(sum, system.scene.comm, sum);
    sum.add(1., system.bodies->resistance());
    return sum;
  }

  template <int dim>
  Solvers::SparseRows
  OwnBlock<dim>::upper()
  {
    Solvers::SparseRows rows;
    for (unsigned int i = 0; i < n; ++i)
      {
        gather(i);
        write(rows, i);
      }
    if (n_bodies == 0)
      return rows;
    const auto sum = sum_of_bodies();
    for (unsigned int u = 0; u < n_bodies && has_bodies; ++u)
      {
        rows.length.push_back(n_bodies - u);
        for (unsigned int w = u; w < n_bodies; ++w)
          {
            rows.column.push_back(n * dim + w);
            rows.value.push_back(sum(u, w));
          }
      }
    return rows;
  }

  template class OwnBlock<2>;
  template class OwnBlock<3>;
} // namespace Stroma::Sph
