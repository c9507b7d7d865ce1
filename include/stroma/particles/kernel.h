#pragma once

#include <cmath>

namespace Stroma::Particles
{
  /// Smoothing kernels W(r, h), of unit integral.
  enum class KernelName
  {
    cubic_spline,   ///< support 2 h
    quintic_spline, ///< support 3 h
    wendland_c2     ///< support 2 h, (1 - q/2)^4 (1 + 2 q), Wendland 1995: no clustering of particles
  };

  /// One kernel; q = r / h.
  /// F = -W'(r)/r >= 0 is what pair sums need, so that nabla_i W(x_i - x_j) = F (x_j - x_i), finite also where r = 0.
  template <int dim, KernelName name>
  class Kernel
  {
    static_assert(dim == 2 || dim == 3, "kernels are normalised in 2D and 3D only");

  public:
    static constexpr double support_over_h = name == KernelName::quintic_spline ? 3. : 2.;

    /// @param h smoothing length [m]
    explicit Kernel(const double h)
      : h(h)
      , inverse_h(1. / h)
      , sigma_W(normalisation() / (dim == 2 ? h * h : h * h * h))
      , sigma_F(sigma_W / (h * h))
    {}

    double
    support() const
    {
      return support_over_h * h;
    } ///< [m]
    double
    W(const double r) const
    {
      return sigma_W * w(r * inverse_h);
    } ///< [1/m^dim]
    double
    F(const double r) const
    {
      return sigma_F * f(r * inverse_h);
    } ///< [1/m^(dim + 2)]

    const double h;

  private:
    static double
    normalisation()
    {
      switch (name)
        {
          case KernelName::cubic_spline:
            return dim == 2 ? 10. / (7. * M_PI) : 1. / M_PI;
          case KernelName::quintic_spline:
            return dim == 2 ? 7. / (478. * M_PI) : 1. / (120. * M_PI);
          default:
            return dim == 2 ? 7. / (4. * M_PI) : 21. / (16. * M_PI);
        }
    }

    static double
    square(const double a)
    {
      return a * a;
    }
    static double
    cube(const double a)
    {
      return a * a * a;
    }
    static double
    fourth(const double a)
    {
      return square(square(a));
    }
    static double
    fifth(const double a)
    {
      return fourth(a) * a;
    }

    /// W without its normalisation.
    static double
    w(const double q)
    {
      if (q >= support_over_h)
        return 0.;
      if constexpr (name == KernelName::cubic_spline)
        return q < 1. ? 1. + q * q * (.75 * q - 1.5) : .25 * cube(2. - q);
      else if constexpr (name == KernelName::quintic_spline)
        return fifth(3. - q) - (q < 2. ? 6. * fifth(2. - q) : 0.) + (q < 1. ? 15. * fifth(1. - q) : 0.);
      else
        return fourth(1. - .5 * q) * (1. + 2. * q);
    }

    /// -w'(q)/q; the division is carried out where q may vanish.
    static double
    f(const double q)
    {
      if (q >= support_over_h)
        return 0.;
      if constexpr (name == KernelName::cubic_spline)
        return q < 1. ? 3. - 2.25 * q : .75 * square(2. - q) / q;
      else if constexpr (name == KernelName::quintic_spline)
        return q < 1. ? 120. + q * q * (50. * q - 120.) :
                        5. * (fourth(3. - q) - (q < 2. ? 6. * fourth(2. - q) : 0.)) / q;
      else
        return 5. * cube(1. - .5 * q);
    }

    double inverse_h;
    double sigma_W; ///< normalisation over h^dim
    double sigma_F; ///< normalisation over h^(dim + 2)
  };

  /// Calls @p f with the kernel of this name, so that the choice is made once a loop.
  template <int dim, typename Function>
  auto
  with_kernel(const KernelName name, const double h, const Function &f)
  {
    switch (name)
      {
        case KernelName::cubic_spline:
          return f(Kernel<dim, KernelName::cubic_spline>(h));
        case KernelName::quintic_spline:
          return f(Kernel<dim, KernelName::quintic_spline>(h));
        default:
          return f(Kernel<dim, KernelName::wendland_c2>(h));
      }
  }
} // namespace Stroma::Particles
