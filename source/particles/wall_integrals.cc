#include <stroma/particles/wall_integrals.h>

#include <cmath>
#include <limits>

namespace Stroma::Particles
{
  namespace
  {
    /// Nearer to a facet's plane than this, over h, a place is taken to be on it: there 1 - gamma jumps.
    constexpr double on_plane = 1e-12;

    using Powers = std::array<double, 8>;

    /// Coefficients of factor (end - q)^5.
    Powers
    fifth_power(const double end, const double factor)
    {
      const double c[] = {1., 5., 10., 10., 5., 1.};
      Powers       result{};
      for (int m = 0; m < 6; ++m)
        result[m] = factor * c[m] * std::pow(end, 5 - m) * (m % 2 ? -1. : 1.);
      return result;
    }

    Powers
    sum(Powers a, const Powers &b)
    {
      for (unsigned int m = 0; m < a.size(); ++m)
        a[m] += b[m];
      return a;
    }

    /// A polynomial in q that holds up to `to`, from where the one before it ends.
    struct Part
    {
      double to;
      Powers w;
    };

    /// W h^dim without its normalisation.
    std::vector<Part>
    parts_of(const KernelName name)
    {
      switch (name)
        {
          case KernelName::cubic_spline:
            return {{1., {{1., 0., -1.5, .75}}}, {2., {{2., -3., 1.5, -.25}}}};
            case KernelName::quintic_spline: {
              const Powers outer = fifth_power(3., 1.), middle = sum(outer, fifth_power(2., -6.));
              return {{1., sum(middle, fifth_power(1., 15.))}, {2., middle}, {3., outer}};
            }
          default:
            return {{2., {{1., 0., -2.5, 2.5, -.9375, .125}}}};
        }
    }

    double
    evaluate(const Powers &p, const double q)
    {
      double value = 0.;
      for (unsigned int m = p.size(); m-- > 0;)
        value = value * q + p[m];
      return value;
    }

    /// asinh(s/rho), of which only products with rho or rho^2 are needed.
    double
    log_term(const double rho, const double s)
    {
      return rho > 0. ? std::asinh(s / rho) : 0.;
    }

    /// I_m = int r^m ds with r^2 = rho^2 + s^2.
    Powers
    moments(const double rho, const double s)
    {
      const double r2 = rho * rho + s * s, r = std::sqrt(r2);
      Powers       I;
      I[0] = s;
      I[1] = .5 * (s * r + rho * rho * log_term(rho, s));
      for (unsigned int m = 2; m < I.size(); ++m)
        I[m] = (s * std::pow(r, m) + m * rho * rho * I[m - 2]) / (m + 1);
      return I;
    }

    /// int h |d|/(r (h^2 + s^2)) ds with r^2 = d^2 + h^2 + s^2.
    double
    solid_angle(const double d, const double h, const double s)
    {
      return std::atan2(std::abs(d) * s, h * std::sqrt(d * d + h * h + s * s));
    }

    /// K_m = int h r^m/(h^2 + s^2) ds with r^2 = d^2 + h^2 + s^2, h > 0: r^m = d^2 r^(m-2) + (h^2 + s^2) r^(m-2).
    Powers
    moments_about_foot(const double d, const double h, const double s)
    {
      const double rho = std::sqrt(d * d + h * h);
      const Powers I   = moments(rho, s);
      Powers       K;
      K[0] = std::atan2(s, h);
      K[1] = h * log_term(rho, s) + std::abs(d) * solid_angle(d, h, s);
      for (unsigned int m = 2; m < K.size(); ++m)
        K[m] = h * I[m - 2] + d * d * K[m - 2];
      return K;
    }

    double
    product(const Powers &a, const Powers &b)
    {
      double sum = 0.;
      for (unsigned int m = 0; m < a.size(); ++m)
        sum += a[m] * b[m];
      return sum;
    }

