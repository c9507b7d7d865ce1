#pragma once

#include <stroma/particles/kernel.h>

#include <deal.II/base/point.h>

#include <array>
#include <vector>

namespace Stroma::Particles
{
  /**
   * What a wall takes of a kernel, exactly. With gamma(x) the integral of W(|x' - x|) over the material (Ferrand et al. 2013;
   * Heck 2017, (20) and (21)), these are the parts that one flat facet has in
   *   1 - gamma  = int d F(r)/r^dim dS,   F(r) = int_r^R W(t) t^(dim - 1) dt, by the divergence theorem, and
   *   grad gamma = int W(r) n dS,         n the facet's normal into the material, d = (x - facet).n.
   *
   * The kernel is a polynomial in r between breakpoints, so both are sums of moments of r along straight lines in closed form:
   * in the plane along the segment, int r^m ds with r^2 = d^2 + s^2; in space along the edges of the triangle,
   * int h r^m/(h^2 + s^2) ds with r^2 = d^2 + h^2 + s^2, after integration over the radius about the foot of x in the facet's
   * plane (h: distance of the foot from the edge). No quadrature, and no limit on how near x may be.
   */
  template <int dim>
  class WallIntegrals
  {
  public:
    /// @param h smoothing length [m]
    WallIntegrals(KernelName name, double h);

    /// A segment a, b or triangle a, b, c: b - a turned clockwise, (b - a) x (c - a), points into the material.
    using Facet = std::array<dealii::Point<dim>, dim>;

    struct Values
    {
      double                 missing = 0.; ///< part of 1 - gamma; 0 for x on the facet's line or plane
      dealii::Tensor<1, dim> gradient;     ///< part of grad gamma [1/m]
      dealii::Point<dim>     place;        ///< mean place on the facet, weighted with W [m]; none where gradient is 0
    };

    /// Over all facets of a closed wall, missing sums up to 1 - gamma for x in the material, to -gamma behind the wall, and to
    /// a/2pi - gamma (a/4pi - gamma) on it, where a is the angle (solid angle) that the material fills about x.
    Values operator()(const dealii::Point<dim> &x, const Facet &facet) const;

  private:
    static constexpr int n_powers = 8; ///< highest power of q = r/h, plus one

    /// Between two breakpoints. In the plane F/q^2 = e/q^2 + sum missing q^m and W = sum weight q^m; in space their integrals
    /// over the radius, int F/q^2 dq = -e/q + sum missing q^m and int W q dq = sum weight q^m, continuous at breakpoints.
    struct Piece
    {
      double                       from = 0., to = 0.;
      double                       e = 0.;
      std::array<double, n_powers> missing{}, weight{};
    };

    /// Parts of 1 - gamma, of |grad gamma| h, and for the mean place: in the plane int W s ds along the segment, in space
    /// int G(r) ds along an edge with G(r) = int_r^R W t dt, as int W rho dS = - int grad G dS.
    struct Sums
    {
      double missing = 0., weight = 0., first = 0.;
    };
    template <typename Antiderivative>
    Sums along_line(double rho, double s0, double s1, const Antiderivative &antiderivative) const;
    /// @param d over h. Fills in the sums, in units of h; place: that of int W (y - foot) dS.
    Values over_facet(const dealii::Point<dim> &x, const Facet &facet, const dealii::Tensor<1, dim> &normal,
                      double d) const;
    void   integrate_over_radius();

    const double       inverse_h;
    std::vector<Piece> pieces;
  };
} // namespace Stroma::Particles
