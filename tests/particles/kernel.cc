// Kernels: unit integral, and F as the slope of W.

#include <stroma/particles/kernel.h>

#include <deal.II/base/quadrature_lib.h>

#include <gtest/gtest.h>

namespace
{
  using namespace Stroma::Particles;

  template <typename Kernel>
  void
  check_integral(const Kernel &kernel, const int dim)
  {
    const dealii::QGauss<1> gauss(10); // exact for the pieces, polynomials in r
    double                  sum = 0;
    for (double start = 0; start < kernel.support(); start += kernel.h)
      for (unsigned int q = 0; q < gauss.size(); ++q)
        {
          const double r = start + kernel.h * gauss.point(q)[0];
          sum += gauss.weight(q) * kernel.h * kernel.W(r) * (dim == 2 ? 2 * M_PI * r : 4 * M_PI * r * r);
        }
    EXPECT_NEAR(sum, 1., 1e-12);
  }

  template <typename Kernel>
  void
  check_slope(const Kernel &kernel)
  {
    const double step = 1e-5 * kernel.h, scale = kernel.W(0) / (kernel.h * kernel.h);
    for (double q = .01; q < Kernel::support_over_h + .1; q += .037)
      {
        const double r = q * kernel.h;
        EXPECT_NEAR(kernel.F(r), -(kernel.W(r + step) - kernel.W(r - step)) / (2 * step * r), 1e-7 * scale) << q;
      }
    EXPECT_NEAR(kernel.F(0), kernel.F(1e-9 * kernel.h), 1e-7 * scale);
    EXPECT_NEAR(kernel.F(0), -2 * (kernel.W(step) - kernel.W(0)) / (step * step), 1e-3 * scale);
  }

  template <typename Kernel>
  void
  check_breakpoints(const Kernel &kernel)
  {
    const double support = kernel.support(), scale = kernel.W(0);
    for (double r = kernel.h; r < support + .5 * kernel.h; r += kernel.h)
      {
        EXPECT_NEAR(kernel.W(r * (1 - 1e-13)), kernel.W(r * (1 + 1e-13)), 1e-11 * scale);
        EXPECT_NEAR(kernel.F(r * (1 - 1e-13)), kernel.F(r * (1 + 1e-13)), 1e-11 * scale / (kernel.h * kernel.h));
      }
    for (const double r : {(1 + 1e-12) * support, 1.0001 * support, 7 * support})
      {
        EXPECT_EQ(kernel.W(r), 0.);
        EXPECT_EQ(kernel.F(r), 0.);
      }
    EXPECT_GT(kernel.W(.999 * support), 0.);
    EXPECT_GT(kernel.F(.999 * support), 0.);
  }

  /// Moments over a lattice: sum V W = 1 and sum V F x^2 = 1, since the integral of -x_k dW/dx_k is that of W.
  template <int dim, typename Kernel>
  void
  check_lattice_sums(const Kernel &kernel)
  {
    const double spacing = kernel.h / (dim == 2 ? 8 : 4);
    const int    n       = static_cast<int>(kernel.support() / spacing) + 1;
    double       sum_W = 0, sum_F = 0;
    for (int i = -n; i <= n; ++i)
      for (int j = -n; j <= n; ++j)
        for (int k = dim == 3 ? -n : 0; k <= (dim == 3 ? n : 0); ++k)
          {
            const double r = spacing * std::sqrt(i * i + j * j + k * k);
            sum_W += kernel.W(r) * std::pow(spacing, dim);
            sum_F += kernel.F(r) * std::pow(spacing, dim + 2) * i * i;
          }
    EXPECT_NEAR(sum_W, 1., 2e-4);
    EXPECT_NEAR(sum_F, 1., 2e-3);
  }

  class Kernels : public testing::TestWithParam<KernelName>
  {
  };

  template <int dim>
  void
  check(const KernelName name)
  {
    for (const double h : {1., .013})
      with_kernel<dim>(name, h, [](const auto &kernel) {
        check_integral(kernel, dim);
        check_slope(kernel);
        check_breakpoints(kernel);
        check_lattice_sums<dim>(kernel);
      });
  }

  TEST_P(Kernels, AreRightIn2D)
  {
    check<2>(GetParam());
  }

  TEST_P(Kernels, AreRightIn3D)
  {
    check<3>(GetParam());
  }

  INSTANTIATE_TEST_SUITE_P(All, Kernels,
                           testing::Values(KernelName::cubic_spline, KernelName::quintic_spline,
                                           KernelName::wendland_c2));
} // namespace