    template <int dim>
    dealii::Tensor<1, dim>
    normal_of(const std::array<dealii::Point<dim>, dim> &facet)
    {
      dealii::Tensor<1, dim> n;
      if constexpr (dim == 2)
        n = dealii::cross_product_2d(facet[1] - facet[0]);
      else
        n = dealii::cross_product_3d(facet[1] - facet[0], facet[2] - facet[0]);
      return n / n.norm();
    }
  } // namespace

  template <int dim>
  WallIntegrals<dim>::WallIntegrals(const KernelName name, const double h)
    : inverse_h(1. / h)
  {
    const auto   parts = parts_of(name);
    const double sigma = with_kernel<dim>(name, 1., [](const auto &kernel) { return kernel.W(0.); }) / parts[0].w[0];
    for (const auto &part : parts)
      {
        Piece piece;
        piece.from = pieces.empty() ? 0. : pieces.back().to;
        piece.to   = part.to;
        for (unsigned int m = 0; m < n_powers; ++m)
          {
            piece.weight[m]  = sigma * part.w[m];
            piece.missing[m] = -sigma * part.w[m] / (m + dim);
          }
        pieces.push_back(piece);
      }
    double F = 0.; // at the end of the piece
    for (auto piece = pieces.rbegin(); piece != pieces.rend(); ++piece)
      {
        piece->e = F - std::pow(piece->to, dim) * evaluate(piece->missing, piece->to);
        F        = piece->e + std::pow(piece->from, dim) * evaluate(piece->missing, piece->from);
      }
    if (dim == 3)
      integrate_over_radius();
  }

  template <int dim>
  void
  WallIntegrals<dim>::integrate_over_radius()
  {
    Piece beyond;
    beyond.from = pieces.back().to;
    beyond.to   = std::numeric_limits<double>::max();
    pieces.push_back(beyond);
    double missing = 0., weight = 0.; // at the start of the piece
    for (auto &piece : pieces)
      {
        for (unsigned int m = n_powers - 1; m >= 2; --m)
          {
            piece.missing[m] = piece.missing[m - 2] / m;
            piece.weight[m]  = piece.weight[m - 2] / m;
          }
        piece.missing[0] = piece.missing[1] = piece.weight[0] = piece.weight[1] = 0.;
        const bool at_centre = piece.from == 0.; // there -e/q has no value, and none is needed
        piece.missing[0]     = at_centre ? 0. : missing + piece.e / piece.from - evaluate(piece.missing, piece.from);
        piece.weight[0]      = weight - evaluate(piece.weight, piece.from);
        missing              = evaluate(piece.missing, piece.to) - piece.e / piece.to;
        weight               = evaluate(piece.weight, piece.to);
      }
  }

  template <int dim>
  template <typename Antiderivative>
  typename WallIntegrals<dim>::Sums
  WallIntegrals<dim>::along_line(const double rho, const double s0, const double s1,
                                 const Antiderivative &antiderivative) const
  {
    Sums sums;
    for (const auto &piece : pieces)
      {
        if (piece.to <= rho)
          continue;
        const auto add = [&](const double from, const double to) {
          if (!(from < to))
            return;
          const Sums upper = antiderivative(piece, to), lower = antiderivative(piece, from);
          sums.missing += upper.missing - lower.missing;
          sums.weight += upper.weight - lower.weight;
          sums.first += upper.first - lower.first;
        };
        const double inner = std::sqrt(std::max(0., piece.from * piece.from - rho * rho));
        const double outer = std::sqrt(piece.to * piece.to - rho * rho);
        add(std::max(s0, -outer), std::min(s1, -inner));
        add(std::max(s0, inner), std::min(s1, outer));
      }
    return sums;
  }

