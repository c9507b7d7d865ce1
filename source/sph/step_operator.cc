#include <stroma/sph/step_operator.h>

#include <deal.II/lac/trilinos_sparsity_pattern.h>

namespace Stroma::Sph
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  namespace
  {
    template <int dim>
    Tensor<1, dim> *
    view(Vector &x)
    {
      return reinterpret_cast<Tensor<1, dim> *>(x.begin());
    }

    template <int dim>
    const Tensor<1, dim> *
    view(const Vector &x)
    {
      return reinterpret_cast<const Tensor<1, dim> *>(x.begin());
    }
  } // namespace

  template <int dim>
  StepOperator<dim>::StepOperator(const System<dim> &system)
    : system(system)
  {}

  template <int dim>
  void
  StepOperator<dim>::set_step(const double step)
  {
    dt = step;
    if (is_stiff())
      system.elasticity->combine(dt, system.is_smooth ? 1. : 0.);
    v.assign(system.particles.size(), {});
  }

  template <int dim>
  std::vector<Vector>
  StepOperator<dim>::rigid_motions() const
  {
    std::vector<Vector> motions;
    const unsigned int  n = system.particles.n_free;
    for (unsigned int m = 0; m < dim * (dim + 1) / 2; ++m)
    {
      motions.push_back(new_vector());
      for (unsigned int i = 0; i < n; ++i)
      {
        Tensor<1, dim> &motion = view<dim>(motions.back())[i];
        if (m < dim)
          motion[m] = 1.;
        else
        {
          const unsigned int a = (m + 1) % dim, b = (m + 2) % dim;
          motion[dim == 2 ? 0 : a] = -system.particles.x[i][dim == 2 ? 1 : b];
          motion[dim == 2 ? 1 : b] = system.particles.x[i][dim == 2 ? 0 : a];
        }
        for (unsigned int c = 0; c < dim; ++c)
          if (system.is_held(i, c))
            motion[c] = 0.;
      }
    }
    return motions;
  }

  template <int dim>
  Vector
  StepOperator<dim>::new_vector() const
  {
    const auto      &neighbours = *system.neighbours;
    dealii::IndexSet owned(neighbours.n_equations * dim);
    owned.add_range(neighbours.first_equation * dim, (neighbours.first_equation + neighbours.n_free()) * dim);
    return Vector(owned, system.scene.comm);
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
      system.friction->add_force(force, velocities, n);
  }

  template <int dim>
  void
  StepOperator<dim>::vmult(Vector &y, const Vector &x) const
  {
    const unsigned int n = system.particles.n_free;
    std::copy(view<dim>(x), view<dim>(x) + n, v.begin());
    for (const auto &held : system.loads->held())
      for (unsigned int c = 0; c < dim; ++c)
        if (system.is_held(held.particle, c))
          v[held.particle][c] = 0.;
    system.neighbours->update_ghosts(v);
    force(f, v);
    for (unsigned int i = 0; i < n; ++i)
      view<dim>(y)[i] = -f[i];
    for (const auto &held : system.loads->held())
      for (unsigned int c = 0; c < dim; ++c)
        if (system.is_held(held.particle, c))
          view<dim>(y)[held.particle][c] = view<dim>(x)[held.particle][c];
  }

  template <int dim>
  void
  StepOperator<dim>::diagonal(Vector &d) const
  {
    const unsigned int                n = system.particles.n_free;
    std::vector<SymmetricTensor<2, dim>> blocks(n);
    if (system.friction)
      system.friction->add_diagonal(blocks, n);
    if (is_stiff())
      system.elasticity->add_diagonal(blocks);
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int c = 0; c < dim; ++c)
        view<dim>(d)[i][c] = system.is_held(i, c) ? 1. : blocks[i][c][c];
  }

  template <int dim>
  const Matrix &
  StepOperator<dim>::approximation()
  {
    make_approximation();
    return compact;
  }

  template <int dim>
  void
  StepOperator<dim>::make_approximation()
  {
    const auto        &pairs      = system.pairs;
    const auto        &neighbours = *system.neighbours;
    const unsigned int n          = system.particles.n_free;
    const auto         owned      = new_vector().locally_owned_elements();
    dealii::TrilinosWrappers::SparsityPattern pattern(owned, system.scene.comm, 60);
    std::vector<dealii::types::global_dof_index> row, columns;
    std::vector<double> values;
    const auto visit = [&](const auto &use) {
      for (unsigned int i = 0; i < n; ++i)
      {
        columns.clear();
        for (unsigned int c = 0; c < dim; ++c)
          columns.push_back(neighbours.equation[i] * dim + c);
        for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
          for (unsigned int c = 0; c < dim; ++c)
            columns.push_back(neighbours.equation[pairs.j[p]] * dim + c);
        use(i);
      }
    };
    visit([&](const unsigned int i) {
      for (unsigned int c = 0; c < dim; ++c)
        pattern.add_entries(neighbours.equation[i] * dim + c, columns.begin(), columns.end());
    });
    pattern.compress();
    compact.reinit(pattern);
    visit([&](const unsigned int i) {
      SymmetricTensor<2, dim> own;
      std::vector<SymmetricTensor<2, dim>> blocks;
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
      {
        SymmetricTensor<2, dim> block;
        if (system.friction)
          block += system.friction->pair_block(p);
        if (is_stiff())
          block += system.elasticity->pair_block(i, p);
        own += block;
        if (p < pairs.row_fixed[i])
          blocks.push_back(-1. * block);
      }
      blocks.insert(blocks.begin(), own);
      for (unsigned int c = 0; c < dim; ++c)
      {
        values.clear();
        for (unsigned int b = 0; b < blocks.size(); ++b)
          for (unsigned int e = 0; e < dim; ++e)
          {
            const bool is_diagonal = b == 0 && e == c;
            const unsigned int other = b == 0 ? i : pairs.j[pairs.row_start[i] + b - 1];
            const bool is_held = system.is_held(i, c) || (other < n && system.is_held(other, e));
            values.push_back(is_held && !is_diagonal ? 0. : blocks[b][c][e]);
          }
        compact.set(neighbours.equation[i] * dim + c, columns.size(), columns.data(), values.data(), false);
      }
    });
    compact.compress(dealii::VectorOperation::insert);
  }

  template class StepOperator<2>;
  template class StepOperator<3>;
} // namespace Stroma::Sph
