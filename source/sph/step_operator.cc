#include <stroma/sph/step_operator.h>

#include <algorithm>
#include <array>

#include "own_block.h"
#include "vector_view.h"

namespace Stroma::Sph
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  namespace
  {
    /// Longest pair, over the spacing, that the approximation holds. With the 8 nearest of 20 neighbours the preconditioned solve
    /// takes two thirds of the iterations that it takes with all of them (the longer ones smear what is to be smoothed), and each
    /// costs half.
    constexpr double approximation_reach = 1.6;

    /// Added to the diagonal of the bodies' block, over its largest entry.
    constexpr double least_of_block = 1e-8;

    /// Number @p m of the rigid motions: first along the axes, then about them.
    template <int dim>
    Tensor<1, dim>
    rigid_motion(const unsigned int m, const dealii::Point<dim> &x)
    {
      Tensor<1, dim> motion;
      if (m < dim)
        motion[m] = 1.;
      else
        {
          const unsigned int a = dim == 2 ? 0 : (m + 1) % dim, b = dim == 2 ? 1 : (m + 2) % dim;
          motion[a] = -x[b];
          motion[b] = x[a];
        }
      return motion;
    }
  } // namespace

  template <int dim>
  StepOperator<dim>::StepOperator(const System<dim> &system, const Islands<dim> *const islands)
    : system(system)
    , islands(islands)
  {}

  template <int dim>
  void
  StepOperator<dim>::set_step(const double step)
  {
    dt = step;
    if (is_stiff())
      system.elasticity->combine(dt, system.is_smooth ? 1. : 0.);
    v.assign(system.pairs.n_points(), {});
  }

  template <int dim>
  std::vector<Vector>
  StepOperator<dim>::near_null_space() const
  {
    std::vector<Vector> modes;
    const unsigned int  n = system.particles.n_free;
    for (unsigned int m = 0; m < (couples_components() ? dim * (dim + 1) / 2 : 1); ++m)
      {
        modes.emplace_back(owned(0), system.scene.comm);
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int c = 0; c < dim; ++c)
            if (!system.is_held(i, c))
              view<Tensor<1, dim>>(modes.back())[i][c] = couples_components() ?
                                                           rigid_motion(m, system.particles.x[i])[c] :
                                                           1.;
      }
    return modes;
  }

  template <int dim>
  bool
  StepOperator<dim>::is_last() const
  {
    const auto comm = system.scene.comm;
    return dealii::Utilities::MPI::this_mpi_process(comm) + 1 == dealii::Utilities::MPI::n_mpi_processes(comm);
  }

  /// Components of this rank's free particles, and @p n_last behind them on the last rank.
  template <int dim>
  dealii::IndexSet
  StepOperator<dim>::owned(const unsigned int n_last) const
  {
    const auto      &neighbours = *system.neighbours;
    dealii::IndexSet owned(neighbours.n_equations * dim + n_last);
    owned.add_range(neighbours.first_equation * dim,
                    (neighbours.first_equation + neighbours.n_free()) * dim + (is_last() ? n_last : 0));
    return owned;
  }

  template <int dim>
  Vector
  StepOperator<dim>::new_vector() const
  {
    return Vector(owned(system.bodies ? system.bodies->size() : 0), system.scene.comm);
  }

  template <int dim>
  std::vector<double>
  StepOperator<dim>::of_bodies(const Vector &x) const
  {
    std::vector<double> q(system.bodies->size());
    if (is_last())
      std::copy_n(x.begin() + dim * system.particles.n_free, q.size(), q.begin());
    MPI_Bcast(q.data(), q.size(), MPI_DOUBLE, dealii::Utilities::MPI::n_mpi_processes(system.scene.comm) - 1,
              system.scene.comm);
    return q;
  }

  template <int dim>
  void
  StepOperator<dim>::set_bodies(Vector &x, const std::vector<double> &q) const
  {
    if (is_last())
      std::copy(q.begin(), q.end(), x.begin() + dim * system.particles.n_free);
  }

  template <int dim>
  void
  StepOperator<dim>::force(Velocities &force, const Velocities &velocities) const
  {
    const unsigned int n = system.particles.n_free;
    force.assign(n, {});
    if (is_stiff())
      system.elasticity->add_stiffness_force(force, velocities);
    if (system.friction)
      system.friction->add_force(force, velocities);
  }

  template <int dim>
  std::vector<double>
  StepOperator<dim>::force_on_bodies(const Velocities &velocities) const
  {
    return system.bodies->forces([&](const unsigned int i, const auto &add) {
      if (is_stiff())
        system.elasticity->visit_wall_responses(i, velocities, add);
      for (unsigned int p = system.pairs.row_fixed[i]; system.friction && p < system.pairs.row_start[i + 1]; ++p)
        add(p, system.friction->pair_force(p, velocities[system.pairs.j[p]] - velocities[i]));
    });
  }

  template <int dim>
  void
  StepOperator<dim>::vmult(Vector &y, const Vector &x) const
  {
    const unsigned int n = system.particles.n_free;
    std::copy(view<Tensor<1, dim>>(x), view<Tensor<1, dim>>(x) + n, v.begin());
    for (const auto &held : system.loads->held())
      for (unsigned int c = 0; c < dim; ++c)
        if (system.is_held(held.particle, c))
          v[held.particle][c] = 0.;
    if (islands)
      islands->remove_rigid_motions(v.data());
    system.neighbours->update_ghosts(v);
    const auto q = system.bodies ? of_bodies(x) : std::vector<double>();
    if (system.bodies)
      system.bodies->set_velocities(v, q);
    system.pairs.let_slide(v);
    force(f, v);
    for (unsigned int i = 0; i < n; ++i)
      view<Tensor<1, dim>>(y)[i] = -f[i];
    for (const auto &held : system.loads->held())
      for (unsigned int c = 0; c < dim; ++c)
        if (system.is_held(held.particle, c))
          view<Tensor<1, dim>>(y)[held.particle][c] = view<Tensor<1, dim>>(x)[held.particle][c];
    if (islands)
      islands->remove_rigid_motions(view<Tensor<1, dim>>(y));
    if (!system.bodies)
      return;
    auto        minus = force_on_bodies(v);
    const auto &drag  = system.bodies->resistance();
    for (unsigned int u = 0; u < minus.size(); ++u)
      {
        minus[u] = -minus[u];
        for (unsigned int w = 0; w < minus.size(); ++w)
          minus[u] += drag(u, w) * q[w];
      }
    set_bodies(y, minus);
  }

  template <int dim>
  dealii::FullMatrix<double>
  StepOperator<dim>::border() const
  {
    auto block = system.bodies->sum_of_blocks(
      [&](const unsigned int i, const std::size_t p) { return pair_block(i, p); });
    block.add(1., system.bodies->resistance());
    // What few pairs leave undetermined must not be singular here.
    double largest = 0.;
    for (unsigned int u = 0; u < block.m(); ++u)
      largest = std::max(largest, block(u, u));
    for (unsigned int u = 0; u < block.m(); ++u)
      block(u, u) += largest > 0. ? least_of_block * largest : 1.;
    return is_last() ? block : dealii::FullMatrix<double>();
  }

  template <int dim>
  void
  StepOperator<dim>::diagonal(Vector &d) const
  {
    const unsigned int                   n = system.particles.n_free;
    std::vector<SymmetricTensor<2, dim>> blocks(n);
    if (system.friction)
      system.friction->add_diagonal(blocks, n);
    if (is_stiff())
      system.elasticity->add_diagonal(blocks);
    for (unsigned int i = 0; i < n; ++i)
      {
        const double more = is_in_island(i) ? Islands<dim>::shift(trace(blocks[i])) : 0.;
        for (unsigned int c = 0; c < dim; ++c)
          view<Tensor<1, dim>>(d)[i][c] = system.is_held(i, c) ? 1. : blocks[i][c][c] + more;
      }
    if (!system.bodies)
      return;
    const auto block = border();
    for (unsigned int u = 0; u < block.m(); ++u)
      d.begin()[dim * n + u] = block(u, u);
  }

  template <int dim>
  std::vector<std::uint8_t>
  StepOperator<dim>::held_components() const
  {
    std::vector<std::uint8_t> held(system.particles.size());
    for (const auto &point : system.loads->held())
      for (unsigned int c = 0; c < dim; ++c)
        if (system.is_held(point.particle, c))
          held[point.particle] |= 1 << c;
    system.neighbours->update_ghosts(held);
    return held;
  }

  template <int dim>
  SymmetricTensor<2, dim>
  StepOperator<dim>::pair_block(const unsigned int i, const std::size_t p) const
  {
    SymmetricTensor<2, dim> block;
    if (system.friction)
      block += system.friction->pair_block(p);
    if (is_stiff())
      block += system.elasticity->pair_block(i, p);
    return block;
  }

  template <int dim>
  const Matrix &
  StepOperator<dim>::approximation()
  {
    const auto        &pairs      = system.pairs;
    const auto        &equation   = system.neighbours->equation;
    const unsigned int n          = system.particles.n_free;
    const auto         held       = held_components();
    const bool         is_coupled = couples_components();
    const double       reach      = approximation_reach * system.settings.arrangement.spacing;
    unsigned int       longest    = 0;
    for (unsigned int i = 0; i < n; ++i)
      longest = std::max(longest, 1 + pairs.row_fixed[i] - pairs.row_start[i]);
    compact.emplace(owned(0), system.scene.comm, longest * (is_coupled ? dim : 1));

    std::array<std::vector<dealii::types::global_dof_index>, dim> columns;
    std::array<std::vector<double>, dim>                          values;
    const auto add = [&](const unsigned int i, const unsigned int j, const SymmetricTensor<2, dim> &block) {
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int e = is_coupled ? 0 : c; e < (is_coupled ? dim : c + 1); ++e)
          if ((i == j && c == e) || !((held[i] >> c & 1) || (held[j] >> e & 1)))
            {
              columns[c].push_back(equation[j] * dim + e);
              values[c].push_back(block[c][e]);
            }
    };
    for (unsigned int i = 0; i < n; ++i)
      {
        SymmetricTensor<2, dim> own, far;
        for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
          {
            const auto block   = pair_block(i, p);
            const bool is_near = pairs.r[p].norm_square() < reach * reach;
            (is_near ? own : far) += block;
            if (!is_near)
              continue;
            if (p < pairs.row_fixed[i])
              add(i, pairs.j[p], -1. * block);
          }
        if (trace(own) <= 0.)
          own = far;
        if (is_in_island(i))
          own += Islands<dim>::shift(trace(own)) * dealii::unit_symmetric_tensor<dim>();
        add(i, i, own);
        for (unsigned int c = 0; c < dim; ++c)
          {
            compact->set(equation[i] * dim + c, columns[c].size(), columns[c].data(), values[c].data(), false);
            columns[c].clear();
            values[c].clear();
          }
      }
    compact->compress(dealii::VectorOperation::insert);
    return *compact;
  }

  template <int dim>
  const Solvers::SparseRows &
  StepOperator<dim>::own_block()
  {
    own = OwnBlock<dim>(system, is_stiff(), is_last(), held_components(), islands).upper();
    return own;
  }

  template <int dim>
  const Solvers::SparseRows &
  StepOperator<dim>::restore_own_block(Solvers::SparseRows &&rows)
  {
    own = std::move(rows);
    return own;
  }

  template <int dim>
  Solvers::SparseRows
  StepOperator<dim>::matrix_rows() const
  {
    Solvers::SparseRows rows;
    if (!compact)
      return own;
    const auto &matrix = compact->trilinos_matrix(); // deal.II's iterators take memory of a whole vector for each row
    for (int row = 0; row < matrix.NumMyRows(); ++row)
      {
        int     length;
        int    *columns;
        double *values;
        matrix.ExtractMyRowView(row, length, values, columns);
        rows.length.push_back(length);
        rows.value.insert(rows.value.end(), values, values + length);
        for (int k = 0; k < length; ++k)
          rows.column.push_back(matrix.GCID64(columns[k]));
      }
    return rows;
  }

  template <int dim>
  const Matrix &
  StepOperator<dim>::restore_approximation(const Solvers::SparseRows &rows)
  {
    const auto          rows_owned = owned(0);
    const std::uint64_t longest = rows.length.empty() ? 0 : *std::max_element(rows.length.begin(), rows.length.end());
    compact.emplace(rows_owned, system.scene.comm, static_cast<unsigned int>(longest));
    std::size_t                                  first = 0;
    std::vector<dealii::types::global_dof_index> columns;
    for (std::size_t k = 0; k < rows.length.size(); ++k)
      {
        columns.assign(rows.column.begin() + first, rows.column.begin() + first + rows.length[k]);
        compact->set(rows_owned.nth_index_in_set(k), columns.size(), columns.data(), rows.value.data() + first, false);
        first += rows.length[k];
      }
    compact->compress(dealii::VectorOperation::insert);
    return *compact;
  }

  template class StepOperator<2>;
  template class StepOperator<3>;
} // namespace Stroma::Sph
