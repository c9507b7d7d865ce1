#include <stroma/sph/hourglass_control.h>

#include <deal.II/base/mpi.h>

#include <array>

#include "second_moment.h"

namespace Stroma::Sph
{
  using dealii::Tensor;

  /// Of the length of a pair since the start, either way: beyond it the two are no neighbours of then.
  static constexpr double largest_change = 2.;

  template <int dim>
  HourglassControl<dim>::HourglassControl(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                                          const Elasticity<dim> &elasticity, const Interfaces<dim> *const interfaces)
    : pairs(pairs)
    , neighbours(neighbours)
    , elasticity(elasticity)
    , interfaces(interfaces)
  {
    for (unsigned int d = 0; d < dim; ++d)
      repeats = repeats || neighbours.is_periodic(d);
  }

  template <int dim>
  void
  HourglassControl<dim>::update(const ParticleSet<dim> &particles, const OfWalls &of_walls)
  {
    const unsigned int n = pairs.n_rows();
    X.resize(pairs.n_pairs());
    P.resize(pairs.n_pairs());
    wall_start.resize(pairs.walls.size());
    inverse_moment.assign(n, {});
    a.assign(pairs.n_points(), 0.);
    H.assign(particles.size(), {});
    aH.assign(pairs.n_points(), {});
    for (unsigned int i = 0; i < n; ++i)
      {
        dealii::SymmetricTensor<2, dim> moment;
        const auto                     &X_i = particles.X[i];
        for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
          {
            const bool is_plain = !repeats && !pairs.meets_wall_point(p);
            X[p]                = is_plain ? particles.X[pairs.j[p]] - X_i : undeformed(particles, of_walls, i, p);
            P[p]                = keeps(p) ? pairs.P[p] : 0.;
            add_moment(moment, P[p], X[p]);
          }
        if (!tells_gradient(moment))
          continue;
        inverse_moment[i] = Tensor<2, dim>(invert(moment));
      }
    set_stiffness();
    across.clear();
    if (interfaces)
      for (const auto &pair : interfaces->pairs_across())
        across.push_back(keeps(pair.p) ? interfaces->hourglass_stiffness(pair) : 0.);
  }

  template <int dim>
  bool
  HourglassControl<dim>::knows_start(const unsigned int i, const std::vector<Vector> &u) const
  {
    if (!pairs.in_touch.empty() && pairs.in_touch[i] != 0)
      return false;
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
      {
        const auto moved = pairs.r[p] - X[p]; // not so by u where something has gone far across periodic faces
        if (!keeps(p) || (u[pairs.j[p]] - u[i] - moved).norm_square() > .01 * X[p].norm_square())
          return false;
      }
    return true;
  }

  template <int dim>
  void
  HourglassControl<dim>::set_stiffness()
  {
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      a[i] = inverse_moment[i] == Tensor<2, dim>() ? 0. : elasticity.hourglass_stiffness(i);
    neighbours.update_ghosts(a);
  }

  template <int dim>
  bool
  HourglassControl<dim>::keeps(const std::size_t p) const
  {
    const double now = pairs.r[p].norm_square(), then = X[p].norm_square();
    const double most = largest_change * largest_change;
    return now <= most * then && then <= most * now;
  }

  template <int dim>
  double
  HourglassControl<dim>::share_apart() const
  {
    std::array<double, 2> rows{}; // apart, and all
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
      if (a[i] > 0.)
        {
          rows[0] += has_come_apart(i);
          ++rows[1];
        }
    const dealii::ArrayView<double> all(rows.data(), rows.size());
    dealii::Utilities::MPI::sum(dealii::ArrayView<const double>(all), neighbours.communicator(), all);
    return rows[1] > 0. ? rows[0] / rows[1] : 0.;
  }

  template <int dim>
  bool
  HourglassControl<dim>::has_come_apart(const unsigned int i) const
  {
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
      if (pairs.r[p].norm_square() > largest_change * largest_change * X[p].norm_square() && a[pairs.j[p]] > 0.)
        return true;
    return false;
  }

  /// X_ij of pair @p p of row @p i. Of wall points, it sets where they were at the start; where that is not known, 0.
  template <int dim>
  Tensor<1, dim>
  HourglassControl<dim>::undeformed(const ParticleSet<dim> &particles, const OfWalls &of_walls, const unsigned int i,
                                    const std::size_t p)
  {
    const unsigned int j   = pairs.j[p];
    const auto        &X_i = particles.X[i];
    if (!pairs.meets_wall_point(p))
      return neighbours.image_near(particles.X[j], X_i + pairs.r[p]) - X_i;
    const unsigned int w = j - particles.size();
    if (!of_walls[w])
      return {};
    wall_start[w] = particles.x[i] + pairs.r[p] - *of_walls[w];
    return neighbours.image_near(wall_start[w], X_i) - X_i;
  }

  template <int dim>
  void
  HourglassControl<dim>::place(const ParticleSet<dim> &particles, const OfWalls &of_walls)
  {
    x.assign(particles.x.begin(), particles.x.end());
    for (unsigned int w = 0; w < of_walls.size(); ++w)
      x.push_back(of_walls[w] ? wall_start[w] + *of_walls[w] : dealii::Point<dim>());
  }

  template <int dim>
  void
  HourglassControl<dim>::find_forces(const ParticleSet<dim> &particles, const OfWalls &of_walls)
  {
    place(particles, of_walls);
    const auto *const j    = pairs.j.data();
    const auto *const X_of = X.data();
    const auto *const P_of = P.data();
    const auto *const x_of = x.data();
    pairs.template sum_up<1>(sums, [=](const unsigned int i) {
      return [=, x_i = x_of[i]](const unsigned int p) {
        return outer_product(P_of[p] * (x_of[j[p]] - x_i - X_of[p]), X_of[p]);
      };
    });
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      {
        H[i]  = sums[i] * inverse_moment[i];
        aH[i] = a[i] * H[i];
      }
    if (interfaces)
      add_jumps();
    neighbours.update_ghosts(aH);
  }

  template <int dim>
  void
  HourglassControl<dim>::add_jumps()
  {
    neighbours.update_ghosts(H);
    jumps.clear();
    for (const auto &pair : interfaces->pairs_across())
      {
        const auto &X_ij = X[pair.p];
        jumps.push_back(stretch(pair.i, pair.p) - (pair.theta * H[pair.i] + (1. - pair.theta) * H[pair.j]) * X_ij);
        aH[pair.i] += pair.theta * across[jumps.size() - 1] * outer_product(jumps.back(), X_ij) *
                      inverse_moment[pair.i];
      }
  }

  template <int dim>
  void
  HourglassControl<dim>::add_forces(std::vector<Tensor<1, dim>> &f) const
  {
    pairs.add_forces(f, rows());
    for (unsigned int q = 0; q < jumps.size(); ++q)
      f[interfaces->pairs_across()[q].i] += across[q] * jumps[q];
  }

  template <int dim>
  double
  HourglassControl<dim>::energy() const
  {
    double sum = 0.;
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
        sum += .5 * a[i] * P[p] * (stretch(i, p) - H[i] * X[p]).norm_square();
    for (unsigned int q = 0; q < jumps.size(); ++q) // each stands in both rows
      sum += .25 * across[q] * jumps[q].norm_square();
    return sum;
  }

  template class HourglassControl<2>;
  template class HourglassControl<3>;
} // namespace Stroma::Sph
