#pragma once

#include <stroma/base/parameters.h>
#include <stroma/shapes/shape.h>

#include <memory>

namespace Stroma::Shapes
{
  /// Sector of a plane ring.
  class Ring : public Shape<2>
  {
  public:
    /// Radii [m]; @p from and @p to anticlockwise from x [degrees], by less than 360.
    Ring(const dealii::Point<2> &centre, const double inner_radius, const double radius, const double from,
         const double to)
      : centre(centre)
      , inner_radius(inner_radius)
      , radius(radius)
      , from(from)
      , to(to)
    {}

    /// Declares and reads its entries.
    static std::shared_ptr<const Shape<2>> read(Parameters &p, MPI_Comm comm);

    Nearest<2>             nearest(const dealii::Point<2> &X) const override;
    bool                   contains(const dealii::Point<2> &X) const override;
    dealii::BoundingBox<2> bounding_box() const override;
    Moments<2>             moments() const override;
    std::vector<Facet<2>>  facets(double size) const override;

    /// The place at radius @p r and @p angle [degrees]: exactly on the axes at whole quarters, so that sides there are found.
    dealii::Point<2> at(double r, double angle) const;

    const dealii::Point<2> centre;               ///< [m]
    const double           inner_radius, radius; ///< [m]
    const double           from, to;             ///< [degrees]
  };
} // namespace Stroma::Shapes
