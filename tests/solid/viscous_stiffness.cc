#include "cell.h"

#include <stroma/solid/viscous_stiffness.h>

#include <gtest/gtest.h>

namespace
{
  using namespace Stroma;

  /// f_a = sum_p V J sigma_v(L) g_a at displacement @p u, with the nodes' velocity v = v_factor u + known.
  template <int dim, unsigned int n>
  std::vector<double>
  force(const Cell<dim, n> &cell, const Materials::Medium &medium, const std::vector<double> &u, const double v_factor,
        const std::vector<double> &known, Solid::ViscousStiffness<dim, n> *stiffness = nullptr)
  {
    std::vector<double> f(u.size(), 0.);
    for (unsigned int p = 0; p < cell.V.size(); ++p)
      {
        const auto           F = cell.F(p, u);
        const auto           g = cell.spatial(p, F);
        dealii::Tensor<2, 3> L;
        for (unsigned int a = 0; a < cell.n_nodes; ++a)
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int j = 0; j < dim; ++j)
              L[i][j] += (v_factor * u[a * dim + i] + known[a * dim + i]) * g[j][a];
        const double VJ     = cell.V[p] * determinant(F);
        const auto   stress = Materials::viscous_stress(medium, L);
        for (unsigned int a = 0; a < cell.n_nodes; ++a)
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int k = 0; k < dim; ++k)
              f[a * dim + i] += VJ * stress[i][k] * g[k][a];
        if (stiffness)
          stiffness->add(VJ, medium, L, v_factor, g);
      }
    return f;
  }

  template <int dim, unsigned int n>
  void
  check(const Materials::ViscousOperator viscous_operator)
  {
    const Cell<dim, n> cell(5);
    Materials::Medium  medium;
    medium.viscosity        = 3.;
    medium.viscous_operator = viscous_operator;
    std::vector<double> known(cell.u.rbegin(), cell.u.rend());
    constexpr double    v_factor = 4., step = 1e-6;

    Solid::ViscousStiffness<dim, n> stiffness;
    dealii::FullMatrix<double>      K(cell.n_unknowns);
    stiffness.clear();
    force(cell, medium, cell.u, v_factor, known, &stiffness);
    stiffness.add_to(K);
    for (unsigned int j = 0; j < cell.n_unknowns; ++j)
      {
        auto plus = cell.u, minus = cell.u;
        plus[j] += step;
        minus[j] -= step;
        const auto f_plus  = force(cell, medium, plus, v_factor, known),
                   f_minus = force(cell, medium, minus, v_factor, known);
        for (unsigned int i = 0; i < cell.n_unknowns; ++i)
          EXPECT_NEAR(K(i, j), (f_plus[i] - f_minus[i]) / (2. * step), 1e-8 * K.frobenius_norm());
      }
  }

  TEST(ViscousStiffness, IsTheDerivativeOfTheForce)
  {
    using Materials::ViscousOperator;
    for (const auto viscous_operator : {ViscousOperator::central, ViscousOperator::morris, ViscousOperator::deviatoric})
      {
        check<2, 4>(viscous_operator);
        check<2, 9>(viscous_operator);
        check<3, 8>(viscous_operator);
      }
  }
} // namespace
