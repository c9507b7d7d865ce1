#include <stroma/shapes/triangulation.h>

#include <stroma/shapes/ring.h>
#include <stroma/shapes/table.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Stroma::Shapes
{
  namespace
  {
    constexpr double degree = dealii::numbers::PI / 180.;
  }

  std::shared_ptr<const Shape<2>>
  Ring::read(Parameters &p, MPI_Comm)
  {
    const auto centre = read_point<2>(p, "Centre", "centre", 0.);
    double     radius = std::nan(""), inner_radius = radius;
    p.add("Inner radius", inner_radius, "inner radius", "m", Range::positive());
    p.add("Outer radius", radius, "outer radius", "m", Range::positive());
    std::vector<double> angles{0., 90.};
    p.add("Angles", angles, "from, to, anticlockwise from the x axis, in degrees; a whole ring by 0, 360", "",
          Range::closed(-360, 360), 2);
    if (!(inner_radius < radius) && p.get_mode() == Parameters::Mode::read)
      throw UserError(p.where("Outer radius"), "'Outer radius' must be larger than 'Inner radius'");
    if (!(angles[0] < angles[1] && angles[1] - angles[0] <= 360))
      throw UserError(p.where("Angles"), "'Angles' must increase, by 360 degrees at most");
    return std::make_shared<Ring>(centre, inner_radius, radius, angles[0], angles[1]);
  }

  dealii::Point<2>
  Ring::at(const double r, const double angle) const
  {
    const double quarters = angle / 90., whole = std::round(quarters);
    const bool   on_axis = std::abs(quarters - whole) < 1e-12;
    const int    quarter = ((int(whole) % 4) + 4) % 4;
    const double c       = on_axis ? (quarter == 0) - (quarter == 2) : std::cos(angle * degree);
    const double s       = on_axis ? (quarter == 1) - (quarter == 3) : std::sin(angle * degree);
    return {centre[0] + r * c, centre[1] + r * s};
  }

  bool
  Ring::contains(const dealii::Point<2> &X) const
  {
    const double r     = X.distance(centre);
    double       angle = std::atan2(X[1] - centre[1], X[0] - centre[0]) / degree;
    while (angle < from)
      angle += 360.;
    return inner_radius <= r && r <= radius && angle <= to;
  }

  /// The nearest of two arcs and two straight ends.
  Nearest<2>
  Ring::nearest(const dealii::Point<2> &X) const
  {
    const dealii::Tensor<1, 2> d     = X - centre;
    const double               r     = d.norm();
    double                     angle = std::atan2(d[1], d[0]) / degree;
    Nearest<2>                 result;
    result.distance = std::numeric_limits<double>::max();
    const auto take = [&](const dealii::Point<2> &foot, const dealii::Tensor<1, 2> &normal, const double curvature) {
      if (const double distance = X.distance(foot); distance < result.distance)
        result = {foot, normal, distance, curvature};
    };
    while (angle < from)
      angle += 360.;
    if (angle <= to)
      {
        const dealii::Tensor<1, 2> outward = r > 0 ? d / r : dealii::Tensor<1, 2>(dealii::Point<2>::unit_vector(0));
        take(centre + radius * outward, outward, r > 0 ? 1. / r : 0.);
        take(centre + inner_radius * outward, -outward, r > 0 ? -1. / r : 0.);
      }
    for (const double end : {from, to})
      {
        if (to - from == 360.)
          break; // a whole ring has none
        const dealii::Tensor<1, 2> along = (at(radius, end) - centre) / radius;
        const double               s     = std::clamp(d * along, inner_radius, radius);
        take(centre + s * along, (end == from ? 1. : -1.) * dealii::cross_product_2d(along), 0.);
      }
    const double away = (X - result.foot) * result.normal;
    if (contains(X))
      result.distance *= -1.;
    else if (away < (1. - 1e-9) * result.distance) // beside a corner
      result.normal = (X - result.foot) / result.distance;
    return result;
  }

  dealii::BoundingBox<2>
  Ring::bounding_box() const
  {
    std::vector<double> angles{from, to};
    for (int quarter = -4; quarter <= 4; ++quarter)
      if (from <= 90. * quarter && 90. * quarter <= to)
        angles.push_back(90. * quarter);
    std::vector<dealii::Point<2>> places;
    for (const double angle : angles)
      for (const double r : {inner_radius, radius})
        places.push_back(at(r, angle));
    return dealii::BoundingBox<2>(places);
  }

  Moments<2>
  Ring::moments() const
  {
    // int r^n dr times integrals of 1, cos, sin, cos^2, sin^2, cos sin over the angle.
    const double a = from * degree, b = to * degree;
    const auto power = [&](const int n) { return (std::pow(radius, n + 1) - std::pow(inner_radius, n + 1)) / (n + 1); };
    const double twice = .25 * (std::sin(2. * b) - std::sin(2. * a));
    Moments<2>   result;
    result.volume = (to - from) / 360. * dealii::numbers::PI * (std::pow(radius, 2) - std::pow(inner_radius, 2));
    const auto c  = power(2) / result.volume *
                   dealii::Tensor<1, 2>({std::sin(b) - std::sin(a), std::cos(a) - std::cos(b)});
    result.centroid     = centre + c;
    result.second[0][0] = power(3) * (.5 * (b - a) + twice);
    result.second[1][1] = power(3) * (.5 * (b - a) - twice);
    result.second[0][1] = power(3) * .25 * (std::cos(2. * a) - std::cos(2. * b));
    result.second -= result.volume * symmetrize(outer_product(c, c));
    return result;
  }

  std::vector<Facet<2>>
  Ring::facets(const double size) const
  {
    std::vector<Facet<2>> all;
    const auto            arc = [&](const double r, const double first, const double last) {
      const double step = 2. * std::asin(std::min(1., size / (2. * r))) / degree;
      const auto   n = static_cast<unsigned int>(std::ceil(std::abs(last - first) / std::min(step, 90.) - 1e-9));
      for (unsigned int i = 0; i < n; ++i)
        all.push_back({{{at(r, first + (last - first) * i / n), at(r, first + (last - first) * (i + 1) / n)}}});
    };
    arc(radius, from, to);
    arc(inner_radius, to, from);
    if (to - from == 360.)
      return all;
    const auto ends     = {Facet<2>{{{at(inner_radius, from), at(radius, from)}}},
                           Facet<2>{{{at(radius, to), at(inner_radius, to)}}}};
    const auto straight = split_to_size(std::vector<Facet<2>>(ends), size);
    all.insert(all.end(), straight.begin(), straight.end());
    return all;
  }
} // namespace Stroma::Shapes
