#include <stroma/sph/degraded_shear.h>

#include "second_moment.h"

#include <algorithm>

namespace Stroma::Sph
{
  using dealii::Tensor;

  /// Second moment of neighbours, weighted with their factors, over f_i times that of whole matter, from which on it tells a gradient: an
  /// edge of a straight interface with a fluid has .5, a corner .35.
  static constexpr double least_share = .15;

  template <int dim>
  DegradedShear<dim>::DegradedShear(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                                    const ParticleSet<dim> &particles, std::vector<bool> degrading)
    : pairs(pairs)
    , neighbours(neighbours)
    , particles(particles)
    , degrading(std::move(degrading))
  {}

  template <int dim>
  void
  DegradedShear<dim>::update(const std::vector<double> &volume)
  {
    touched.clear();
    number.assign(pairs.n_rows(), none);
    for (auto *const values : {&least_of, &share_of})
      values->clear();
    for (auto *const values : {&correction, &conjugate, &L})
      values->clear();
    stress.assign(pairs.n_points(), {});
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      {
        const double least = find_least(i);
        if (least == 1.)
          continue;
        number[i] = touched.size();
        touched.push_back(i);
        least_of.push_back(least);
        set_row(i, volume[i]);
      }
    L.resize(touched.size());
  }

  template <int dim>
  double
  DegradedShear<dim>::find_least(const unsigned int i) const
  {
    double least = particles.intact[i];
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
      least = std::min(least, particles.intact[pairs.j[p]]);
    for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
      if (degrading[pairs.mover(particles, p)])
        least = 0.;
    return least;
  }

  template <int dim>
  void
  DegradedShear<dim>::set_row(const unsigned int i, const double volume)
  {
    Tensor<2, dim> M;
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
      M += factor(pairs.j[p]) / (2. * volume) * outer_product(pairs.r[p], pairs.c[p]);
    const double f = particles.intact[i];
    // Too few solid neighbours, or all in a line, have no gradient: no shear then.
    const bool tells = trace(M) > least_share * dim * f && tells_gradient(M);
    const auto B     = tells ? f * invert(M) : Tensor<2, dim>();
    conjugate.push_back(B);
    correction.push_back(f / (2. * volume) * B);
    share_of.push_back(tells ? std::pow(f, 4) : 0.);
  }

  template <int dim>
  Tensor<2, dim>
  DegradedShear<dim>::gradient(const unsigned int i, const Vectors &v) const
  {
    Tensor<2, dim> sum;
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
      sum += factor(pairs.j[p]) * outer_product(v[pairs.j[p]] - v[i], pairs.c[p]);
    return sum * correction[number[i]];
  }

  template <int dim>
  void
  DegradedShear<dim>::set_gradients(const Vectors &v)
  {
    for (unsigned int k = 0; k < touched.size(); ++k)
      L[k] = gradient(touched[k], v);
  }

  template <int dim>
  Tensor<2, dim>
  DegradedShear<dim>::set_stress(const unsigned int i, const dealii::SymmetricTensor<2, dim> &S) const
  {
    stress[i] = Tensor<2, dim>(S) * transpose(conjugate[number[i]]);
    return stress[i];
  }

  template <int dim>
  void
  DegradedShear<dim>::exchange_stresses() const
  {
    neighbours.update_ghosts(stress);
  }

  template <int dim>
  Tensor<1, dim>
  DegradedShear<dim>::pair_force(const unsigned int i, const std::size_t p) const
  {
    const unsigned int j = pairs.j[p];
    return -.5 * (1. - particles.intact[i] * factor(j)) * ((stress[i] + stress[j]) * pairs.c[p]);
  }

  template <int dim>
  void
  DegradedShear<dim>::add_force(Vectors &f) const
  {
    for (const unsigned int i : touched)
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
        f[i] += pair_force(i, p);
  }

  template class DegradedShear<2>;
  template class DegradedShear<3>;
} // namespace Stroma::Sph
