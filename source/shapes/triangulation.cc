#include <stroma/shapes/triangulation.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Shapes
{
  template <int dim>
  double
  longest_edge(const Facet<dim> &facet)
  {
    double longest = 0.;
    for (unsigned int i = 0; i < dim; ++i)
      longest = std::max(longest, facet.corners[i].distance(facet.corners[(i + 1) % dim]));
    return longest;
  }

  template <int dim>
  std::vector<Facet<dim>>
  split(const Facet<dim> &facet, const unsigned int n)
  {
    const auto             &c = facet.corners;
    std::vector<Facet<dim>> pieces;
    if constexpr (dim == 2)
      {
        const auto at = [&](const unsigned int i) { return i == n ? c[1] : c[0] + double(i) / n * (c[1] - c[0]); };
        for (unsigned int i = 0; i < n; ++i)
          pieces.push_back({{{at(i), at(i + 1)}}});
      }
    else
      {
        const auto at = [&](const unsigned int i, const unsigned int j) {
          return dealii::Point<3>(c[0] + double(i) / n * (c[1] - c[0]) + double(j) / n * (c[2] - c[0]));
        };
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; i + j < n; ++j)
            {
              pieces.push_back({{{at(i, j), at(i + 1, j), at(i, j + 1)}}});
              if (i + j + 1 < n)
                pieces.push_back({{{at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}}});
            }
      }
    return pieces;
  }

  template <int dim>
  std::vector<Facet<dim>>
  split_to_size(const std::vector<Facet<dim>> &facets, const double size)
  {
    std::vector<Facet<dim>> all;
    for (const auto &facet : facets)
      {
        const auto n      = static_cast<unsigned int>(std::max(1., std::ceil(longest_edge(facet) / size - 1e-9)));
        const auto pieces = split(facet, n);
        all.insert(all.end(), pieces.begin(), pieces.end());
      }
    return all;
  }

  std::vector<Facet<3>>
  unit_icosahedron()
  {
    const double                  golden = .5 * (1. + std::sqrt(5.)), r = std::sqrt(1. + golden * golden);
    const double                  a = 1. / r, b = golden / r;
    std::vector<dealii::Point<3>> v;
    for (unsigned int axis = 0; axis < 3; ++axis)
      for (const double s : {-1., 1.})
        for (const double t : {-1., 1.})
          {
            dealii::Point<3> corner;
            corner[(axis + 1) % 3] = s * a;
            corner[(axis + 2) % 3] = t * b;
            v.push_back(corner);
          }
    // Its edges have the length 2 a: any three corners so far from each other are a face.
    const auto is_edge = [&](const unsigned int i, const unsigned int j) { return v[i].distance(v[j]) < 2.1 * a; };
    std::vector<Facet<3>> faces;
    for (unsigned int i = 0; i < v.size(); ++i)
      for (unsigned int j = i + 1; j < v.size(); ++j)
        for (unsigned int k = j + 1; k < v.size(); ++k)
          if (is_edge(i, j) && is_edge(j, k) && is_edge(k, i))
            {
              Facet<3> face{{{v[i], v[j], v[k]}}};
              if (face.area_vector() * face.centre() < 0)
                std::swap(face.corners[1], face.corners[2]);
              faces.push_back(face);
            }
    return faces;
  }

  template double                longest_edge(const Facet<2> &);
  template double                longest_edge(const Facet<3> &);
  template std::vector<Facet<2>> split(const Facet<2> &, unsigned int);
  template std::vector<Facet<3>> split(const Facet<3> &, unsigned int);
  template std::vector<Facet<2>> split_to_size(const std::vector<Facet<2>> &, double);
  template std::vector<Facet<3>> split_to_size(const std::vector<Facet<3>> &, double);
} // namespace Stroma::Shapes
