#include <stroma/mpm/covered_moments.h>
#include <stroma/mpm/point_weights.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <numeric>

namespace Stroma::Mpm
{
  namespace
  {
    template <int dim>
    constexpr unsigned int n_first = 1 << dim;

    /// Products of first powers only.
    template <int dim>
    using FirstMoments = Eigen::Matrix<double, n_first<dim>, 1>;

    template <int dim>
    FirstMoments<dim>
    first_of(const CellMoments<dim> &all)
    {
      FirstMoments<dim> first;
      for (unsigned int k = 0; k < n_first<dim>; ++k)
        {
          unsigned int in_all = 0;
          for (unsigned int d = 0; d < dim; ++d)
            in_all += (k >> d & 1) * power(3, d);
          first[k] = all[in_all];
        }
      return first;
    }

    /// The weights of the points of a cell, from their volumes, monomials and the moments that they should have.
    template <int dim>
    void
    fit(const std::vector<double> &v, const std::vector<FirstMoments<dim>> &phi, const FirstMoments<dim> &wanted,
        std::vector<double> &weight)
    {
      constexpr double open = 1e-3, least = .2; // of the trace of G, of the mean weight
      using Gram            = Eigen::Matrix<double, n_first<dim>, n_first<dim>>;
      Gram              G   = Gram::Zero();
      FirstMoments<dim> has = FirstMoments<dim>::Zero();
      for (std::size_t p = 0; p < v.size(); ++p)
        {
          has += v[p] * phi[p];
          G += v[p] * phi[p] * phi[p].transpose();
        }
      const double                              mean = wanted[0] / has[0];
      const Eigen::SelfAdjointEigenSolver<Gram> eigen(G);
      FirstMoments<dim>                         in_modes = eigen.eigenvectors().transpose() * (wanted - mean * has);
      for (unsigned int k = 0; k < n_first<dim>; ++k)
        in_modes[k] = eigen.eigenvalues()[k] > open * G.trace() ? in_modes[k] / eigen.eigenvalues()[k] : 0.;
      const FirstMoments<dim> series = eigen.eigenvectors() * in_modes;

      double part = 1.;
      weight.resize(v.size());
      for (std::size_t p = 0; p < v.size(); ++p)
        {
          weight[p] = series.dot(phi[p]);
          part      = std::min(part, -weight[p] > (1. - least) * mean ? (1. - least) * mean / -weight[p] : 1.);
        }
      for (double &w : weight)
        w = mean + part * w;
      // Apart from what is stored: else the compiler has a second loop, rounded otherwise, for numbers that lie close in memory.
      const double sum = std::inner_product(v.begin(), v.end(), weight.begin(), 0.);
      for (double &w : weight)
        w *= wanted[0] / sum;
    }

    /// Calls visit(place in the unit cell, volume) for 3^dim places whose volumes have the moments @p moments.
    template <int dim, typename Visit>
    void
    for_rule(CellMoments<dim> moments, const Visit &visit)
    {
      for (unsigned int d = 0, n = 1; d < dim; ++d, n *= 3)
        for (unsigned int k = 0; k < power(3, dim); ++k)
          if (k / n % 3 == 0) // of the parabolas that are one at -.5, 0 or .5 and zero at the other two
            {
              const double one = moments[k], x = moments[k + n], xx = moments[k + 2 * n];
              moments[k]         = 2. * xx - x;
              moments[k + n]     = one - 4. * xx;
              moments[k + 2 * n] = 2. * xx + x;
            }
      for (unsigned int k = 0; k < power(3, dim); ++k)
        {
          dealii::Point<dim> xi;
          for (unsigned int d = 0, rest = k; d < dim; ++d, rest /= 3)
            xi[d] = .5 * (rest % 3);
          visit(xi, moments[k]);
        }
    }

    /// Appends what the mean gradients over the points of a cell lack of those over what they cover.
    template <int dim>
    void
    add_gradient_shift(Points<dim> &points, const ShapeFunctions<dim> &shape, const ActiveCell<dim> &active,
                       const CellMoments<dim> &moments, const std::vector<double> &v)
    {
      std::array<std::array<double, ShapeFunctions<dim>::most_nodes>, dim> shift{};
      const auto add = [&](const dealii::Point<dim> &xi, const double volume) {
        const auto at = shape.at(active.index, xi);
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int a = 0; a < shape.n_nodes(); ++a)
            shift[d][a] += volume / moments[0] * at.gradient[d][a];
      };
      for_rule<dim>(moments, add);
      auto volume = v.begin();
      for (const auto &point : points.handler.particles_in_cell(active.cell))
        add(point.get_reference_location(), -point.get_properties()[points.weight.first] * *volume++);
      for (const auto &along : shift)
        points.gradient_shift.insert(points.gradient_shift.end(), along.begin(), along.begin() + shape.n_nodes());
    }
  } // namespace

  template <int dim>
  void
  set_weights(Points<dim> &points, const BackgroundGrid<dim> &grid)
  {
    CoveredMoments<dim>            covered(points, grid);
    std::vector<double>            volumes, weight;
    std::vector<FirstMoments<dim>> phi;
    points.gradient_shift.clear();
    for (const auto &active : grid.active_cells())
      {
        volumes.clear();
        phi.clear();
        for (const auto &point : points.handler.particles_in_cell(active.cell))
          {
            const double      *numbers = point.get_properties().data();
            dealii::Point<dim> place   = point.get_reference_location();
            for (unsigned int d = 0; d < dim; ++d)
              place[d] -= .5;
            volumes.push_back(points.undeformed_size(numbers) * determinant(points.deformation_of(numbers)));
            phi.push_back(first_of<dim>(mean_products<dim>(place, {})));
          }
        const auto moments = covered.of(active);
        fit<dim>(volumes, phi, first_of<dim>(moments), weight);
        auto next = weight.begin();
        for (auto &point : points.handler.particles_in_cell(active.cell))
          point.get_properties()[points.weight.first] = *next++;
        add_gradient_shift(points, *grid.shape, active, moments, volumes);
      }
  }

  template void set_weights(Points<2> &, const BackgroundGrid<2> &);
  template void set_weights(Points<3> &, const BackgroundGrid<3> &);
} // namespace Stroma::Mpm
