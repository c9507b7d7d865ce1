#pragma once

#include <stroma/base/parameters.h>
#include <stroma/shapes/shape.h>

#include <memory>

namespace Stroma::Shapes
{
  /// A ball, or a disk in 2D.
  template <int dim>
  class Ball : public Shape<dim>
  {
  public:
    Ball(const dealii::Point<dim> &centre, const double radius)
      : centre(centre)
      , radius(radius)
    {}

    /// Declares and reads its entries.
    static std::shared_ptr<const Shape<dim>> read(Parameters &p, MPI_Comm comm);

    Nearest<dim>             nearest(const dealii::Point<dim> &X) const override;
    bool                     contains(const dealii::Point<dim> &X) const override;
    dealii::BoundingBox<dim> bounding_box() const override;
    Moments<dim>             moments() const override;
    std::vector<Facet<dim>>  facets(double size) const override;

    const dealii::Point<dim> centre; ///< [m]
    const double             radius; ///< [m]
  };
} // namespace Stroma::Shapes
