#pragma once

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/point.h>
#include <deal.II/base/symmetric_tensor.h>

#include <array>
#include <vector>

namespace Stroma::Shapes
{
  /// What a shape's surface is as seen from a place X.
  template <int dim>
  struct Nearest
  {
    dealii::Point<dim>     foot;          ///< the place of the surface that is nearest to X [m]
    dealii::Tensor<1, dim> normal;        ///< gradient of the distance at X: outward, of length 1
    double                 distance  = 0; ///< of X from the foot, negative inside [m]
    double                 curvature = 0; ///< k in dn/dX = k (I - n n) [1/m]; 0 where the surface is flat
  };

  /// Volume of a shape (area in 2D), and its first and second moments.
  template <int dim>
  struct Moments
  {
    double                          volume = 0; ///< [m^dim]
    dealii::Point<dim>              centroid;   ///< c [m]
    dealii::SymmetricTensor<2, dim> second;     ///< int (X - c)(X - c) dV [m^(dim+2)]
  };

  /// Piece of a surface: a segment with the shape on its left, or a triangle that goes round anticlockwise as seen from outside.
  template <int dim>
  struct Facet
  {
    std::array<dealii::Point<dim>, dim> corners;

    dealii::Point<dim>
    centre() const
    {
      dealii::Point<dim> sum;
      for (const auto &corner : corners)
        sum += corner / dim;
      return sum;
    }

    /// Outward normal times the facet's length or area [m^(dim-1)].
    dealii::Tensor<1, dim>
    area_vector() const
    {
      if constexpr (dim == 2)
        return dealii::cross_product_2d(corners[1] - corners[0]);
      else
        return .5 * dealii::cross_product_3d(corners[1] - corners[0], corners[2] - corners[0]);
    }
  };

  /// A solid shape, the same on all ranks. Its queries are local.
  template <int dim>
  class Shape
  {
  public:
    virtual ~Shape() = default;

    /// The nearest place of the surface and the signed distance from it.
    virtual Nearest<dim> nearest(const dealii::Point<dim> &X) const = 0;

    /// Whether the shape, with its surface, takes up @p X.
    virtual bool contains(const dealii::Point<dim> &X) const = 0;

    virtual dealii::BoundingBox<dim> bounding_box() const = 0;

    virtual Moments<dim> moments() const = 0;

    /// The surface in facets with edges of at most @p size [m], which cover it once, though neighbours need not share corners.
    /// Where it is curved, the corners lie on it.
    virtual std::vector<Facet<dim>> facets(double size) const = 0;

    /// Negative inside [m].
    double
    distance(const dealii::Point<dim> &X) const
    {
      return nearest(X).distance;
    }

    /// Volume, or area in 2D [m^dim].
    double
    volume() const
    {
      return moments().volume;
    }
  };
} // namespace Stroma::Shapes
