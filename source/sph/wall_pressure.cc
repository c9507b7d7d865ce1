#include <stroma/sph/wall_pressure.h>

#include <algorithm>

namespace Stroma::Sph
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  /// Determinant of the second moment over that of an even one of the same trace, below which there is no gradient.
  static constexpr double least_determinant = 1e-3;

  template <int dim>
  void
  WallPressure<dim>::update(const unsigned int n)
  {
    std::vector<std::uint8_t> is_at_wall(n);
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
      is_at_wall[i] = sees_wall(i);
    neighbours.update_ghosts(is_at_wall);
    rows.clear();
    inverse_moment.clear();
    gradient.assign(n, {});
    at_wall.assign(neighbours.n_free(), {});
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
    {
      const auto first = pairs.j.begin() + pairs.row_start[i], last = pairs.j.begin() + pairs.row_fixed[i];
      if (is_at_wall[i] || std::any_of(first, last, [&](const unsigned int j) { return is_at_wall[j]; }))
        set_inverse_moment(i);
    }
  }

  template <int dim>
  void
  WallPressure<dim>::set_inverse_moment(const unsigned int i)
  {
    SymmetricTensor<2, dim> moment;
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
      moment += pairs.P[p] * symmetrize(outer_product(pairs.r[p], pairs.r[p]));
    const bool is_regular = determinant(moment) > least_determinant * std::pow(trace(moment) / dim, dim);
    rows.push_back(i);
    inverse_moment.push_back(is_regular ? Tensor<2, dim>(invert(moment)) : Tensor<2, dim>());
  }

  template <int dim>
  void
  WallPressure<dim>::add_force(std::vector<Tensor<1, dim>> &f, const std::vector<SymmetricTensor<2, dim>> &stresses)
  {
    const auto pressure = [&](const unsigned int i) { return -trace(stresses[i]) / dim; };
    for (unsigned int k = 0; k < rows.size(); ++k)
    {
      const unsigned int i = rows[k];
      const double       p_i = pressure(i);
      Tensor<1, dim>     sum;
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
        sum += pairs.P[p] * (pressure(pairs.j[p]) - p_i) * pairs.r[p];
      gradient[i] = inverse_moment[k] * sum;
    }
    neighbours.update_ghosts(gradient);
    for (const unsigned int i : rows)
    {
      if (!sees_wall(i))
        continue;
      Tensor<1, dim> sum;
      double         weight = 0.;
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
      {
        sum += pairs.P[p] * gradient[pairs.j[p]];
        weight += pairs.P[p];
      }
      at_wall[i] = weight > 0. ? sum / weight : sum;
      for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
        f[i] += pair_force(i, p);
    }
  }

  template class WallPressure<2>;
  template class WallPressure<3>;
} // namespace Stroma::Sph
