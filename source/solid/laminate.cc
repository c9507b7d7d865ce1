#include <stroma/solid/laminate.h>

#include <cmath>

namespace Stroma::Solid
{
  namespace
  {
    constexpr unsigned int most_rounds = 30, most_halvings = 12;
    /// A step of Newton's method below this leaves an error of round-off, since the next one is its square.
    constexpr double last_step = 1e-9;

    /// g = F^-T N in the dim directions of the scene.
    template <int dim>
    dealii::Tensor<1, dim>
    spatial_normal(const dealii::Tensor<2, 3> &F, const dealii::Tensor<1, dim> &N)
    {
      dealii::Tensor<2, dim> plane;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int k = 0; k < dim; ++k)
          plane[i][k] = F[i][k];
      return N * invert(plane);
    }

    template <int dim>
    dealii::Tensor<1, dim>
    traction(const dealii::SymmetricTensor<2, 3> &tau, const dealii::Tensor<1, dim> &g)
    {
      dealii::Tensor<1, dim> t;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int k = 0; k < dim; ++k)
          t[i] += tau[i][k] * g[k];
      return t;
    }

    /// Jc_ikjl g_l, by i, k and j.
    template <int dim>
    dealii::Tensor<3, dim>
    stress_rate(const dealii::SymmetricTensor<4, 3> &Jc, const dealii::Tensor<1, dim> &g)
    {
      dealii::Tensor<3, dim> rate;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int j = 0; j < dim; ++j)
            for (unsigned int l = 0; l < dim; ++l)
              rate[i][k][j] += Jc[i][k][j][l] * g[l];
      return rate;
    }

    bool
    is_turned_inside_out(const dealii::Tensor<2, 3> &F)
    {
      return !(determinant(F) > 0.);
    }
  } // namespace

  /// tau and Jc of the points under the jump @p trial.
  template <int dim>
  StepStatus
  Laminate<dim>::evaluate(const Interface<dim> &interface, Materials::MaterialBlock &block, const Vector &trial)
  {
    for (const auto &run : block.runs)
      for (unsigned int p = run.begin; p < run.end; ++p)
        {
          block.F[p] = F[p];
          add_jump(block.F[p], interface.side[run.material], trial, interface.normal);
          if (is_turned_inside_out(block.F[p]))
            return StepStatus::inverted_point;
        }
    return block.evaluate(Materials::tangent);
  }

  /// R(a); returns what it is the small difference of.
  template <int dim>
  double
  Laminate<dim>::sum_residual(const Interface<dim> &interface, const std::vector<double> &V,
                              const Materials::MaterialBlock &block, Vector &R) const
  {
    double scale = 0;
    R            = Vector();
    for (const auto &run : block.runs)
      for (unsigned int p = run.begin; p < run.end; ++p)
        {
          const auto t = traction(block.tau[p], spatial_normal(block.F[p], interface.normal));
          R += V[p] * interface.side[run.material] * t;
          scale += V[p] * std::abs(interface.side[run.material]) * t.norm();
        }
    return scale;
  }

  /// K_aa
  template <int dim>
  typename Laminate<dim>::Square
  Laminate<dim>::stiffness(const Interface<dim> &interface, const std::vector<double> &V,
                           const Materials::MaterialBlock &block) const
  {
    Square K;
    for (const auto &run : block.runs)
      {
        const double s = interface.side[run.material];
        for (unsigned int p = run.begin; p < run.end; ++p)
          {
            const auto   g         = spatial_normal(block.F[p], interface.normal);
            const auto   rate      = stress_rate(block.Jc[p], g);
            const double geometric = g * traction(block.tau[p], g);
            for (unsigned int i = 0; i < dim; ++i)
              {
                K[i][i] += V[p] * s * s * geometric;
                for (unsigned int k = 0; k < dim; ++k)
                  for (unsigned int j = 0; j < dim; ++j)
                    K[i][j] += V[p] * s * s * g[k] * rate[i][k][j];
              }
          }
      }
    return K;
  }

  template <int dim>
  StepStatus
  Laminate<dim>::solve(const Interface<dim> &interface, const std::vector<double> &V, Materials::MaterialBlock &block)
  {
    F.assign(block.F.begin(), block.F.begin() + block.size);
    a                 = Vector();
    StepStatus status = evaluate(interface, block, a);
    if (status != StepStatus::ok)
      return status;
    Vector R, R_next;
    double scale = sum_residual(interface, V, block, R);
    for (unsigned int round = 0; round < most_rounds; ++round)
      {
        const double before = R.norm();
        if (before <= 1e-15 * scale)
          return StepStatus::ok;
        const Vector step   = -1. * (invert(stiffness(interface, V, block)) * R);
        double       factor = 1.;
        for (unsigned int halving = 0;; ++halving, factor /= 2.)
          {
            if (!std::isfinite(step.norm()) || halving > most_halvings)
              return StepStatus::diverged;
            status = evaluate(interface, block, a + factor * step);
            if (status != StepStatus::ok)
              continue;
            scale = sum_residual(interface, V, block, R_next);
            if (R_next.norm() <= (1. - .1 * factor) * before || step.norm() < last_step)
              break;
          }
        a += factor * step;
        R = R_next;
        if (step.norm() < last_step)
          return StepStatus::ok;
      }
    return StepStatus::diverged;
  }

  template <int dim>
  template <unsigned int n>
  void
  Laminate<dim>::condense(const Interface<dim> &interface, const std::vector<double> &V,
                          const Materials::MaterialBlock &block, const std::vector<std::array<Lanes<n>, dim>> &g,
                          dealii::FullMatrix<double> &K) const
  {
    std::array<Square, n> K_ba;
    for (const auto &run : block.runs)
      {
        const double s = interface.side[run.material];
        for (unsigned int p = run.begin; p < run.end; ++p)
          {
            const auto normal = spatial_normal(block.F[p], interface.normal);
            const auto rate   = stress_rate(block.Jc[p], normal);
            const auto t      = traction(block.tau[p], normal);
            for (unsigned int b = 0; b < n; ++b)
              for (unsigned int k = 0; k < dim; ++k)
                {
                  const double Vsg = V[p] * s * g[p][k][b];
                  for (unsigned int i = 0; i < dim; ++i)
                    {
                      K_ba[b][i][i] += Vsg * t[k];
                      for (unsigned int j = 0; j < dim; ++j)
                        K_ba[b][i][j] += Vsg * rate[i][k][j];
                    }
                }
          }
      }
    const Square inverse = invert(stiffness(interface, V, block));
    for (unsigned int b = 0; b < n; ++b)
      {
        const Square left = K_ba[b] * inverse;
        for (unsigned int c = 0; c < n; ++c)
          {
            const Square taken = left * transpose(K_ba[c]);
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int j = 0; j < dim; ++j)
                K(b * dim + i, c * dim + j) -= taken[i][j];
          }
      }
  }

  template class Laminate<2>;
  template class Laminate<3>;
  template void Laminate<2>::condense<4>(const Interface<2> &, const std::vector<double> &,
                                         const Materials::MaterialBlock &, const std::vector<std::array<Lanes<4>, 2>> &,
                                         dealii::FullMatrix<double> &) const;
  template void Laminate<2>::condense<9>(const Interface<2> &, const std::vector<double> &,
                                         const Materials::MaterialBlock &, const std::vector<std::array<Lanes<9>, 2>> &,
                                         dealii::FullMatrix<double> &) const;
  template void Laminate<3>::condense<8>(const Interface<3> &, const std::vector<double> &,
                                         const Materials::MaterialBlock &, const std::vector<std::array<Lanes<8>, 3>> &,
                                         dealii::FullMatrix<double> &) const;
  template void Laminate<3>::condense<27>(const Interface<3> &, const std::vector<double> &,
                                          const Materials::MaterialBlock &,
                                          const std::vector<std::array<Lanes<27>, 3>> &,
                                          dealii::FullMatrix<double> &) const;
} // namespace Stroma::Solid
