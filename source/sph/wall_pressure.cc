#include <stroma/sph/wall_pressure.h>

#include <algorithm>

#include "second_moment.h"

namespace Stroma::Sph
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  template <int dim>
  void
  WallPressure<dim>::update()
  {
    std::vector<std::uint8_t> is_at_wall(pairs.n_points());
    at_wall.clear();
    near_wall.clear();
    inverse_moment.assign(neighbours.n_free(), {});
    y.assign(pairs.n_points(), {});
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
      if (sees_wall(i))
        {
          is_at_wall[i] = 1;
          at_wall.push_back(i);
          set_inverse_moment(i);
        }
    neighbours.update_ghosts(is_at_wall);
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
      {
        const auto first = pairs.j.begin() + pairs.row_start[i], last = pairs.j.begin() + pairs.row_fixed[i];
        if (is_at_wall[i] || std::any_of(first, last, [&](const unsigned int j) { return is_at_wall[j]; }))
          near_wall.push_back(i);
      }
  }

  template <int dim>
  void
  WallPressure<dim>::set_inverse_moment(const unsigned int i)
  {
    SymmetricTensor<2, dim> moment;
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
      moment += pairs.P[p] * symmetrize(outer_product(pairs.r[p], pairs.r[p]));
    if (tells_gradient(moment))
      inverse_moment[i] = Tensor<2, dim>(invert(moment));
  }

  template <int dim>
  void
  WallPressure<dim>::add_dilatation(std::vector<double> &values, const std::vector<Tensor<1, dim>> &v) const
  {
    for (const unsigned int i : at_wall)
      {
        Tensor<1, dim> sum;
        for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
          sum += ((v[i] - v[pairs.j[p]]) * pairs.c[p]) * pairs.r[p];
        y[i] = -.5 * inverse_moment[i] * sum;
      }
    neighbours.update_ghosts(y);
    for (const unsigned int i : near_wall)
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
        values[i] -= pairs.P[p] * ((y[i] + y[pairs.j[p]]) * pairs.r[p]);
  }

  template <int dim>
  Tensor<1, dim>
  WallPressure<dim>::gradient(const unsigned int i, const std::vector<double> &m) const
  {
    Tensor<1, dim> sum;
    if (sees_wall(i))
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
        sum += pairs.P[p] * (m[pairs.j[p]] - m[i]) * pairs.r[p];
    return inverse_moment[i] * sum;
  }

  template <int dim>
  void
  WallPressure<dim>::add_force(std::vector<Tensor<1, dim>> &f, const std::vector<double> &m) const
  {
    for (const unsigned int i : at_wall)
      {
        const auto g = gradient(i, m);
        for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
          f[i] += pair_force(p, g);
      }
  }

  template class WallPressure<2>;
  template class WallPressure<3>;
} // namespace Stroma::Sph
