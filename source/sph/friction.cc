#include <stroma/sph/friction.h>

namespace Stroma::Sph
{
  using dealii::Tensor;

  template <int dim>
  Friction<dim>::Friction(const Pairs<dim> &pairs, const std::vector<Constitution> &constitutions,
                          const Materials::ViscousOperator form)
    : pairs(pairs)
    , constitutions(constitutions)
    , form(form)
  {}

  template <int dim>
  void
  Friction<dim>::update(const ParticleSet<dim> &particles)
  {
    const bool central = form == Materials::ViscousOperator::central;
    k.resize(pairs.n_pairs());
    k_along.assign(pairs.has_segments() ? pairs.walls.size() : 0, 0.);
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      {
        const double mu_i = constitutions[particles.material_of(i)].mu;
        for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
          {
            const double mu_j = p < pairs.row_fixed[i] ? constitutions[particles.material_of(pairs.j[p])].mu : mu_i;
            k[p]              = (mu_i + mu_j) * pairs.friction[p];
            if (central)
              k[p] *= (dim + 2) / pairs.r[p].norm_square();
            if (meets_segment(p))
              {
                k_along[pairs.j[p] - pairs.first_wall_point()] = 2. * mu_i * pairs.friction[p];
                k[p]                                           = 0.;
              }
          }
      }
  }

  template <int dim>
  Tensor<1, dim>
  Friction<dim>::pair_force(const std::size_t p, const Tensor<1, dim> &v_ji) const
  {
    if (meets_segment(p))
      return k_along[pairs.j[p] - pairs.first_wall_point()] * (v_ji - pairs.along_normal(p, v_ji));
    if (form == Materials::ViscousOperator::central)
      return k[p] * (pairs.r[p] * v_ji) * pairs.r[p];
    return k[p] * v_ji;
  }

  template <int dim>
  void
  Friction<dim>::add_force(std::vector<Tensor<1, dim>> &f, const std::vector<Tensor<1, dim>> &v) const
  {
    const auto *const j      = pairs.j.data();
    const auto *const r      = pairs.r.data();
    const auto *const weight = k.data();
    const auto *const w      = v.data();
    if (form == Materials::ViscousOperator::central)
      pairs.add_forces(f, [=](const unsigned int i) {
        return [=, w_i = w[i]](const unsigned int p) -> Tensor<1, dim> {
          return weight[p] * (r[p] * (w[j[p]] - w_i)) * r[p];
        };
      });
    else
      pairs.add_forces(f, [=](const unsigned int i) {
        return [=, w_i = w[i]](const unsigned int p) -> Tensor<1, dim> { return weight[p] * (w[j[p]] - w_i); };
      });
    for (unsigned int i = 0; i < f.size() && !k_along.empty(); ++i)
      for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
        if (meets_segment(p))
          f[i] += pair_force(p, v[pairs.j[p]] - v[i]);
  }

  template <int dim>
  dealii::SymmetricTensor<2, dim>
  Friction<dim>::pair_block(const std::size_t p) const
  {
    if (meets_segment(p))
      {
        const auto &n = pairs.wall(p).normal;
        return k_along[pairs.j[p] - pairs.first_wall_point()] *
               (dealii::unit_symmetric_tensor<dim>() - symmetrize(outer_product(n, n)));
      }
    if (form == Materials::ViscousOperator::central)
      return k[p] * symmetrize(outer_product(pairs.r[p], pairs.r[p]));
    return k[p] * dealii::unit_symmetric_tensor<dim>();
  }

  template <int dim>
  void
  Friction<dim>::add_diagonal(std::vector<dealii::SymmetricTensor<2, dim>> &blocks, const unsigned int n) const
  {
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
        blocks[i] += pair_block(p);
  }

  template class Friction<2>;
  template class Friction<3>;
} // namespace Stroma::Sph
