#include <stroma/base/memory.h>
#include <stroma/base/on_root.h>
#include <stroma/base/text.h>
#include <stroma/shapes/faceted.h>
#include <stroma/shapes/polyline.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "shape_file.h"

namespace Stroma::Shapes
{
  namespace
  {
    using Places = std::vector<dealii::Point<2>>;

    /// Twice the area of the triangle a, b, c; positive if they go round anticlockwise.
    double
    turn(const dealii::Point<2> &a, const dealii::Point<2> &b, const dealii::Point<2> &c)
    {
      return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    }

    /// Whether the segments a b and c d have a place in common.
    bool
    meet(const dealii::Point<2> &a, const dealii::Point<2> &b, const dealii::Point<2> &c, const dealii::Point<2> &d)
    {
      for (unsigned int axis = 0; axis < 2; ++axis)
        if (std::max(a[axis], b[axis]) < std::min(c[axis], d[axis]) ||
            std::max(c[axis], d[axis]) < std::min(a[axis], b[axis]))
          return false;
      return turn(a, b, c) * turn(a, b, d) <= 0 && turn(c, d, a) * turn(c, d, b) <= 0;
    }

    double
    twice_the_area(const Places &x)
    {
      double sum = 0;
      for (std::size_t i = 1; i + 1 < x.size(); ++i)
        sum += turn(x[0], x[i], x[i + 1]);
      return sum;
    }

    std::string
    named(const std::size_t i, const std::size_t n)
    {
      return std::to_string(i + 1) + "-" + std::to_string((i + 1) % n + 1);
    }

    /// Why these are not the corners of a simple polygon, anticlockwise; empty if they are.
    std::string
    what_is_wrong(const Places &x)
    {
      const std::size_t n = x.size();
      for (std::size_t i = 0; i < n; ++i)
        {
          const auto &a = x[i], &b = x[(i + 1) % n], &c = x[(i + 2) % n];
          if (a == b)
            return "corners " + named(i, n) + " are at the same place; give one of them";
          if (turn(a, b, c) == 0 && (b - a) * (c - b) < 0)
            return "edge " + named((i + 1) % n, n) + " goes back along edge " + named(i, n) +
                   "; a polygon's edges may meet at its corners only";
        }
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i + 2; j < n; ++j)
          if ((j + 1) % n != i && meet(x[i], x[i + 1], x[j], x[(j + 1) % n]))
            return "edges " + named(i, n) + " and " + named(j, n) +
                   " cross; a polygon's edges may meet at its corners only";
      if (!(twice_the_area(x) > 0))
        return "the corners must go round anticlockwise";
      return "";
    }

    /// Memory of a corner of a file: its text, places, edges with normals and their tree.
    constexpr double bytes_per_corner = 700.;

    std::shared_ptr<const Shape<2>>
    read_polygon_of_file(Parameters &p, const MPI_Comm comm)
    {
      if (p.given("Corners"))
        throw UserError(p.where("Corners"), "a polygon has 'Corners' or a 'File'; remove one of them");
      std::string path;
      double      unit = p.si_factor("m");
      p.add_file(
        "File", path,
        "closed polyline: a line 'x, y' for each corner, anticlockwise, the first one again at the end; found from "
        "here or from this file's folder",
        "");
      add_length_unit(p, unit);
      if (p.get_mode() == Parameters::Mode::document) // the file is not read: any polygon
        return make_polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
      Places corners;
      on_root(comm, [&] {
        std::error_code code;
        const auto      n_bytes = std::filesystem::file_size(path, code);
        try
          {
            constexpr double bytes_of_one = 4.; // the shortest line
            Memory::require_here(code ? 0. : n_bytes / bytes_of_one * bytes_per_corner, "", "a polyline of that size");
            corners = read_polyline(bytes_of(path));
            if (const auto message = what_is_wrong(corners); !message.empty())
              throw UserError(message);
            for (auto &corner : corners)
              corner *= unit;
          }
        catch (const UserError &error)
          {
            throw UserError(p.where("File"), shown(path) + ": " + error.what());
          }
      });
      auto n = corners.size();
      n      = dealii::Utilities::MPI::broadcast(comm, n, 0);
      corners.resize(n);
      dealii::Utilities::MPI::broadcast(corners.data()->begin_raw(), 2 * n, 0, comm);
      return make_polygon(corners, true);
    }

    Places
    read_corners(Parameters &p, const std::string &meaning, const unsigned int n_numbers)
    {
      std::vector<double> given(n_numbers, std::nan(""));
      p.add("Corners", given, meaning, "m", Range::any(), n_numbers);
      if (p.get_mode() == Parameters::Mode::document)
        return {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
      if (given.size() % 2 != 0 || given.size() < 6)
        throw UserError(p.where("Corners"),
                        "'Corners' takes x, y of at least three corners, not " + counted(given.size(), "number"));
      Places corners;
      for (std::size_t i = 0; i < given.size(); i += 2)
        corners.emplace_back(given[i], given[i + 1]);
      return corners;
    }
  } // namespace

  std::shared_ptr<const Polygon>
  make_polygon(const std::vector<dealii::Point<2>> &corners, const bool is_of_file)
  {
    if (const auto message = what_is_wrong(corners); !message.empty())
      throw UserError(message);
    std::vector<Polygon::Corners> edges;
    for (unsigned int i = 0; i < corners.size(); ++i)
      edges.push_back({{i, (i + 1) % static_cast<unsigned int>(corners.size())}});
    return std::make_shared<Polygon>(corners, edges, is_of_file);
  }

  bool
  is_convex(const std::vector<dealii::Point<2>> &x)
  {
    const std::size_t n = x.size();
    for (std::size_t i = 0; i < n; ++i)
      if (!(turn(x[i], x[(i + 1) % n], x[(i + 2) % n]) > 0))
        return false;
    return true;
  }

  std::shared_ptr<const Shape<2>>
  read_polygon(Parameters &p, const MPI_Comm comm)
  {
    const bool documenting = p.get_mode() == Parameters::Mode::document;
    if (p.given("File") || (documenting && !p.given("Corners")))
      if (const auto polygon = read_polygon_of_file(p, comm); !documenting)
        return polygon;
    const auto corners = read_corners(p, "x, y of each corner, anticlockwise; or give a 'File'", 0);
    if (const auto message = what_is_wrong(corners); !message.empty())
      throw UserError(p.where("Corners"), message);
    return make_polygon(corners);
  }

  std::shared_ptr<const Shape<2>>
  read_quadrilateral(Parameters &p, MPI_Comm)
  {
    const auto corners = read_corners(p, "x, y of the four corners, anticlockwise", 8);
    if (!is_convex(corners))
      throw UserError(p.where("Corners"), "'Corners' must go round anticlockwise and be convex");
    return make_polygon(corners);
  }
} // namespace Stroma::Shapes
