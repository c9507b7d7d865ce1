#include <stroma/shapes/triangulation.h>

#include <stroma/shapes/box.h>
#include <stroma/shapes/table.h>

#include <algorithm>

namespace Stroma::Shapes
{
  template <int dim>
  std::shared_ptr<const Shape<dim>>
  Box<dim>::read(Parameters &p, MPI_Comm)
  {
    const auto lower = read_point<dim>(p, "Lower corner", "corner with the smallest coordinates", 0.);
    const auto upper = read_point<dim>(p, "Upper corner", "corner with the largest coordinates", 1.);
    for (unsigned int d = 0; d < dim; ++d)
      if (lower[d] >= upper[d] && p.get_mode() == Parameters::Mode::read)
        throw UserError(p.where("Upper corner"), "'Upper corner' must lie above 'Lower corner' in every direction");
    return std::make_shared<Box>(lower, upper);
  }

  template <int dim>
  Nearest<dim>
  Box<dim>::nearest(const dealii::Point<dim> &X) const
  {
    Nearest<dim> result;
    unsigned int nearest_axis = 0;
    double       largest_gap  = 0.; // beyond the nearest side, negative inside
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double gap = std::max(lower[d] - X[d], X[d] - upper[d]);
        if (d == 0 || gap > largest_gap)
          {
            largest_gap  = gap;
            nearest_axis = d;
          }
        result.foot[d] = std::clamp(X[d], lower[d], upper[d]);
      }
    result.distance = X.distance(result.foot);
    if (result.distance > 0)
      result.normal = (X - result.foot) / result.distance;
    else
      {
        const bool is_low           = lower[nearest_axis] - X[nearest_axis] == largest_gap;
        result.normal[nearest_axis] = is_low ? -1. : 1.;
        result.foot[nearest_axis]   = is_low ? lower[nearest_axis] : upper[nearest_axis];
        result.distance             = largest_gap;
      }
    return result;
  }

  template <int dim>
  bool
  Box<dim>::contains(const dealii::Point<dim> &X) const
  {
    return bounding_box().point_inside(X);
  }

  template <int dim>
  dealii::BoundingBox<dim>
  Box<dim>::bounding_box() const
  {
    return dealii::BoundingBox<dim>({lower, upper});
  }

  template <int dim>
  Moments<dim>
  Box<dim>::moments() const
  {
    Moments<dim> result;
    result.volume   = bounding_box().volume();
    result.centroid = bounding_box().center();
    for (unsigned int d = 0; d < dim; ++d)
      result.second[d][d] = result.volume / 12. * (upper[d] - lower[d]) * (upper[d] - lower[d]);
    return result;
  }

  template <int dim>
  std::vector<Facet<dim>>
  Box<dim>::facets(const double size) const
  {
    std::vector<Facet<dim>> sides;
    if constexpr (dim == 2)
      for (const auto &[i, j] : {std::pair(0u, 1u), std::pair(1u, 3u), std::pair(3u, 2u), std::pair(2u, 0u)})
        sides.push_back({{{bounding_box().vertex(i), bounding_box().vertex(j)}}});
    else
      for (unsigned int axis = 0; axis < 3; ++axis)
        for (const bool high : {false, true})
          {
            // The side's corners, anticlockwise as seen from outside.
            const unsigned int s = 1u << (axis + 1) % 3, t = 1u << (axis + 2) % 3, first = high ? 1u << axis : 0u;
            const auto         at = [&](const unsigned int v) { return bounding_box().vertex(first + v); };
            const auto         p = high ? s : t, q = high ? t : s;
            sides.push_back({{{at(0), at(p), at(p + q)}}});
            sides.push_back({{{at(0), at(p + q), at(q)}}});
          }
    return split_to_size(sides, size);
  }

  template class Box<2>;
  template class Box<3>;
} // namespace Stroma::Shapes
