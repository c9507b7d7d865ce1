// Force and stiffness of a cell are the derivatives of its energy, with the dilatation as it is and projected: the momentum
// kernel and the projected dilatation against automatic differentiation.

#include "../materials/automatic_derivatives.h"
#include "../materials/points.h"
#include "cell.h"

#include <stroma/materials/neo_hookean.h>
#include <stroma/solid/projected_dilatation.h>

#include <gtest/gtest.h>

namespace
{
  using namespace Stroma;
  using Points::collagen;

  /// Change of each point's F in the dim directions of the scene: (Jbar / J)^(1/dim), or 1.
  template <int dim, unsigned int n, typename Number>
  std::vector<Number>
  factors(const Cell<dim, n> &cell, const std::vector<Number> &J, const bool projected)
  {
    using std::exp;
    using std::log;
    Number mean   = 0.;
    double volume = 0.;
    for (unsigned int p = 0; p < J.size(); ++p)
      {
        mean += cell.V[p] * log(J[p]);
        volume += cell.V[p];
      }
    std::vector<Number> result(J.size(), Number(1.));
    for (unsigned int p = 0; p < J.size() && projected; ++p)
      result[p] = exp((mean / volume - log(J[p])) / double(dim));
    return result;
  }

  /// sum_p V_p psi(Fbar_p).
  template <int dim, unsigned int n, typename Number>
  Number
  energy(const Cell<dim, n> &cell, const std::vector<Number> &u, const bool projected)
  {
    std::vector<AutomaticDerivatives::Matrix<Number>> F;
    std::vector<Number>                               J;
    for (unsigned int p = 0; p < cell.V.size(); ++p)
      {
        F.push_back(cell.gradient(p, u));
        for (unsigned int d = 0; d < 3; ++d)
          F.back()[d][d] += 1.;
        J.push_back(AutomaticDerivatives::determinant(F.back()));
      }
    const auto factor = factors(cell, J, projected);
    Number     sum    = 0.;
    for (unsigned int p = 0; p < F.size(); ++p)
      {
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            F[p][i][j] *= factor[p];
        sum += cell.V[p] * AutomaticDerivatives::NeoHookeanEnergy{collagen.mu, collagen.kappa}(F[p]);
      }
    return sum;
  }

  template <int dim, unsigned int n>
  struct Sums
  {
    Solid::MomentumKernel<dim, n> kernel;
    dealii::FullMatrix<double>    K{Cell<dim, n>::n_unknowns};
  };

  /// Force and stiffness by the kernels, as MPM sums them up.
  template <int dim, unsigned int n>
  Sums<dim, n>
  sums(const Cell<dim, n> &cell, const bool projected)
  {
    const unsigned int                        n_points = cell.V.size();
    std::vector<dealii::Tensor<2, 3>>         F;
    std::vector<double>                       J;
    typename Cell<dim, n>::Lanes              mean{};
    std::vector<typename Cell<dim, n>::Lanes> g;
    double                                    volume = 0.;
    for (unsigned int p = 0; p < n_points; ++p)
      {
        F.push_back(cell.F(p, cell.u));
        J.push_back(determinant(F[p]));
        g.push_back(cell.spatial(p, F[p]));
        volume += cell.V[p];
        for (unsigned int d = 0; d < dim; ++d)
          mean[d] += cell.V[p] * g[p][d];
      }
    for (auto &lanes : mean)
      lanes /= volume;
    const auto factor = factors(cell, J, projected);
    for (unsigned int p = 0; p < n_points; ++p)
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          F[p][i][j] *= factor[p];
    auto point = Points::respond(Materials::NeoHookean(collagen), F);

    Sums<dim, n>                       result;
    auto                              &kernel = result.kernel;
    Solid::ProjectedDilatation<dim, n> dilatation;
    kernel.clear();
    dilatation.begin(mean);
    for (unsigned int p = 0; p < n_points; ++p)
      {
        dilatation.take(cell.V[p], point.tau[p]);
        kernel.add_force(cell.V[p], projected ? dilatation.deviator(point.tau[p]) : point.tau[p], g[p]);
      }
    for (unsigned int c = 0; c < dim && projected; ++c)
      kernel.add_nodal_force(1., c, dilatation.mean_force(c));
    for (unsigned int p = 0; p < n_points; ++p)
      {
        if (projected)
          dilatation.split(cell.V[p], g[p], point.tau[p], point.Jc[p]);
        kernel.add_stiffness(cell.V[p], point.tau[p], point.Jc[p], g[p]);
      }
    kernel.finish_stiffness();
    kernel.copy_stiffness(result.K);
    if (projected)
      dilatation.add_stiffness(result.K);
    return result;
  }

  template <int dim, unsigned int n>
  void
  check(const bool projected)
  {
    constexpr unsigned int n_unknowns = Cell<dim, n>::n_unknowns;
    using First                       = Sacado::Fad::SFad<double, n_unknowns>;
    using Second                      = Sacado::Fad::SFad<First, n_unknowns>;
    const Cell<dim, n>  cell(11); // more than the kernel keeps waiting
    std::vector<Second> u;
    for (unsigned int i = 0; i < n_unknowns; ++i)
      u.push_back(Second(n_unknowns, i, First(n_unknowns, i, cell.u[i])));
    const Second W     = energy(cell, u, projected);
    const auto   found = sums(cell, projected);
    const double scale = collagen.kappa * cell.V.size();
    for (unsigned int i = 0; i < n_unknowns; ++i)
      {
        EXPECT_NEAR(found.kernel.force_at(i / dim, i % dim), W.dx(i).val(), 1e-13 * scale);
        for (unsigned int j = 0; j < n_unknowns; ++j)
          EXPECT_NEAR(found.K(i, j), W.dx(i).dx(j), 1e-12 * scale) << i << ", " << j;
      }
  }

  TEST(MomentumKernel, IsTheDerivativeOfTheEnergy)
  {
    check<2, 4>(false);
    check<2, 9>(false);
    check<3, 8>(false);
  }

  TEST(ProjectedDilatation, IsTheDerivativeOfTheEnergyOfFbar)
  {
    check<2, 4>(true);
    check<2, 9>(true);
    check<3, 8>(true);
  }
} // namespace
