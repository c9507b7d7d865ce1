#include <stroma/sph/degraded_friction.h>

#include "second_moment.h"

#include <algorithm>

namespace Stroma::Sph
{
  using dealii::Tensor;

  /// Share of the second moment that the own side of an interface must have to tell a gradient: an edge of a straight one has .5,
  /// a corner .35.
  static constexpr double least_own_share = .15;

  template <int dim>
  DegradedFriction<dim>::DegradedFriction(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                                          const ParticleSet<dim> &particles, const double mu)
    : pairs(pairs)
    , neighbours(neighbours)
    , particles(particles)
    , mu(mu)
  {}

  template <int dim>
  void
  DegradedFriction<dim>::update(const std::vector<double> &volumes, const Tensors &correction)
  {
    find_lone(volumes);
    touched.clear();
    volume.clear();
    own.clear();
    whole.clear();
    weight = pairs.P;
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      {
        bool differs = false;
        for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
          if (const double w = difference(i, p); w != 0.)
            {
              differs = true;
              weight[p] *= 1. - std::abs(w);
            }
        if (differs)
          add_row(i, volumes[i], correction[i]);
      }
    for (auto *const values : {&N, &traction, &Q})
      values->assign(particles.size(), {});
    L.resize(touched.size());
    tau.resize(touched.size());
  }

  /// Solids whose own side has too few neighbours to tell a gradient, or all in a line: they belong to the fluid.
  template <int dim>
  void
  DegradedFriction<dim>::find_lone(const std::vector<double> &volumes)
  {
    lone.assign(particles.size(), 0);
    std::vector<std::uint8_t> found(particles.size(), 0);
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      if (is_more_solid(i))
        {
          const Tensor<2, dim> M = own_moment(i, volumes[i]);
          found[i]               = trace(M) <= least_own_share * dim || !tells_gradient(M);
        }
    neighbours.update_ghosts(found);
    lone = std::move(found);
  }

  template <int dim>
  bool
  DegradedFriction<dim>::is_more_solid(const unsigned int i) const
  {
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
      if (difference(i, p) < 0.)
        return true;
    return false;
  }

  /// Second moment of the own side of row @p i, of volume @p V.
  template <int dim>
  Tensor<2, dim>
  DegradedFriction<dim>::own_moment(const unsigned int i, const double V) const
  {
    Tensor<2, dim> M;
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
      M += (1. - std::max(-difference(i, p), 0.)) / (2. * V) * outer_product(pairs.r[p], pairs.c[p]);
    return M;
  }

  template <int dim>
  void
  DegradedFriction<dim>::add_row(const unsigned int i, const double V, const Tensor<2, dim> &B)
  {
    touched.push_back(i);
    volume.push_back(V);
    whole.push_back(B);
    own.push_back(is_more_solid(i) ? invert(own_moment(i, V)) : B);
  }

  template <int dim>
  Tensor<2, dim>
  DegradedFriction<dim>::own_gradient(const unsigned int k, const Vectors &v) const
  {
    const unsigned int i = touched[k];
    Tensor<2, dim>     sum;
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
      sum += (1. - std::max(-difference(i, p), 0.)) * outer_product(v[pairs.j[p]] - v[i], pairs.c[p]);
    return sum * own[k] / (2. * volume[k]);
  }

  template <int dim>
  Tensor<2, dim>
  DegradedFriction<dim>::beyond_interface(const unsigned int k, const Vectors &v) const
  {
    const unsigned int i = touched[k];
    Tensor<2, dim>     sum;
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
      if (const double w = difference(i, p); w > 0.)
        {
          const unsigned int j = pairs.j[p];
          sum += outer_product(w * (v[j] - v[i] - N[j] * pairs.r[p]), pairs.c[p]);
        }
    return sum * whole[k] / (2. * volume[k]);
  }

  /// What tractions of less solid neighbours do to N.
  template <int dim>
  Tensor<2, dim>
  DegradedFriction<dim>::moment(const unsigned int k) const
  {
    const unsigned int i = touched[k];
    Tensor<2, dim>     sum;
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
      if (const double w = difference(i, p); w < 0.)
        sum += outer_product(w * (traction[pairs.j[p]] * pairs.c[p]), pairs.r[p]);
    return sum / (2. * volume[k]);
  }

  template <int dim>
  void
  DegradedFriction<dim>::add_responses(Tensors &stress, const Vectors &v, const double viscous) const
  {
    for (unsigned int k = 0; k < touched.size(); ++k)
      N[touched[k]] = own_gradient(k, v);
    neighbours.update_ghosts(N);
    for (unsigned int k = 0; k < touched.size(); ++k)
      {
        L[k]   = N[touched[k]] + beyond_interface(k, v);
        tau[k] = viscous * mu *
                 (L[k] + transpose(L[k]) + trace(L[k]) * Tensor<2, dim>(dealii::unit_symmetric_tensor<dim>()));
        traction[touched[k]] = tau[k] * transpose(whole[k]);
      }
    neighbours.update_ghosts(traction);
    for (unsigned int k = 0; k < touched.size(); ++k)
      {
        Q[touched[k]] = (tau[k] + moment(k)) * transpose(own[k]);
        stress[touched[k]] += Q[touched[k]];
      }
    neighbours.update_ghosts(Q);
  }

  template <int dim>
  Tensor<1, dim>
  DegradedFriction<dim>::pair_force(const unsigned int i, const std::size_t p) const
  {
    const double w = difference(i, p);
    if (w == 0.)
      return {};
    const unsigned int j = pairs.j[p];
    return .5 * std::abs(w) * ((w > 0. ? traction[i] - Q[j] : traction[j] - Q[i]) * pairs.c[p]);
  }

  template <int dim>
  void
  DegradedFriction<dim>::add_force(Vectors &f) const
  {
    for (const unsigned int i : touched)
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
        f[i] += pair_force(i, p);
  }

  template class DegradedFriction<2>;
  template class DegradedFriction<3>;
} // namespace Stroma::Sph
