// gamma and its gradient near walls: closed forms against adaptive quadrature, of the facets and of the area and volume.

#include <stroma/particles/wall_integrals.h>

#include <deal.II/base/quadrature_lib.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>

#include <gtest/gtest.h>

#include <random>

namespace
{
  using namespace Stroma::Particles;
  using dealii::Point;
  using dealii::Tensor;

  constexpr KernelName all_kernels[] = {KernelName::cubic_spline, KernelName::quintic_spline, KernelName::wendland_c2};
  constexpr double     h             = .7;

  /// Adaptive quadrature between the places @p at, which are sorted first.
  template <typename Function>
  double
  integrate(const Function &f, std::vector<double> at, const double tolerance = 1e-12)
  {
    std::sort(at.begin(), at.end());
    double sum = 0.;
    for (unsigned int k = 0; k + 1 < at.size(); ++k)
      if (at[k + 1] > at[k])
        sum += boost::math::quadrature::gauss_kronrod<double, 15>::integrate(f, at[k], at[k + 1], 10, tolerance);
    return sum;
  }

  double
  W(const KernelName name, const int dim, const double r)
  {
    const auto value = [r](const auto &kernel) { return kernel.W(r); };
    return dim == 2 ? with_kernel<2>(name, h, value) : with_kernel<3>(name, h, value);
  }

  /// Distances at which the kernel changes.
  constexpr double breakpoints[] = {h, 2 * h, 3 * h};

  /// Exact: ten Gauss points for each of the pieces, polynomials in r.
  double
  F(const KernelName name, const int dim, const double r)
  {
    static const dealii::QGauss<1> gauss(10);
    double                         sum = 0., from = r;
    for (const double to : breakpoints)
      if (to > from)
        {
          for (unsigned int q = 0; q < gauss.size(); ++q)
            {
              const double t = from + (to - from) * gauss.point(q)[0];
              sum += (to - from) * gauss.weight(q) * W(name, dim, t) * std::pow(t, dim - 1);
            }
          from = to;
        }
    return sum;
  }

  /// Where a line at distance @p rho is as far as a breakpoint, with the ends s0 and s1 and the foot.
  std::vector<double>
  places_on_line(const double rho, const double s0, const double s1)
  {
    std::vector<double> at{s0, s1};
    const auto          add = [&](const double s) {
      if (s > s0 && s < s1)
        at.push_back(s);
    };
    add(0.);
    for (const double b : breakpoints)
      if (b > rho)
        {
          add(std::sqrt(b * b - rho * rho));
          add(-std::sqrt(b * b - rho * rho));
        }
    return at;
  }

  WallIntegrals<2>::Values
  by_quadrature(const KernelName name, const Point<2> &x, const WallIntegrals<2>::Facet &facet)
  {
    const Tensor<1, 2>       edge = facet[1] - facet[0], t = edge / edge.norm(), n = dealii::cross_product_2d(t);
    const double             d = n * (x - facet[0]), s0 = (facet[0] - x) * t;
    const auto               at = places_on_line(std::abs(d), s0, s0 + edge.norm());
    const auto               r  = [d](const double s) { return std::sqrt(d * d + s * s); };
    WallIntegrals<2>::Values values;
    values.missing     = integrate([&](const double s) { return d * F(name, 2, r(s)) / (d * d + s * s); }, at);
    values.gradient    = integrate([&](const double s) { return W(name, 2, r(s)); }, at) * n;
    const double first = integrate([&](const double s) { return s * W(name, 2, r(s)); }, at);
    values.place       = x - d * n + first / (values.gradient * n) * t;
    return values;
  }

  template <typename Function>
  double
  over_triangle(const WallIntegrals<3>::Facet &facet, const Function &f)
  {
    const auto   u = facet[1] - facet[0], v = facet[2] - facet[0];
    const double twice_area = dealii::cross_product_3d(u, v).norm();
    const auto   along_u    = [&](const double a) {
      return integrate([&](const double b) { return f(Point<3>(facet[0] + a * u + b * (1 - a) * v)); },
                       {0., .25, .5, .75, 1.}, 1e-9) *
             (1 - a);
    };
    return twice_area * integrate(along_u, {0., .25, .5, .75, 1.}, 1e-9);
  }

