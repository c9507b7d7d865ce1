#include <stroma/shapes/triangulation.h>

#include <stroma/shapes/ball.h>
#include <stroma/shapes/table.h>

#include <cmath>

namespace Stroma::Shapes
{
  template <int dim>
  std::shared_ptr<const Shape<dim>>
  Ball<dim>::read(Parameters &p, MPI_Comm)
  {
    const auto centre = read_point<dim>(p, "Centre", "centre", 0.);
    double     radius = std::nan("");
    p.add("Radius", radius, "radius", "m", Range::positive());
    return std::make_shared<Ball>(centre, radius);
  }

  template <int dim>
  Nearest<dim>
  Ball<dim>::nearest(const dealii::Point<dim> &X) const
  {
    const dealii::Tensor<1, dim> d = X - centre;
    const double                 r = d.norm();
    Nearest<dim>                 result;
    result.normal    = r > 0 ? d / r : dealii::Tensor<1, dim>(dealii::Point<dim>::unit_vector(0));
    result.foot      = centre + radius * result.normal;
    result.distance  = r - radius;
    result.curvature = r > 0 ? 1. / r : 0.;
    return result;
  }

  template <int dim>
  bool
  Ball<dim>::contains(const dealii::Point<dim> &X) const
  {
    return X.distance(centre) <= radius;
  }

  template <int dim>
  dealii::BoundingBox<dim>
  Ball<dim>::bounding_box() const
  {
    dealii::Point<dim> lower = centre, upper = centre;
    for (unsigned int d = 0; d < dim; ++d)
      {
        lower[d] -= radius;
        upper[d] += radius;
      }
    return dealii::BoundingBox<dim>({lower, upper});
  }

  template <int dim>
  Moments<dim>
  Ball<dim>::moments() const
  {
    constexpr double pi     = dealii::numbers::PI;
    const double     volume = dim == 2 ? pi * std::pow(radius, 2) : 4. / 3. * pi * std::pow(radius, 3);
    return {volume, centre, volume * radius * radius / (dim + 2) * dealii::unit_symmetric_tensor<dim>()};
  }

  /// A regular polygon, or the triangles of an icosahedron, split alike until they are small enough and moved out to the sphere.
  template <int dim>
  std::vector<Facet<dim>>
  Ball<dim>::facets(const double size) const
  {
    std::vector<Facet<dim>> all;
    if constexpr (dim == 2)
      {
        const double step = 2. * std::asin(std::min(1., size / (2. * radius)));
        const auto   n    = static_cast<unsigned int>(std::max(3., std::ceil(2. * dealii::numbers::PI / step - 1e-9)));
        const auto   at   = [&](const unsigned int i) {
          const double angle = 2. * dealii::numbers::PI * (i % n) / n;
          return dealii::Point<2>(centre[0] + radius * std::cos(angle), centre[1] + radius * std::sin(angle));
        };
        for (unsigned int i = 0; i < n; ++i)
          all.push_back({{{at(i), at(i + 1)}}});
      }
    else
      {
        double longest = 0.;
        for (unsigned int n = 1; all.empty() || longest > size; n = std::max(n + 1, unsigned(n * longest / size)))
          {
            all.clear();
            longest = 0.;
            for (const auto &triangle : unit_icosahedron())
              for (auto &piece : split(triangle, n))
                {
                  for (auto &corner : piece.corners)
                    corner = centre + radius / corner.norm() * corner;
                  longest = std::max(longest, longest_edge(piece));
                  all.push_back(piece);
                }
          }
      }
    return all;
  }

  template class Ball<2>;
  template class Ball<3>;
} // namespace Stroma::Shapes
