#include <stroma/base/text.h>
#include <stroma/scene/region.h>

#include <algorithm>

namespace Stroma
{
  namespace
  {
    template <int dim>
    std::string
    grammar()
    {
      const std::string point = dim == 2 ? "x, y" : "x, y, z";
      return "'side y-min', 'layer y-max THICKNESS', 'box " + point + " : " + point + "', 'ball " + point +
             " : RADIUS', 'material NAME', 'nearest " + point + "', 'rim " + point +
             " : RADIUS', 'body NAME' or 'all'";
    }

    template <int dim>
    dealii::Point<dim>
    parse_point(const Parameters &p, const std::string &text)
    {
      const auto parts = split(text, ',');
      if (parts.size() != dim)
        throw UserError("wrong number of coordinates");
      dealii::Point<dim> point;
      for (unsigned int d = 0; d < dim; ++d)
        point[d] = p.parse_number("Where", parts[d], "m");
      return point;
    }

    unsigned int
    index_of(const std::string &name, const std::vector<std::string> &names)
    {
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end())
        throw UserError("unknown name");
      return found - names.begin();
    }
  } // namespace

  template <int dim>
  void
  Region<dim>::add(Parameters &p, const SceneNames &names)
  {
    p.add("Where", text, "where it acts: " + grammar<dim>(), true);
    if (text.empty())
      return;
    try
      {
        const auto        space = text.find(' ');
        const std::string word  = text.substr(0, space);
        const std::string rest  = space == std::string::npos ? "" : trim(text.substr(space));
        const auto        parts = split(rest, ':');
        const auto        read_side = [&](const std::string &name) {
          axis  = std::string("xyz").find(name.at(0));
          upper = name.substr(1) == "-max";
          if (axis >= dim || (!upper && name.substr(1) != "-min"))
            throw UserError("unknown side");
        };
        const auto require = [](const bool right) {
          if (!right)
            throw UserError("wrong number of parts");
        };
        if (word == "all" && rest.empty())
          kind = Kind::all;
        else if (word == "side")
          {
            kind = Kind::side;
            read_side(rest);
          }
        else if (word == "layer")
          {
            kind           = Kind::layer;
            const auto gap = rest.find(' ');
            require(gap != std::string::npos);
            read_side(rest.substr(0, gap));
            extent = p.parse_number("Where", trim(rest.substr(gap)), "m", Range::positive());
          }
        else if (word == "box")
          {
            kind = Kind::box;
            require(parts.size() == 2);
            first  = parse_point<dim>(p, parts.at(0));
            second = parse_point<dim>(p, parts.at(1));
          }
        else if (word == "ball" || word == "rim")
          {
            kind = word == "ball" ? Kind::ball : Kind::rim;
            require(parts.size() == 2);
            first  = parse_point<dim>(p, parts.at(0));
            extent = p.parse_number("Where", parts.at(1), "m", Range::positive());
          }
        else if (word == "material")
          {
            kind     = Kind::material;
            material = index_of(rest, names.materials);
          }
        else if (word == "body")
          {
            kind = Kind::body;
            body = index_of(rest, names.bodies);
          }
        else if (word == "nearest")
          {
            kind  = Kind::nearest;
            first = parse_point<dim>(p, rest);
          }
        else
          throw UserError("unknown region");
      }
    catch (const std::exception &)
      {
        throw UserError(p.where("Where"), "'Where' was given as '" + shown(text) + "'; it must be one of " + grammar<dim>() +
                                            " (materials: " + join(names.materials, ", ") + "; bodies: " + join(names.bodies, ", ") + ")");
      }
    for (unsigned int d = 0; d < dim && kind == Kind::box; ++d)
      if (first[d] > second[d])
        throw UserError(p.where("Where"), "'Where' was given as '" + text + "', but the first corner of a box must lie below " +
                                            "the second in every direction");
  }

  template <int dim>
  double
  Region<dim>::side_coordinate(const dealii::BoundingBox<dim> &bodies) const
  {
    const auto &corners = bodies.get_boundary_points();
    return upper ? corners.second[axis] : corners.first[axis];
  }

  template <int dim>
  bool
  Region<dim>::on_side(const dealii::Point<dim> &X, const dealii::BoundingBox<dim> &bodies, const double tolerance) const
  {
    return std::abs(X[axis] - side_coordinate(bodies)) <= tolerance;
  }

  template <int dim>
  bool
  Region<dim>::on_boundary(const dealii::Point<dim> &X, const dealii::BoundingBox<dim> &bodies,
                           const double tolerance) const
  {
    return kind == Kind::side ? on_side(X, bodies, tolerance) :
                                kind == Kind::rim && std::abs(X.distance(first) - extent) <= tolerance;
  }

  template <int dim>
  bool
  Region<dim>::contains(const dealii::Point<dim> &X, const unsigned int of_material,
                        const dealii::BoundingBox<dim> &bodies) const
  {
    // The edges of regions belong to them, up to round-off.
    double size = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      size = std::max(size, bodies.side_length(d));
    const double tolerance = 1e-9 * size;
    switch (kind)
      {
        case Kind::all:
          return true;
        case Kind::layer:
          return std::abs(X[axis] - side_coordinate(bodies)) <= extent + tolerance;
        case Kind::box:
          {
            bool inside = true;
            for (unsigned int d = 0; d < dim; ++d)
              inside &= X[d] >= first[d] - tolerance && X[d] <= second[d] + tolerance;
            return inside;
          }
        case Kind::ball:
          return X.distance(first) <= extent + tolerance;
        case Kind::material:
          return of_material == material;
        case Kind::side:
        case Kind::nearest:
        case Kind::rim:
        case Kind::body:
          return false;
      }
    return false;
  }

  template class Region<2>;
  template class Region<3>;
} // namespace Stroma
