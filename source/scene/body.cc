#include <stroma/scene/body.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Stroma
{
  namespace
  {
    /// Twice the area of the triangle a, b, c; positive if they go round anticlockwise.
    template <int dim>
    double
    turn(const dealii::Point<dim> &a, const dealii::Point<dim> &b, const dealii::Point<dim> &c)
    {
      return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    }

    template <int dim>
    dealii::Point<dim>
    read_point(Parameters &p, const std::string &entry, const std::string &meaning, const double start)
    {
      std::vector<double> values(dim, start);
      p.add(entry, values, meaning, "m", Range::any(), dim);
      dealii::Point<dim> point;
      for (unsigned int d = 0; d < dim; ++d)
        point[d] = values[d];
      return point;
    }
  } // namespace

  template <int dim>
  void
  Body<dim>::add(Parameters &p, const std::string &body_name, const std::vector<std::string> &materials,
                 const MPI_Comm comm)
  {
    name  = body_name;
    where = p.where_section();
    p.add_choice<Shape>("Shape", shape, "a volume image, or a drawn shape",
                        {{"image", Shape::image},
                         {"box", Shape::box},
                         {"ball", Shape::ball},
                         {"ring", Shape::ring},
                         {"quadrilateral", Shape::quadrilateral}});
    if (shape == Shape::image)
      {
        voxels.add(p, materials, dim, comm);
        return;
      }
    add_drawn(p);
    p.add("Rigid", rigid, "a rigid body instead of a piece of material");
    if (rigid && shape != Shape::box && shape != Shape::ball)
      throw UserError(p.where("Rigid"), "a rigid body must be a box or a ball");
    if (p.get_mode() == Parameters::Mode::document || (rigid && p.given("Pivot")))
      pivot = read_point<dim>(p, "Pivot", "about which a rigid body turns, its centre if not given", 0.);
    if (rigid)
      return;
    std::vector<std::pair<std::string, unsigned int>> choices;
    for (unsigned int m = 0; m < materials.size(); ++m)
      choices.emplace_back(materials[m], m);
    p.add_choice<unsigned int>("Material", material, "what it is made of", choices);
    if (p.given("Initial velocity") || p.get_mode() == Parameters::Mode::document)
      initial_velocity.add(p, "Initial velocity", "velocity at the start, for motion with inertia", "m/s", false);
  }

  template <int dim>
  void
  Body<dim>::add_drawn(Parameters &p)
  {
    if (dim == 3 && (shape == Shape::ring || shape == Shape::quadrilateral))
      throw UserError(p.where("Shape"), "a ring or a quadrilateral is for two dimensions; use a box or a ball");
    switch (shape)
      {
        case Shape::box:
          first  = read_point<dim>(p, "Lower corner", "corner with the smallest coordinates", 0.);
          second = read_point<dim>(p, "Upper corner", "corner with the largest coordinates", 1.);
          for (unsigned int d = 0; d < dim; ++d)
            if (first[d] >= second[d])
              throw UserError(p.where("Upper corner"),
                              "'Upper corner' must lie above 'Lower corner' in every direction");
          break;
        case Shape::ball:
          first  = read_point<dim>(p, "Centre", "centre", 0.);
          radius = std::nan("");
          p.add("Radius", radius, "radius", "m", Range::positive());
          break;
          case Shape::ring: {
            first  = read_point<dim>(p, "Centre", "centre", 0.);
            radius = inner_radius = std::nan("");
            p.add("Inner radius", inner_radius, "inner radius", "m", Range::positive());
            p.add("Outer radius", radius, "outer radius", "m", Range::positive());
            std::vector<double> given{0., 90.};
            p.add("Angles", given, "from, to, anticlockwise from the x axis, in degrees; a whole ring by 0, 360", "",
                  Range::closed(-360, 360), 2);
            angles = {{given[0], given[1]}};
            if (!(inner_radius < radius))
              throw UserError(p.where("Outer radius"), "'Outer radius' must be larger than 'Inner radius'");
            if (!(angles[0] < angles[1] && angles[1] - angles[0] <= 360))
              throw UserError(p.where("Angles"), "'Angles' must increase, by 360 degrees at most");
            break;
          }
          case Shape::quadrilateral: {
            std::vector<double> given(8, std::nan(""));
            p.add("Corners", given, "x, y of the four corners, anticlockwise", "m", Range::any(), 8);
            for (unsigned int v = 0; v < 4; ++v)
              for (unsigned int d = 0; d < 2; ++d)
                corners[v][d] = given[2 * v + d];
            for (unsigned int v = 0; v < 4 && p.get_mode() == Parameters::Mode::read; ++v)
              if (!(turn(corners[v], corners[(v + 1) % 4], corners[(v + 2) % 4]) > 0))
                throw UserError(p.where("Corners"), "'Corners' must go round anticlockwise and be convex");
            break;
          }
        case Shape::image:
          break;
      }
  }

  template <int dim>
  dealii::BoundingBox<dim>
  Body<dim>::bounding_box() const
  {
    dealii::Point<dim> lower = first, upper = second;
    for (unsigned int d = 0; d < dim; ++d)
      switch (shape)
        {
          case Shape::image:
            lower[d] = voxels.corner[d] + voxels.first[d] * voxels.voxel_size[d];
            upper[d] = voxels.corner[d] + voxels.past[d] * voxels.voxel_size[d];
            break;
          case Shape::ball:
            lower[d] = first[d] - radius;
            upper[d] = first[d] + radius;
            break;
            case Shape::ring: {
              lower[d]           = std::numeric_limits<double>::max();
              upper[d]           = std::numeric_limits<double>::lowest();
              const auto include = [&](const double angle) {
                for (const double r : {inner_radius, radius})
                  {
                    // The exact value on the axes, so that sides there are found.
                    const double quarter = angle / 90. - d;
                    const double part    = std::fmod(quarter, 1.) == 0. ?
                                             std::vector<double>{1, 0, -1, 0}[(int(quarter) % 4 + 4) % 4] :
                                             std::cos(quarter * dealii::numbers::PI_2);
                    lower[d]             = std::min(lower[d], first[d] + r * part);
                    upper[d]             = std::max(upper[d], first[d] + r * part);
                  }
              };
              include(angles[0]);
              include(angles[1]);
              for (int quarter = -4; quarter <= 4; ++quarter)
                if (angles[0] <= 90. * quarter && 90. * quarter <= angles[1])
                  include(90. * quarter);
              break;
            }
          case Shape::quadrilateral:
            lower[d] = std::min({corners[0][d], corners[1][d], corners[2][d], corners[3][d]});
            upper[d] = std::max({corners[0][d], corners[1][d], corners[2][d], corners[3][d]});
            break;
          case Shape::box:
            break;
        }
    return dealii::BoundingBox<dim>({lower, upper});
  }

  template <int dim>
  std::optional<unsigned int>
  Body<dim>::voxel_material(const dealii::Point<dim> &X) const
  {
    std::array<unsigned int, 3> index{{0, 0, 0}};
    for (unsigned int d = 0; d < dim; ++d)
      index[d] = std::clamp(static_cast<unsigned int>(std::max(0., (X[d] - voxels.corner[d]) / voxels.voxel_size[d])),
                            voxels.first[d], voxels.past[d] - 1);
    const auto found = voxels.at(index[0], index[1], index[2]);
    return found == VoxelMaterials::empty ? std::nullopt : std::optional<unsigned int>(found);
  }

  template <int dim>
  bool
  Body<dim>::contains(const dealii::Point<dim> &X) const
  {
    const double r = X.distance(first);
    switch (shape)
      {
        case Shape::image:
          return bounding_box().point_inside(X) && voxel_material(X);
        case Shape::box:
          return bounding_box().point_inside(X);
        case Shape::ball:
          return r <= radius;
          case Shape::ring: {
            double angle = std::atan2(X[1] - first[1], X[0] - first[0]) * 180. / dealii::numbers::PI;
            while (angle < angles[0])
              angle += 360.;
            return inner_radius <= r && r <= radius && angle <= angles[1];
          }
          case Shape::quadrilateral: {
            bool inside = true;
            for (unsigned int v = 0; v < 4; ++v)
              inside &= turn(corners[v], corners[(v + 1) % 4], X) >= 0;
            return inside;
          }
      }
    return false;
  }

  template <int dim>
  std::optional<unsigned int>
  Body<dim>::material_at(const dealii::Point<dim> &X) const
  {
    if (rigid || !contains(X))
      return std::nullopt;
    return shape == Shape::image ? voxel_material(X) : std::optional<unsigned int>(material);
  }

  template class Body<2>;
  template class Body<3>;
} // namespace Stroma
