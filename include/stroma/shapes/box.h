#pragma once

#include <stroma/base/parameters.h>
#include <stroma/shapes/shape.h>

#include <memory>

namespace Stroma::Shapes
{
  /// A box along the axes.
  template <int dim>
  class Box : public Shape<dim>
  {
  public:
    Box(const dealii::Point<dim> &lower, const dealii::Point<dim> &upper)
      : lower(lower)
      , upper(upper)
    {}

    /// Declares and reads its entries.
    static std::shared_ptr<const Shape<dim>> read(Parameters &p, MPI_Comm comm);

    Nearest<dim>             nearest(const dealii::Point<dim> &X) const override;
    bool                     contains(const dealii::Point<dim> &X) const override;
    dealii::BoundingBox<dim> bounding_box() const override;
    Moments<dim>             moments() const override;
    std::vector<Facet<dim>>  facets(double size) const override;

    const dealii::Point<dim> lower, upper; ///< corners [m]
  };
} // namespace Stroma::Shapes
