#include <stroma/base/text.h>
#include <stroma/scene/region.h>

#include <algorithm>
#include <map>

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
             " : RADIUS', 'material NAME', 'nearest " + point + "', 'rim " + point + " : RADIUS', 'body NAME' or 'all'";
    }

    template <int dim>
    std::string
    names_of_sides()
    {
      return std::string("x-min, x-max, y-min, y-max") + (dim == 3 ? ", z-min, z-max" : "");
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

    void
    require(const bool right)
    {
      if (!right)
        throw UserError("wrong number of parts");
    }

    template <int dim>
    void
    set_side(Region<dim> &region, const std::string &name)
    {
      region.axis  = std::string("xyz").find(name.at(0));
      region.upper = name.substr(1) == "-max";
      if (region.axis >= dim || (!region.upper && name.substr(1) != "-min"))
        throw UserError("unknown side");
    }

    template <int dim>
    void
    set_layer(Region<dim> &region, const Parameters &p, const std::string &rest)
    {
      const auto gap = rest.find(' ');
      require(gap != std::string::npos);
      set_side(region, rest.substr(0, gap));
      region.extent = p.parse_number("Where", trim(rest.substr(gap)), "m", Range::positive());
    }

    /// What the text of a region means. Throws exceptions of any kind where it means nothing.
    template <int dim>
    void
    parse(Region<dim> &region, const Parameters &p, const SceneNames &names)
    {
      using Kind                                     = typename Region<dim>::Kind;
      static const std::map<std::string, Kind> kinds = {{"all", Kind::all},           {"side", Kind::side},
                                                        {"layer", Kind::layer},       {"box", Kind::box},
                                                        {"ball", Kind::ball},         {"rim", Kind::rim},
                                                        {"material", Kind::material}, {"body", Kind::body},
                                                        {"nearest", Kind::nearest}};
      const auto                               space = region.text.find(' ');
      const std::string                        rest = space == std::string::npos ? "" : trim(region.text.substr(space));
      const auto                               parts = split(rest, ':');
      region.kind                                    = kinds.at(region.text.substr(0, space));
      switch (region.kind)
        {
          case Kind::all:
            return require(rest.empty());
          case Kind::side:
            return set_side(region, rest);
          case Kind::layer:
            return set_layer(region, p, rest);
          case Kind::box:
            require(parts.size() == 2);
            region.first  = parse_point<dim>(p, parts[0]);
            region.second = parse_point<dim>(p, parts[1]);
            return;
          case Kind::ball:
          case Kind::rim:
            require(parts.size() == 2);
            region.first  = parse_point<dim>(p, parts[0]);
            region.extent = p.parse_number("Where", parts[1], "m", Range::positive());
            return;
          case Kind::material:
            region.material = index_of(rest, names.materials);
            return;
          case Kind::body:
            region.body = index_of(rest, names.bodies);
            return;
          case Kind::nearest:
            region.first = parse_point<dim>(p, rest);
            return;
        }
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
        parse(*this, p, names);
      }
    catch (const std::exception &)
      {
        throw UserError(p.where("Where"), "'Where' was given as '" + shown(text) + "'; it must be one of " +
                                            grammar<dim>() + " (sides: " + names_of_sides<dim>() +
                                            "; materials: " + join(names.materials, ", ") +
                                            "; bodies: " + join(names.bodies, ", ") + ")");
      }
    for (unsigned int d = 0; d < dim && kind == Kind::box; ++d)
      if (first[d] > second[d])
        throw UserError(p.where("Where"), "'Where' was given as '" + text +
                                            "', but the first corner of a box must lie below " +
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
  dealii::BoundingBox<dim>
  Region<dim>::bounds(const dealii::BoundingBox<dim> &bodies) const
  {
    auto bounds = bodies.get_boundary_points();
    for (unsigned int d = 0; d < dim; ++d)
      if (kind == Kind::box)
        {
          bounds.first[d]  = first[d];
          bounds.second[d] = second[d];
        }
      else if (kind == Kind::ball || d == axis)
        {
          const double middle = kind == Kind::ball ? first[d] : side_coordinate(bodies);
          bounds.first[d]     = middle - extent;
          bounds.second[d]    = middle + extent;
        }
    return dealii::BoundingBox<dim>(bounds);
  }

  template <int dim>
  bool
  Region<dim>::on_side(const dealii::Point<dim> &X, const dealii::BoundingBox<dim> &bodies,
                       const double tolerance) const
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
          case Kind::box: {
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
