#pragma once

#include <stroma/shapes/faceted.h>

#include <cstring>
#include <iomanip>
#include <sstream>

/// STL files made byte by byte.
namespace StlFiles
{
  using Facets = std::vector<Stroma::Shapes::Facet<3>>;

  inline std::string
  binary(const Facets &facets)
  {
    std::string bytes(80, ' ');
    const auto  add = [&](const auto value) { bytes.append(reinterpret_cast<const char *>(&value), sizeof(value)); };
    add(static_cast<std::uint32_t>(facets.size()));
    for (const auto &facet : facets)
      {
        for (unsigned int d = 0; d < 3; ++d)
          add(0.f); // the normal, which readers find themselves
        for (const auto &corner : facet.corners)
          for (unsigned int d = 0; d < 3; ++d)
            add(static_cast<float>(corner[d]));
        add(std::uint16_t(0));
      }
    return bytes;
  }

  inline std::string
  ascii(const Facets &facets)
  {
    std::ostringstream text;
    text << std::setprecision(9) << "solid of facets\n";
    for (const auto &facet : facets)
      {
        text << " facet normal 0 0 0\n  outer loop\n";
        for (const auto &corner : facet.corners)
          text << "   vertex " << float(corner[0]) << " " << float(corner[1]) << " " << float(corner[2]) << "\n";
        text << "  endloop\n endfacet\n";
      }
    text << "endsolid of facets\n";
    return text.str();
  }
} // namespace StlFiles
