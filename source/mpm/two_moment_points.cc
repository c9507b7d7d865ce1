#include <stroma/base/power.h>
#include <stroma/mpm/two_moment_points.h>

#include <cmath>

namespace Stroma::Mpm
{
  namespace
  {
    /// L of C = L L^T, lower triangular; zero columns where points do not spread.
    template <int dim>
    dealii::Tensor<2, dim>
    cholesky_factor(const dealii::SymmetricTensor<2, dim> &C)
    {
      dealii::Tensor<2, dim> L;
      for (unsigned int j = 0; j < dim; ++j)
        for (unsigned int i = j; i < dim; ++i)
          {
            double rest = C[i][j];
            for (unsigned int k = 0; k < j; ++k)
              rest -= L[i][k] * L[j][k];
            if (i == j)
              L[j][j] = rest > 1e-14 * C[j][j] ? std::sqrt(rest) : 0.;
            else
              L[i][j] = L[j][j] > 0. ? rest / L[j][j] : 0.;
          }
      return L;
    }
  } // namespace

  template <int dim>
  std::vector<Solid::Moments<dim>>
  cell_moments(const Points<dim> &points, const ActiveCell<dim> &active, const dealii::Tensor<1, dim> &size,
               const unsigned int n_materials)
  {
    std::vector<Solid::Moments<dim>> moments(n_materials);
    points.for_points_of(active, [&](const dealii::Point<dim> &xi, const auto &, const unsigned int m, const double V) {
      dealii::Tensor<1, dim> x;
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = (xi[d] - .5) * size[d];
      moments[m].add(V, x);
    });
    return moments;
  }

  template <int dim>
  void
  TwoMomentPoints<dim>::add_points_of(const Points<dim> &points, const ActiveCell<dim> &active,
                                      const unsigned int material)
  {
    points.for_points_of(active, [&](const auto &place, const auto &, const unsigned int m, const double volume) {
      if (m != material)
        return;
      xi.push_back(place);
      V.push_back(volume);
    });
  }

  template <int dim>
  void
  TwoMomentPoints<dim>::add_standing_for(const Solid::Moments<dim> &moments, const dealii::Tensor<1, dim> &size)
  {
    constexpr unsigned int n = power(2, dim);
    const auto             c = moments.centroid();
    const auto             L = cholesky_factor<dim>(moments.covariance());
    for (unsigned int corner = 0; corner < n; ++corner)
      {
        dealii::Tensor<1, dim> s;
        for (unsigned int d = 0; d < dim; ++d)
          s[d] = corner >> d & 1 ? 1. : -1.;
        const auto         x = c + L * s;
        dealii::Point<dim> place;
        for (unsigned int d = 0; d < dim; ++d)
          place[d] = .5 + x[d] / size[d];
        xi.push_back(place);
        V.push_back(moments.volume() / n);
      }
  }

  template <int dim>
  void
  TwoMomentPoints<dim>::clear()
  {
    *this = TwoMomentPoints();
  }

  template <int dim>
  void
  TwoMomentPoints<dim>::add_cell(const Points<dim> &points, const ActiveCell<dim> &active,
                                 const std::vector<Solid::Moments<dim>> &moments, const dealii::Tensor<1, dim> &size)
  {
    if (first_part.empty())
      first_part.push_back(0);
    for (unsigned int m = 0; m < moments.size(); ++m)
      if (moments[m].n_points() > 0)
        {
          const unsigned int begin = xi.size();
          const bool         fewer = moments[m].n_points() > power(2, dim);
          if (fewer)
            add_standing_for(moments[m], size);
          else
            add_points_of(points, active, m);
          any_fewer |= fewer;
          parts.push_back({m, begin, static_cast<unsigned int>(xi.size()), moments[m].n_points()});
        }
    first_part.push_back(parts.size());
  }

  template <int dim>
  void
  TwoMomentPoints<dim>::finish(const Points<dim> &points)
  {
    if (!any_fewer && !points.are_found_in_images()) // the points themselves will do
      clear();
  }

  template std::vector<Solid::Moments<2>> cell_moments(const Points<2> &, const ActiveCell<2> &,
                                                       const dealii::Tensor<1, 2> &, unsigned int);
  template std::vector<Solid::Moments<3>> cell_moments(const Points<3> &, const ActiveCell<3> &,
                                                       const dealii::Tensor<1, 3> &, unsigned int);
  template class TwoMomentPoints<2>;
  template class TwoMomentPoints<3>;
} // namespace Stroma::Mpm
