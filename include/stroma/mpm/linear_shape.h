#pragma once

#include <stroma/solid/lanes.h>

#include <deal.II/base/point.h>

#include <array>

namespace Stroma::Mpm
{
  /// Values and gradients of the linear shape functions S_g of a rectangular cell at a point, all nodes at once.
  template <int dim>
  struct LinearShape
  {
    using L = Solid::Lanes<dim>;

    L                  value;
    std::array<L, dim> gradient; ///< with respect to the place on the grid [1/m]

    /// @param xi place in the unit cell; @param inverse_size 1 / edges of the cell [1/m]
    LinearShape(const dealii::Point<dim> &xi, const dealii::Tensor<1, dim> &inverse_size)
    {
      if constexpr (dim == 2)
        {
          const L x   = {1 - xi[0], xi[0], 1 - xi[0], xi[0]};
          const L y   = {1 - xi[1], 1 - xi[1], xi[1], xi[1]};
          const L dx  = {-inverse_size[0], inverse_size[0], -inverse_size[0], inverse_size[0]};
          const L dy  = {-inverse_size[1], -inverse_size[1], inverse_size[1], inverse_size[1]};
          value       = x * y;
          gradient[0] = dx * y;
          gradient[1] = x * dy;
        }
      else
        {
          const double a = inverse_size[0], b = inverse_size[1], c = inverse_size[2];
          const double p = xi[0], q = xi[1], r = xi[2];
          const L      x  = {1 - p, p, 1 - p, p, 1 - p, p, 1 - p, p};
          const L      y  = {1 - q, 1 - q, q, q, 1 - q, 1 - q, q, q};
          const L      z  = {1 - r, 1 - r, 1 - r, 1 - r, r, r, r, r};
          const L      dx = {-a, a, -a, a, -a, a, -a, a};
          const L      dy = {-b, -b, b, b, -b, -b, b, b};
          const L      dz = {-c, -c, -c, -c, c, c, c, c};
          value           = x * y * z;
          gradient[0]     = dx * y * z;
          gradient[1]     = x * dy * z;
          gradient[2]     = x * y * dz;
        }
    }
  };
} // namespace Stroma::Mpm
