#include <stroma/base/memory.h>
#include <stroma/base/on_root.h>
#include <stroma/base/text.h>
#include <stroma/shapes/faceted.h>

#include <filesystem>
#include <map>

#include "self_crossing.h"
#include "shape_file.h"

namespace Stroma::Shapes
{
  namespace
  {
    constexpr double bytes_per_triangle = 1500.; ///< of text, corners, tree and normals, while they are made

    std::string
    text_of(const dealii::Point<3> &X)
    {
      return "(" + brief(X[0]) + ", " + brief(X[1]) + ", " + brief(X[2]) + ")";
    }

    Facet<3>
    facet_of(const Triangles &all, const std::array<unsigned int, 3> &corners)
    {
      return {{{all.vertices[corners[0]], all.vertices[corners[1]], all.vertices[corners[2]]}}};
    }

    /// Why an edge has not one triangle on either side, with normals to the same side of the surface; empty if all have.
    std::string
    what_is_open(const Triangles &all)
    {
      std::map<std::array<unsigned int, 2>, std::array<unsigned int, 2>> edges; // low, high -> uses upwards, downwards
      for (const auto &corners : all.corners)
        for (unsigned int i = 0; i < 3; ++i)
          {
            const unsigned int a = corners[i], b = corners[(i + 1) % 3];
            ++edges[{{std::min(a, b), std::max(a, b)}}][a > b];
          }
      for (const auto &[edge, uses] : edges)
        {
          const std::string place = text_of(all.vertices[edge[0]]) + " to " + text_of(all.vertices[edge[1]]);
          if (uses[0] + uses[1] != 2)
            return "the surface is not closed: the edge from " + place + " belongs to " +
                   counted(uses[0] + uses[1], "triangle") + " instead of two; mend the mesh";
          if (uses[0] != 1)
            return "the two triangles at the edge from " + place +
                   " go round in different ways; make all go round anticlockwise as seen from outside";
        }
      return "";
    }

    std::string
    what_is_wrong(const Triangles &all)
    {
      if (all.corners.empty())
        return "there is no triangle in it";
      double volume = 0.;
      for (const auto &corners : all.corners)
        {
          const auto facet = facet_of(all, corners);
          if (!(facet.area_vector().norm() > 1e-12 * std::pow(facet.corners[0].distance(facet.corners[1]), 2)))
            return "the triangle at " + text_of(facet.centre()) + " has no area; mend the mesh";
          volume += (facet.corners[0] - all.vertices[0]) * facet.area_vector() / 3.;
        }
      if (const auto message = what_is_open(all); !message.empty())
        return message;
      if (!(volume > 0.))
        return "the surface is inside out: its triangles must go round anticlockwise as seen from outside";
      const auto crossing = self_crossing(all);
      return crossing ? "the surface crosses itself at " + text_of(*crossing) + "; mend the mesh" : "";
    }

    void
    broadcast(Triangles &all, const MPI_Comm comm)
    {
      using dealii::Utilities::MPI::broadcast;
      std::array<std::size_t, 2> n{{all.vertices.size(), all.corners.size()}};
      n = broadcast(comm, n, 0);
      all.vertices.resize(n[0]);
      all.corners.resize(n[1]);
      std::vector<double> x;
      for (const auto &vertex : all.vertices)
        x.insert(x.end(), vertex.begin_raw(), vertex.end_raw());
      broadcast(x.data(), x.size(), 0, comm);
      for (std::size_t i = 0; i < n[0]; ++i)
        std::copy_n(x.begin() + 3 * i, 3, all.vertices[i].begin_raw());
      broadcast(all.corners.data()->data(), 3 * n[1], 0, comm);
    }
  } // namespace

  std::shared_ptr<const Surface>
  make_surface(const Triangles &all)
  {
    if (const auto message = what_is_wrong(all); !message.empty())
      throw UserError(message);
    return std::make_shared<Surface>(all.vertices, all.corners);
  }

  std::shared_ptr<const Shape<3>>
  read_surface(Parameters &p, const MPI_Comm comm)
  {
    std::string path;
    double      unit = p.si_factor("m");
    p.add_file("File", path, "closed surface of triangles (STL), found from here or from this file's folder", "");
    add_length_unit(p, unit);
    if (p.get_mode() == Parameters::Mode::document) // the file is not read: any surface
      return std::make_shared<Surface>(
        std::vector<dealii::Point<3>>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
        std::vector<Surface::Corners>{{{0, 2, 1}}, {{0, 1, 3}}, {{1, 2, 3}}, {{0, 3, 2}}});
    Triangles all;
    on_root(comm, [&] {
      std::error_code code;
      const auto      n_bytes = std::filesystem::file_size(path, code);
      try
        {
          constexpr double bytes_of_one = 50.; // a triangle in a binary file
          Memory::require_here(code ? 0. : n_bytes / bytes_of_one * bytes_per_triangle, "", "a surface of that size");
          all = read_stl(bytes_of(path));
          if (const auto message = what_is_wrong(all); !message.empty())
            throw UserError(message);
          for (auto &vertex : all.vertices)
            vertex *= unit;
        }
      catch (const UserError &error)
        {
          throw UserError(p.where("File"), shown(path) + ": " + error.what());
        }
    });
    broadcast(all, comm);
    return std::make_shared<Surface>(all.vertices, all.corners, true);
  }
} // namespace Stroma::Shapes