  template <>
  typename WallIntegrals<2>::Values
  WallIntegrals<2>::over_facet(const dealii::Point<2> &x, const Facet &facet, const dealii::Tensor<1, 2> &normal,
                               const double d) const
  {
    const auto                 edge           = facet[1] - facet[0];
    const double               length         = edge.norm();
    const dealii::Tensor<1, 2> t              = edge / length;
    const double               s0             = inverse_h * ((facet[0] - x) * t);
    const auto                 antiderivative = [d](const Piece &piece, const double s) {
      const double r     = std::sqrt(d * d + s * s);
      const Powers I     = moments(std::abs(d), s);
      double       first = 0.; // int W s ds = int W r dr
      for (unsigned int m = n_powers; m-- > 0;)
        first = first * r + piece.weight[m] / (m + 2);
      return Sums{d == 0. ? 0. : piece.e * std::atan(s / d) + d * product(piece.missing, I), product(piece.weight, I),
                  first * r * r};
    };
    const Sums sums = along_line(std::abs(d), s0, s0 + inverse_h * length, antiderivative);
    return {sums.missing, sums.weight * normal, dealii::Point<2>(sums.first * t)};
  }

  template <>
  typename WallIntegrals<3>::Values
  WallIntegrals<3>::over_facet(const dealii::Point<3> &x, const Facet &facet, const dealii::Tensor<1, 3> &normal,
                               const double d) const
  {
    const double sign = d < 0. ? -1. : 1., q = std::abs(d);
    const auto   start = std::find_if(pieces.begin(), pieces.end(), [q](const Piece &piece) { return q < piece.to; });
    const double missing_at_foot = d * evaluate(start->missing, q) - sign * start->e; // d times the value
    const double weight_at_foot = evaluate(start->weight, q), weight_at_reach = pieces.back().weight[0];
    Values       values;
    for (unsigned int k = 0; k < 3; ++k)
      {
        const auto                 edge   = facet[(k + 1) % 3] - facet[k];
        const double               length = edge.norm();
        const dealii::Tensor<1, 3> t = edge / length, outward = dealii::cross_product_3d(t, normal);
        const auto                 to_a = inverse_h * (facet[k] - x);
        const double               h = outward * to_a, s0 = to_a * t; // h > 0: the foot is on the facet's side
        const auto                 antiderivative = [&](const Piece &piece, const double s) {
          Sums sums;
          sums.first = weight_at_reach * s - product(piece.weight, moments(std::sqrt(d * d + h * h), s));
          if (h == 0.)
            return sums;
          const Powers K = moments_about_foot(d, std::abs(h), s);
          sums.missing = d * product(piece.missing, K) - sign * piece.e * solid_angle(d, std::abs(h), s) -
                         missing_at_foot * K[0];
          sums.weight = product(piece.weight, K) - weight_at_foot * K[0];
          return sums;
        };
        const Sums part = along_line(std::sqrt(d * d + h * h), s0, s0 + inverse_h * length, antiderivative);
        values.missing += (h < 0. ? -1. : 1.) * part.missing;
        values.gradient += (h < 0. ? -1. : 1.) * part.weight * normal;
        values.place -= part.first * outward;
      }
    if (d == 0.)
      values.missing = 0.;
    return values;
  }

  template <int dim>
  typename WallIntegrals<dim>::Values
  WallIntegrals<dim>::operator()(const dealii::Point<dim> &x, const Facet &facet) const
  {
    const auto normal = normal_of<dim>(facet);
    double     d      = inverse_h * (normal * (x - facet[0]));
    if (std::abs(d) < on_plane)
      d = 0.;
    if (std::abs(d) >= (dim == 2 ? pieces.back().to : pieces.back().from))
      return {};
    Values       values = over_facet(x, facet, normal, d);
    const double weight = values.gradient * normal;
    if (weight > 0.)
      values.place = x - d / inverse_h * normal + values.place / (inverse_h * weight);
    values.gradient *= inverse_h;
    return values;
  }

  template class WallIntegrals<2>;
  template class WallIntegrals<3>;
} // namespace Stroma::Particles