  template <int dim>
  WallIntegrals<dim>
  of(const KernelName name)
  {
    return WallIntegrals<dim>(name, h);
  }
} // namespace

TEST(WallIntegrals, SegmentsAgreeWithQuadrature)
{
  std::mt19937                           generator(7);
  std::uniform_real_distribution<double> place(-2.5 * h, 2.5 * h);
  for (const auto name : all_kernels)
    {
      std::vector<std::pair<Point<2>, WallIntegrals<2>::Facet>> cases;
      for (unsigned int n = 0; n < 40; ++n)
        cases.push_back(
          {Point<2>(place(generator), place(generator)),
           {{Point<2>(place(generator), place(generator)), Point<2>(place(generator), place(generator))}}});
      const WallIntegrals<2>::Facet facet{{Point<2>(-.8, 0.), Point<2>(.9, 0.)}};
      for (const double d : {.3, -.3, .01, -.01, h, 2 * h, 1.9999999 * h}) // also tangent to where the kernel changes
        for (const double s : {0., .9, -.8, 1.4})                          // also above the ends and beyond
          cases.push_back({Point<2>(s, d), facet});
      for (const auto &[x, segment] : cases)
        {
          const auto exact = by_quadrature(name, x, segment), closed = of<2>(name)(x, segment);
          EXPECT_NEAR(closed.missing, exact.missing, 1e-10) << x << " of " << segment[0] << ", " << segment[1];
          EXPECT_NEAR((closed.gradient - exact.gradient).norm() * h, 0., 1e-10) << x;
          if (closed.gradient.norm() * h > 1e-4)
            {
              EXPECT_NEAR(closed.place.distance(exact.place), 0., 1e-8) << x;
            }
        }
    }
}

TEST(WallIntegrals, SegmentsNearAndOnTheirLine)
{
  const WallIntegrals<2>::Facet facet{{Point<2>(-2.5, 0.), Point<2>(2.5, 0.)}}; // material below it
  for (const auto name : all_kernels)
    {
      const double weight = integrate([&](const double s) { return W(name, 2, std::abs(s)); },
                                      places_on_line(0., -2.5, 2.5)); // on the line
      for (const double d : {1e-3, 1e-6, 1e-9, -1e-9, 0.})
        {
          const auto values = of<2>(name)(Point<2>(.1, -d), facet);
          // The half plane, whose missing part is 1/2 - d int W ds + O(d^3).
          const double half = d > 0. ? .5 : d < 0. ? -.5 : 0.;
          EXPECT_NEAR(values.missing, half - d * weight, 2. * std::abs(d * d * d) / (h * h * h) + 1e-12) << d;
          EXPECT_NEAR(values.gradient[1], -weight, 3. * d * d / (h * h * h) + 1e-12) << d;
          EXPECT_EQ(std::abs(values.gradient[0]), 0.);
        }
      for (const Point<2> &x : {Point<2>(2.5, 0.), Point<2>(2.6, 0.)}) // at the vertex, on the line beyond
        EXPECT_EQ(of<2>(name)(x, facet).missing, 0.);
    }
}

TEST(WallIntegrals, APolygonLeavesTheKernelOverItsInside)
{
  // The material fills the rectangle [-a, b] x [-c, e] about x = 0, inside, behind a side or on a vertex.
  const double boxes[][4] = {
    {.4, .6, .3, 1.1}, {.02, 1.5, .5, .7}, {-.2, 1., .4, .5}, {0., 1., 0., .8}, {0., 1., .3, .8}};
  const double filled[] = {1., 1., 0., .25, .5}; // of the angle about x
  for (const auto name : all_kernels)
    for (unsigned int k = 0; k < 5; ++k)
      {
        const auto                   &b = boxes[k];
        const std::array<Point<2>, 4> corners{
          {Point<2>(-b[0], -b[2]), Point<2>(-b[0], b[3]), Point<2>(b[1], b[3]), Point<2>(b[1], -b[2])}}; // clockwise
        double missing = 0.;
        for (unsigned int c = 0; c < 4; ++c)
          missing += of<2>(name)(Point<2>(), {{corners[c], corners[(c + 1) % 4]}}).missing;
        const auto row = [&](const double y) {
          return integrate([&](const double x) { return W(name, 2, std::hypot(x, y)); },
                           places_on_line(std::abs(y), -b[0], b[1]));
        };
        EXPECT_NEAR(filled[k] - missing, integrate(row, places_on_line(0., -b[2], b[3]), 1e-11), 1e-10) << k;
      }
}

