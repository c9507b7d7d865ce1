#pragma once

#include <stroma/particles/arrangement.h>

#include <cmath>

namespace Stroma::Particles
{
  /// Volume of a site times the sum of @p f(distance) over the sites within @p reach of one, itself included, of the lattice of
  /// this name: an integral of f but for the sum being none. Relaxed particles in the plane are nearly hexagonal.
  template <int dim, typename Function>
  double
  lattice_sum(const double reach, const double dp, const ArrangementName name, const Function &f)
  {
    const bool   hexagonal = name == ArrangementName::hexagonal || (dim == 2 && name == ArrangementName::voronoi);
    const double row = hexagonal ? std::sqrt(.75) : 1., layer = hexagonal ? std::sqrt(2. / 3.) : 1.;
    const int    n   = static_cast<int>(reach / dp / layer) + 2;
    const int    n_z = dim == 3 ? n : 0;
    double       sum = 0.;
    for (int c = -n_z; c <= n_z; ++c)
      for (int b = -n; b <= n; ++b)
        for (int a = -n; a <= n; ++a)
          {
            // Odd rows are shifted by half a spacing, odd layers into the hollows of the even ones.
            const double shift = hexagonal ? .5 * (std::abs(b) % 2 + std::abs(c) % 2) : 0.;
            const double x = a + shift, y = row * (b + (hexagonal ? std::abs(c) % 2 / 3. : 0.)), z = layer * c;
            sum += f(dp * std::sqrt(x * x + y * y + z * z));
          }
    return sum * std::pow(dp, dim) * row * (dim == 3 ? layer : 1.);
  }
} // namespace Stroma::Particles
