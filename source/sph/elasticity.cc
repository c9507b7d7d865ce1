#include <stroma/sph/elasticity.h>

#include "second_moment.h"

namespace Stroma::Sph
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  /// Fault of the gradient of linear velocities, norm of 2 V_i I - sum_j r (x) c over 2 V_i, from which on a particle has too few
  /// neighbours for a gradient to mend. However small a fault is, it is mended: where it is not, stresses have a torque.
  static constexpr double largest_fault = .5;

  template <int dim>
  Elasticity<dim>::Elasticity(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                              const std::vector<Constitution> &constitutions, const double stabilisation,
                              const bool is_corrected, const bool continues_pressure,
                              const Interfaces<dim> *const interfaces, DegradedShear<dim> *const degraded,
                              DegradedFriction<dim> *const degraded_friction)
    : pairs(pairs)
    , neighbours(neighbours)
    , constitutions(constitutions)
    , stabilisation(stabilisation)
    , is_corrected(is_corrected)
    , interfaces(interfaces)
    , degraded(degraded)
    , degraded_friction(degraded_friction)
    , walls(continues_pressure ? std::make_unique<WallPressure<dim>>(pairs, neighbours) : nullptr)
  {}

  template <int dim>
  void
  Elasticity<dim>::update(const ParticleSet<dim> &particles)
  {
    const unsigned int n = pairs.n_rows();
    summed.clear();
    for (auto *const values : {&volume, &G, &K, &mu, &hourglass_per_G, &G_now, &K_now})
      values->assign(n, 0.);
    inverse_moment.assign(n, {});
    correction.assign(is_corrected ? particles.size() : 0, {});
    stress.assign(pairs.n_points(), {});
    if (interfaces)
      gradient.assign(n, {});
    if (walls)
      {
        walls->update();
        K_of_state.assign(n, 0.);
        mean_stress.assign(pairs.n_points(), 0.);
      }
    if (has_hourglass_control())
      {
        a.assign(pairs.n_points(), 0.);
        aH.assign(pairs.n_points(), {});
      }
    for (unsigned int i = 0; i < n; ++i)
      {
        const Constitution &law = constitutions[particles.material_of(i)];
        volume[i]               = particles.volume(i) * (pairs.volume_share.empty() ? 1. : pairs.volume_share[i]);
        G[i]                    = law.G;
        K[i]                    = law.bulk_tangent(particles.J[i]);
        mu[i]                   = law.mu;
        if (is_corrected)
          set_correction(i);
      }
    neighbours.update_ghosts(correction);
    update_degradation();
    for (unsigned int i = 0; i < n && has_hourglass_control() && !degraded; ++i)
      set_hourglass_stiffness(i);
  }

  template <int dim>
  void
  Elasticity<dim>::set_correction(const unsigned int i)
  {
    correction[i] = dealii::unit_symmetric_tensor<dim>();
    Tensor<2, dim> sum; // 2 V_i on the diagonal for area vectors without fault
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
      sum += outer_product(pairs.r[p], pairs.c[p]);
    sum /= 2. * volume[i];
    const double fault = (sum - Tensor<2, dim>(dealii::unit_symmetric_tensor<dim>())).norm();
    if (fault < largest_fault || (interfaces && interfaces->touches(i)))
      correction[i] = invert(sum);
  }

  template <int dim>
  void
  Elasticity<dim>::set_hourglass_stiffness(const unsigned int i)
  {
    const auto             &P = weights();
    SymmetricTensor<2, dim> moment;
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
      add_moment(moment, P[p], pairs.r[p]);
    hourglass_per_G[i] = 0.;
    inverse_moment[i]  = 0.;
    if (!tells_gradient(moment))
      return;
    hourglass_per_G[i] = stabilisation * 4. * dim / 3. * volume[i] / trace(moment);
    inverse_moment[i]  = Tensor<2, dim>(invert(moment));
  }

  template <int dim>
  void
  Elasticity<dim>::combine(const double elastic, const double viscous) const
  {
    if (interfaces)
      interfaces->combine(elastic, viscous);
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      {
        G_now[i] = elastic * G[i] + viscous * mu[i];
        K_now[i] = elastic * K[i] + viscous * 5. / 3. * mu[i];
        if (walls)
          K_of_state[i] = elastic * K[i];
        if (has_hourglass_control())
          a[i] = hourglass_per_G[i] * G_now[i];
      }
    if (degraded)
      combine_degraded(elastic, viscous);
    neighbours.update_ghosts(a);
  }

  template <int dim>
  void
  Elasticity<dim>::update_degradation()
  {
    if (!degraded)
      return;
    summed.clear();
    degraded->update(volume);
    degraded_friction->update(volume, correction);
    for (unsigned int i = 0; i < pairs.n_rows() && has_hourglass_control(); ++i)
      set_hourglass_stiffness(i);
  }

  template <int dim>
  void
  Elasticity<dim>::combine_degraded(const double elastic, const double viscous) const
  {
    elastic_now = elastic;
    viscous_now = viscous;
    for (const unsigned int i : degraded->rows())
      {
        G_now[i] = viscous * mu[i];
        if (has_hourglass_control())
          a[i] = hourglass_per_G[i] * (elastic * degraded->least(i) * G[i] + viscous * mu[i]);
      }
  }

  template <int dim>
  void
  Elasticity<dim>::add_degraded_responses(const std::vector<Tensor<1, dim>> &u) const
  {
    const Tensor<2, dim> unit = dealii::unit_symmetric_tensor<dim>();
    for (const unsigned int i : degraded_friction->rows())
      stress[i] = conjugate(i, elastic_now * K[i] * trace(gradient_of_sum(i)) * unit);
    degraded_friction->add_responses(stress, u, viscous_now);
    for (const unsigned int i : degraded->rows())
      stress[i] += degraded->set_stress(i, deviatoric_rate(elastic_now * G[i], degraded->gradient(i, u)));
    degraded->exchange_stresses();
  }

  template <int dim>
  void
  Elasticity<dim>::velocity_gradient(std::vector<Tensor<2, dim>> &L, const std::vector<Tensor<1, dim>> &v) const
  {
    sum_differences(v);
    summed = v;
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      L[i] = gradient_of_sum(i);
    if (interfaces)
      interfaces->lift(L, v);
  }

  template <int dim>
  void
  Elasticity<dim>::add_wall_dilatation(std::vector<Tensor<2, dim>> &L, const std::vector<Tensor<1, dim>> &v) const
  {
    if (!walls)
      return;
    wall_dilatation.assign(pairs.n_rows(), 0.);
    walls->add_dilatation(wall_dilatation, v);
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        L[i][d][d] += wall_dilatation[i] / (dim * volume[i]);
  }

  template <int dim>
  void
  Elasticity<dim>::sum_differences(const std::vector<Tensor<1, dim>> &u) const
  {
    if (u == summed)
      return;
    summed.clear();
    if (has_hourglass_control())
      sum_differences<true>(u);
    else
      sum_differences<false>(u);
  }

  template <int dim>
  template <bool hourglass>
  void
  Elasticity<dim>::sum_differences(const std::vector<Tensor<1, dim>> &u) const
  {
    const auto *const j = pairs.j.data();
    const auto *const c = pairs.c.data();
    const auto *const r = pairs.r.data();
    const auto *const P = weights().data();
    const auto *const w = u.data();
    pairs.template sum_up<1>(sums, [=](const unsigned int i) {
      return [=, w_i = w[i]](const unsigned int p) {
        const auto w_ji = w[j[p]] - w_i;
        return Gradients{outer_product(w_ji, c[p]), hourglass ? outer_product(P[p] * w_ji, r[p]) : Tensor<2, dim>()};
      };
    });
  }

  template <int dim>
  void
  Elasticity<dim>::set_stresses(const std::vector<SymmetricTensor<2, dim>>       &stresses,
                                const std::vector<SymmetricTensor<2, dim>> *const shear) const
  {
    for (unsigned int i = 0; i < stresses.size(); ++i)
      {
        const Tensor<2, dim> sigma(stresses[i]);
        stress[i] = interfaces ? sigma : conjugate(i, sigma);
        if (walls)
          mean_stress[i] = trace(stresses[i]) / dim;
      }
    if (interfaces)
      {
        conjugate_stresses(false);
        neighbours.update_ghosts(stress);
      }
    if (degraded)
      {
        for (const unsigned int i : degraded->rows())
          stress[i] = conjugate(i, Tensor<2, dim>(stresses[i] - (*shear)[i])) + degraded->set_stress(i, (*shear)[i]);
        degraded->exchange_stresses();
        neighbours.update_ghosts(stress);
      }
  }

  template <int dim>
  void
  Elasticity<dim>::add_stress_force(std::vector<Tensor<1, dim>>                      &f,
                                    const std::vector<SymmetricTensor<2, dim>>       &stresses,
                                    const std::vector<SymmetricTensor<2, dim>> *const shear) const
  {
    set_stresses(stresses, shear);
    const auto *const j = pairs.j.data();
    const auto *const c = pairs.c.data();
    const auto *const s = stress.data();
    pairs.add_forces(f, [=](const unsigned int i) {
      return [=, s_i = s[i]](const unsigned int p) -> Tensor<1, dim> { return .5 * ((s_i + s[j[p]]) * c[p]); };
    });
    if (interfaces)
      interfaces->add_forces(f);
    if (degraded)
      degraded->add_force(f);
    remove_shear(f);
    if (walls)
      walls->add_force(f, mean_stress);
  }

  template <int dim>
  void
  Elasticity<dim>::set_increment(const std::vector<Tensor<1, dim>> &u) const
  {
    if (has_hourglass_control())
      set_responses<true>(u);
    else
      set_responses<false>(u);
  }

  template <int dim>
  void
  Elasticity<dim>::add_increment(const std::vector<Tensor<1, dim>> &u) const
  {
    Assert(has_hourglass_control() && !interfaces && !degraded && !walls, dealii::ExcInternalError());
    set_responses<true>(u, true);
  }

  template <int dim>
  void
  Elasticity<dim>::add_stiffness_force(std::vector<Tensor<1, dim>> &f, const std::vector<Tensor<1, dim>> &u) const
  {
    if (has_hourglass_control())
      add_stiffness_force<true>(f, u);
    else
      add_stiffness_force<false>(f, u);
  }

  template <int dim>
  template <bool hourglass>
  void
  Elasticity<dim>::add_stiffness_force(std::vector<Tensor<1, dim>> &f, const std::vector<Tensor<1, dim>> &u) const
  {
    set_responses<hourglass>(u);
    pairs.add_forces(f, rows_of_increment<hourglass>(u));
    if (interfaces)
      interfaces->add_forces(f);
    if (degraded)
      {
        degraded->add_force(f);
        degraded_friction->add_force(f);
      }
    remove_shear(f);
    if (walls)
      walls->add_force(f, mean_stress);
  }

  template <int dim>
  Tensor<2, dim>
  Elasticity<dim>::stress_of(const unsigned int i, const Tensor<2, dim> &L) const
  {
    const double   mean  = (K_now[i] - 2. / 3. * G_now[i]) * trace(L);
    Tensor<2, dim> sigma = G_now[i] * (L + transpose(L));
    for (unsigned int d = 0; d < dim; ++d)
      sigma[d][d] += mean;
    return sigma;
  }

  template <int dim>
  void
  Elasticity<dim>::remove_shear(std::vector<Tensor<1, dim>> &f) const
  {
    for (const auto &pair : pairs.touching)
      if (pair.slides)
        f[pair.i] += stress_force(pair.i, pair.p) - .5 * stress[pair.i] * pairs.c[pair.p];
  }

  template <int dim>
  template <bool hourglass>
  void
  Elasticity<dim>::set_responses(const std::vector<Tensor<1, dim>> &u, const bool onto_stresses) const
  {
    sum_differences(u);
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      {
        const auto L = gradient_of_sum(i);
        if constexpr (hourglass)
          aH[i] = a[i] * sums[i].H * inverse_moment[i];
        if (interfaces)
          gradient[i] = L;
        else
          stress[i] = conjugate(i, stress_of(i, L)) + (onto_stresses ? stress[i] : Tensor<2, dim>());
        if (walls)
          mean_stress[i] = K_of_state[i] * trace(L);
      }
    if (interfaces)
      {
        interfaces->lift(gradient, u);
        for (unsigned int i = 0; i < pairs.n_rows(); ++i)
          stress[i] = stress_of(i, gradient[i]);
        neighbours.update_ghosts(stress);
        conjugate_stresses(hourglass);
      }
    if (degraded)
      add_degraded_responses(u);
    if (walls)
      add_wall_responses(u);
    neighbours.update_ghosts(stress);
    neighbours.update_ghosts(aH);
  }

  /// With stresses in `stress`, ghosts included: makes them what forces come of, by Interfaces and B; of ghosts it is to follow.
  template <int dim>
  void
  Elasticity<dim>::conjugate_stresses(const bool of_jumps) const
  {
    interfaces->set_forces(&stress, of_jumps);
    interfaces->add_moments(stress);
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      stress[i] = conjugate(i, stress[i]);
  }

  template <int dim>
  void
  Elasticity<dim>::add_wall_responses(const std::vector<Tensor<1, dim>> &u) const
  {
    wall_dilatation.assign(pairs.n_rows(), 0.);
    walls->add_dilatation(wall_dilatation, u);
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      {
        if (wall_dilatation[i] == 0.)
          continue;
        const double m = K_of_state[i] * wall_dilatation[i] / volume[i];
        mean_stress[i] += m;
        stress[i] += conjugate(i, m * dealii::unit_symmetric_tensor<dim>());
      }
    neighbours.update_ghosts(mean_stress);
  }

  template <int dim>
  Tensor<1, dim>
  Elasticity<dim>::hourglass_pair_force(const unsigned int i, const std::size_t p,
                                        const std::vector<Tensor<1, dim>> &u) const
  {
    const unsigned int j = pairs.j[p];
    return weights()[p] * ((a[i] + a[j]) * (u[j] - u[i]) - (aH[i] + aH[j]) * pairs.r[p]);
  }

  template <int dim>
  Tensor<1, dim>
  Elasticity<dim>::pair_force(const unsigned int i, const std::size_t p, const std::vector<Tensor<1, dim>> &u) const
  {
    auto force = stress_force(i, p);
    if (degraded)
      force += degraded_friction->pair_force(i, p);
    return has_hourglass_control() ? force + hourglass_pair_force(i, p, u) : force;
  }

  template <int dim>
  SymmetricTensor<2, dim>
  Elasticity<dim>::pair_block(const unsigned int i, const std::size_t p) const
  {
    if (interfaces && pairs.P[p] == 0. && !pairs.meets_wall_point(p))
      return interfaces->pair_block(i, p);
    const unsigned int j   = pairs.j[p];
    const bool         row = j < pairs.n_rows(); // other ranks' moduli are not known here; this only preconditions
    const double       G_i = G_of(i), G_p = .5 * (G_i + (row ? G_of(j) : G_i));
    const double       K_p = .5 * (K_now[i] + (row ? K_now[j] : K_now[i]));
    const double       B   = .5 * (K_p + G_p / 3.);
    const auto        &r   = pairs.r[p];
    if (pairs.has_facets() && pairs.meets_wall_point(p))
      return facet_block(i, p);
    // Friction of viscosity mu has pairs of weight 2 mu P: so have moduli.
    const double weight = pairs.P[p] > 0. ? pairs.P[p] : pairs.c[p] * r / (2. * r.norm_square());
    return 2. * weight *
           (std::max(G_p - B, .1 * G_p) * dealii::unit_symmetric_tensor<dim>() +
            (dim + 2) * B / r.norm_square() * symmetrize(outer_product(r, r)));
  }

  /// Twice what a motion of all particles before the wall costs by this pair. Measured, pillars of 1e-4 m: with once that solves take 8 % more
  /// iterations, with four times it as many, with what other pairs have 60 % more.
  template <int dim>
  SymmetricTensor<2, dim>
  Elasticity<dim>::facet_block(const unsigned int i, const std::size_t p) const
  {
    const auto  &c     = pairs.c[p];
    const auto   unit  = dealii::unit_symmetric_tensor<dim>();
    const double G_i   = G_of(i);
    auto         block = 1. / (2. * volume[i]) *
                 ((K_now[i] + G_i / 3.) * symmetrize(outer_product(c, c)) + G_i * c.norm_square() * unit);
    if (has_hourglass_control())
      block += pairs.P[p] * a[i] * unit;
    return block;
  }

  template <int dim>
  typename Elasticity<dim>::Row
  Elasticity<dim>::row(const unsigned int i) const
  {
    const auto none = Tensor<2, dim>(dealii::unit_symmetric_tensor<dim>());
    return {volume[i],
            G_of(i),
            K_now[i],
            has_hourglass_control() ? a[i] : 0.,
            correction.empty() ? none : correction[i],
            inverse_moment[i]};
  }

  template <int dim>
  void
  Elasticity<dim>::add_diagonal(std::vector<SymmetricTensor<2, dim>> &blocks) const
  {
    if (interfaces)
      interfaces->add_diagonal(blocks);
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
        {
          const unsigned int j      = pairs.j[p];
          const auto        &c      = pairs.c[p];
          const bool         is_row = j < pairs.n_rows();
          // u_i enters L_j as -c_ji u_i/(2 V_j); the part of its own gradient is small, as c_ij nearly cancel in the sum.
          const double V   = is_row ? volume[j] : volume[i];
          const double G_j = G_of(is_row ? j : i), K_j = is_row ? K_now[j] : K_now[i];
          blocks[i] += 1. / (4. * V) *
                       ((K_j + G_j / 3.) * symmetrize(outer_product(c, c)) +
                        G_j * c.norm_square() * dealii::unit_symmetric_tensor<dim>());
          if (has_hourglass_control())
            blocks[i] += weights()[p] * (a[i] + a[j]) * dealii::unit_symmetric_tensor<dim>();
        }
  }

  template class Elasticity<2>;
  template class Elasticity<3>;
} // namespace Stroma::Sph
