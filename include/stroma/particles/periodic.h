#pragma once

#include <deal.II/base/bounding_box.h>

#include <array>
#include <cmath>

namespace Stroma::Particles
{
  /// @p x, shifted by whole periods into the @p domain, whose upper end is its lower one along a periodic direction.
  template <int dim>
  dealii::Point<dim>
  folded(dealii::Point<dim> x, const dealii::BoundingBox<dim> &domain, const std::array<bool, dim> &periodic)
  {
    for (unsigned int d = 0; d < dim; ++d)
      if (const double lower = domain.lower_bound(d), upper = domain.upper_bound(d);
          periodic[d] && !(x[d] >= lower && x[d] < upper))
        {
          x[d] -= (upper - lower) * std::floor((x[d] - lower) / (upper - lower));
          if (!(x[d] >= lower && x[d] < upper)) // by rounding
            x[d] = lower;
        }
    return x;
  }
} // namespace Stroma::Particles