TEST(WallIntegrals, TrianglesAgreeWithQuadrature)
{
  const WallIntegrals<3>::Facet facet{{Point<3>(-.5, -.4, 0.), Point<3>(.9, -.3, 0.), Point<3>(.1, .8, 0.)}};
  const Point<3>                above = Point<3>(.1, .1, 0.);
  // Over the inside, an edge, a vertex, outside; near, behind, far off.
  const Point<3> feet[] = {above, Point<3>(.2, -.35, 0.), facet[2], Point<3>(-.6, .5, 0.)};
  for (const auto name : all_kernels)
    for (const auto &foot : feet)
      for (const double d : {.35, -.35, h, 1.7 * h})
        {
          const auto x      = foot + Point<3>(0., 0., d);
          const auto closed = of<3>(name)(x, facet);
          const auto r      = [&](const Point<3> &y) { return y.distance(x); };
          EXPECT_NEAR(closed.gradient[2] * h,
                      h * over_triangle(facet, [&](const Point<3> &y) { return W(name, 3, r(y)); }), 1e-8);
          EXPECT_NEAR(closed.gradient[0], 0., 1e-14);
          const auto mean = [&](const unsigned int c) {
            return over_triangle(facet, [&](const Point<3> &y) { return y[c] * W(name, 3, r(y)); }) /
                   closed.gradient[2];
          };
          if (closed.gradient[2] * h > 1e-4)
            {
              EXPECT_NEAR(closed.place.distance(Point<3>(mean(0), mean(1), 0.)), 0., 1e-6);
            }
          EXPECT_NEAR(closed.missing,
                      over_triangle(facet, [&](const Point<3> &y) { return d * F(name, 3, r(y)) / std::pow(r(y), 3); }),
                      1e-8);
        }
}

TEST(WallIntegrals, ABoxLeavesTheKernelOverItsInside)
{
  // Places about a box [0, 1]^3 in units of its size, with the part of the solid angle that it fills there.
  const std::pair<Point<3>, double> cases[] = {{Point<3>(.4, .5, .3), 1.},  {Point<3>(.01, .5, .3), 1.},
                                               {Point<3>(-.2, .5, .3), 0.}, {Point<3>(0., 0., 0.), .125},
                                               {Point<3>(0., .3, 0.), .25}, {Point<3>(.2, .3, 1.), .5}};
  for (const auto name : all_kernels)
    for (const auto &[place, filled] : cases)
      {
        double missing = 0.;
        for (unsigned int d = 0; d < 3; ++d)
          for (const bool upper : {false, true})
            {
              const auto corner = [d = d, upper](const double a, const double b) {
                Point<3> p;
                p[d]           = upper;
                p[(d + 1) % 3] = a;
                p[(d + 2) % 3] = b;
                return p;
              };
              const auto add = [&](Point<3> a, Point<3> b, Point<3> c) {
                if (upper) // normals into the box
                  std::swap(b, c);
                missing += of<3>(name)(place, {{a, b, c}}).missing;
              };
              add(corner(0, 0), corner(1, 0), corner(1, 1));
              add(corner(0, 0), corner(1, 1), corner(0, 1));
            }
        const auto plane = [&, x = place](const double z) {
          const auto row = [&](const double y) {
            return integrate([&](const double s) { return W(name, 3, std::sqrt(s * s + y * y + z * z)); },
                             places_on_line(std::hypot(y, z), -x[0], 1. - x[0]), 1e-10);
          };
          return integrate(row, places_on_line(std::abs(z), -x[1], 1. - x[1]), 1e-9);
        };
        EXPECT_NEAR(filled - missing, integrate(plane, places_on_line(0., -place[2], 1. - place[2]), 1e-9), 1e-8)
          << place;
      }
}
