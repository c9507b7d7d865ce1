#include <stroma/base/log.h>
#include <stroma/mpm/contact_points.h>
#include <stroma/mpm/surface_places.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <map>
#include <unordered_map>

namespace Stroma::Mpm
{
  namespace
  {
    /// Places on the surface along the side of a cell, from which areas are measured.
    constexpr double samples_per_cell = 8.;
    /// How far beside the surface it is looked for material, over the side of a cell; how deep a body may lie in it.
    constexpr double beside_surface = 1e-6, deepest_body = 1e-3;
    /// Steps inward, of a part of a cell, in which a cell with material points is looked for.
    constexpr int    most_steps = 8;
    constexpr double inward     = .25;
    /// Where the points of B-splines lie in the first two cells of the grid, over the side of a cell: with weights .934 and 1.066
    /// they would integrate all splines exactly, and by the areas between them they do so to 1 %.
    constexpr std::array<double, 2> first_places{{.4027, .4843}};

    /// A part of the surface that belongs to a line of the grid.
    template <int dim>
    struct SurfacePart
    {
      unsigned int body;
      double       along; ///< its coordinate along the line [m]
      double       area;  ///< [m^(dim-1)]
    };
    /// Lines by twice their axis and the side of the material, and their numbers among the nodes along the other axes.
    template <int dim>
    using Lines = std::map<std::array<int, dim + 1>, std::vector<SurfacePart<dim>>>;

    /// A place where a line meets the surface.
    template <int dim>
    struct Crossing
    {
      dealii::Point<dim>     X;
      dealii::Tensor<1, dim> normal;
      double                 area;
    };

    template <int dim>
    void
    refuse_bodies_inside(const Scene<dim> &scene, const double h)
    {
      for (const auto &contact : scene.contacts)
        {
          const auto &rigid = scene.bodies[contact.body];
          for (const auto &place : surface_places(rigid, .5 * h))
            {
              const dealii::Point<dim> outside = place.X + deepest_body * h * place.normal;
              for (const auto &body : scene.bodies)
                if (!body.rigid && body.shape->distance(place.X) < -deepest_body * h && scene.material_at(outside))
                  throw UserError(rigid.where,
                                  "rigid body '" + rigid.name + "' lies inside the material at the start; move it out");
            }
        }
    }

    /// The body at a place, material or bonded: those of contacts may reach a little into the material. -1: none.
    template <int dim>
    int
    body_at(const Scene<dim> &scene, const dealii::Point<dim> &X)
    {
      int b = int(scene.bodies.size()) - 1;
      while (b >= 0 && (Rigid::has_contact(scene, b) || !scene.bodies[b].contains(X)))
        --b;
      return b;
    }

    /// Whether the outer surface of body @p b is at a place, with nothing bonded to it.
    template <int dim>
    bool
    is_free_surface(const Scene<dim> &scene, const unsigned int b, const SurfacePlace<dim> &place, const double h)
    {
      const dealii::Point<dim> outside = place.X + beside_surface * h * place.normal,
                               inside  = place.X - beside_surface * h * place.normal;
      return body_at(scene, outside) < 0 && body_at(scene, inside) <= int(b);
    }

    /// Coordinates of lines along which the surface has its points, along each axis [m]: those of the grid's nodes.
    using NodeLines = std::vector<std::vector<double>>;

    /// Moves lines of B-splines in the cells at both ends of an axis, and those at the ends out of it: on n cells they would be
    /// n + 2, and what the outermost two bear would hardly be determined.
    void
    move_end_lines(std::vector<double> &lines)
    {
      const std::size_t n = lines.size();
      const double      h = lines[2] - lines[1];
      lines.front() -= .5 * h;
      lines.back() += .5 * h;
      for (std::size_t i = 0; i < first_places.size() && n > 2 * first_places.size() + 2; ++i)
        {
          lines[1 + i] += (first_places[i] - .5) * h;
          lines[n - 2 - i] -= (first_places[i] - .5) * h;
        }
    }

    template <int dim>
    NodeLines
    lines_of_nodes(const ShapeFunctions<dim> &shape)
    {
      NodeLines lines(dim);
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int i = 0; i < shape.lattice_size(d); ++i)
          {
            typename ShapeFunctions<dim>::Index node{};
            node[d] = i;
            lines[d].push_back(shape.place(node)[d]);
          }
      if (!shape.interpolates())
        for (auto &of_axis : lines)
          move_end_lines(of_axis);
      return lines;
    }

    /// What the upper one of two lines round @p x takes of it. One beyond the ends of the body has its points there if it
    /// @p moves; else the other takes all.
    double
    part_of_upper(const double lower, const double upper, const std::array<double, 2> &ends, const double x,
                  const bool moves)
    {
      if (moves || (lower < ends[0] && upper > ends[1]))
        {
          const double before = std::max(lower, ends[0]), after = std::min(upper, ends[1]);
          return (x - before) / (after - before);
        }
      const double close = beside_surface * (upper - lower);
      return lower < ends[0] - close ? 1. : upper > ends[1] + close ? 0. : (x - lower) / (upper - lower);
    }

    /// Shares a place's area out among the lines round it. @param ends of the body @param moves see part_of_upper()
    template <int dim>
    void
    share_out(const NodeLines &nodes, const dealii::BoundingBox<dim> &ends, const bool moves, const unsigned int b,
              const SurfacePlace<dim> &place, Lines<dim> &lines)
    {
      unsigned int axis = 0;
      for (unsigned int d = 1; d < dim; ++d)
        if (std::abs(place.normal[d]) > std::abs(place.normal[axis]) * (1. + 1e-9))
          axis = d;
      std::array<int, dim + 1> line{};
      for (unsigned int corner = 0; corner < 1u << (dim - 1); ++corner)
        {
          double weight = 1.;
          line[0]       = 2 * axis + (place.normal[axis] > 0.);
          for (unsigned int i = 1; i < dim; ++i)
            {
              const unsigned int across = (axis + i) % dim;
              const auto        &x      = nodes[across];
              const double       X      = place.X[across];
              const int          above  = std::upper_bound(x.begin() + 1, x.end() - 1, X) - x.begin();
              const double       part   = part_of_upper(x[above - 1], x[above],
                                                        {{ends.lower_bound(across), ends.upper_bound(across)}}, X, moves);
              const bool         upper  = corner >> (i - 1) & 1;
              line[i]                   = above - 1 + upper;
              weight *= upper ? part : 1. - part;
            }
          if (weight > 0.)
            lines[line].push_back({b, place.X[axis], weight * place.area});
        }
    }

    template <int dim>
    Lines<dim>
    surface_by_lines(const Scene<dim> &scene, const BackgroundGrid<dim> &grid, const NodeLines &nodes, const double h)
    {
      Lines<dim> lines;
      for (unsigned int b = 0; b < scene.bodies.size(); ++b)
        {
          const auto &body = scene.bodies[b];
          if (body.is_image())
            throw UserError(body.where,
                            "contact of the image '" + body.name +
                              "' with rigid bodies is not solved by 'Method = mpm'; use finite elements, or "
                              "draw the body");
          const auto ends  = body.bounding_box();
          const bool moves = grid.shape->interpolates(); // B-splines have more functions than the surface has cells
          if (!body.rigid) // a little more than the spacing, so that as many fit as there should
            for (const auto &place : surface_places(body, h / samples_per_cell * (1. + 1e-9)))
              if (is_free_surface(scene, b, place, h))
                share_out(nodes, ends, moves, b, place, lines);
        }
      return lines;
    }

    /// Where the lines meet the surface: parts of one line that are more than a cell apart are apart.
    template <int dim>
    std::vector<Crossing<dim>>
    find_crossings(const Scene<dim> &scene, const GridBox<dim> &box, const NodeLines &nodes, Lines<dim> &&lines)
    {
      std::vector<Crossing<dim>> crossings;
      for (auto &[line, parts] : lines)
        {
          const unsigned int axis = line[0] / 2;
          std::sort(parts.begin(), parts.end(), [](const auto &a, const auto &b) { return a.along < b.along; });
          for (std::size_t first = 0, end; first < parts.size(); first = end)
            {
              double area = 0., moment = 0.;
              for (end = first; end < parts.size() &&
                                (end == first || parts[end].along - parts[end - 1].along < box.cell_size[axis]);
                   ++end)
                {
                  area += parts[end].area;
                  moment += parts[end].area * parts[end].along;
                }
              dealii::Point<dim> X;
              for (unsigned int i = 1; i < dim; ++i)
                X[(axis + i) % dim] = nodes[(axis + i) % dim][line[i]];
              X[axis]        = moment / area;
              const auto &on = scene.bodies[parts[first].body].shape->nearest(X);
              crossings.push_back({on.foot, on.normal, area});
            }
        }
      return crossings;
    }

    /// The steps inward to the first cell with material points, and that cell if it is one of this rank.
    template <int dim>
    using Search = std::vector<std::pair<int, const ActiveCell<dim> *>>;

    template <int dim>
    Search<dim>
    find_cells(const std::vector<Crossing<dim>> &crossings, const BackgroundGrid<dim> &grid,
               const ActiveCells<dim> &cells, const double h, const MPI_Comm comm)
    {
      const auto                                                &box = grid.box();
      std::unordered_map<std::uint64_t, const ActiveCell<dim> *> by_number;
      for (const auto &active : cells)
        by_number.emplace(box.cell_number(active.cell->center()), &active);
      Search<dim>      found(crossings.size(), {most_steps, nullptr});
      std::vector<int> steps(crossings.size(), most_steps);
      for (std::size_t i = 0; i < crossings.size(); ++i)
        for (int step = 0; step < steps[i]; ++step)
          {
            const dealii::Point<dim> x = crossings[i].X - (beside_surface + inward * step) * h * crossings[i].normal;
            if (const auto cell = box.contains(x) ? by_number.find(box.cell_number(x)) : by_number.end();
                cell != by_number.end())
              {
                found[i] = {step, cell->second};
                steps[i] = step;
              }
          }
      dealii::Utilities::MPI::min(steps, comm, steps);
      for (std::size_t i = 0; i < crossings.size(); ++i)
        if (found[i].first > steps[i])
          found[i] = {steps[i], nullptr};
      return found;
    }
  } // namespace

  template <int dim>
  std::vector<Rigid::ContactPoint<dim>>
  contact_points(const Scene<dim> &scene, const BackgroundGrid<dim> &grid, const ActiveCells<dim> &cells,
                 const Solvers::Constraints &constraints)
  {
    const auto  &box   = grid.box();
    const double h     = *std::min_element(box.cell_size.begin_raw(), box.cell_size.end_raw());
    const auto   nodes = lines_of_nodes(*grid.shape);
    auto         lines = surface_by_lines(scene, grid, nodes, h);
    refuse_bodies_inside(scene, h);
    const auto                            crossings = find_crossings(scene, box, nodes, std::move(lines));
    const auto                            found     = find_cells(crossings, grid, cells, h, scene.comm);
    std::vector<Rigid::ContactPoint<dim>> points;
    unsigned int                          n_lost = 0;
    for (std::size_t i = 0; i < crossings.size(); ++i)
      {
        n_lost += found[i].first == most_steps;
        if (found[i].second == nullptr)
          continue;
        Rigid::ContactPoint<dim> point;
        static_cast<Rigid::CarriedPoint<dim> &>(point) = cells.carried(*found[i].second, crossings[i].X);
        point.name                                     = i;
        point.area                                     = crossings[i].area * (dim == 2 ? scene.thickness : 1.);
        bool is_held                                   = true;
        for (const auto &node : point.nodes)
          for (const auto dof : node.dofs)
            is_held &= constraints.is_constrained(dof);
        if (!is_held)
          points.push_back(point);
      }
    if (n_lost > 0)
      Log::warning(
        "at " + std::to_string(n_lost) + " of " + std::to_string(crossings.size()) +
        " places of the material's surface there is no contact: no cell near them holds a material point; use "
        "smaller 'MPM/Cells' or more 'MPM/Points per cell'");
    return points;
  }

  template std::vector<Rigid::ContactPoint<2>> contact_points(const Scene<2> &, const BackgroundGrid<2> &,
                                                              const ActiveCells<2> &, const Solvers::Constraints &);
  template std::vector<Rigid::ContactPoint<3>> contact_points(const Scene<3> &, const BackgroundGrid<3> &,
                                                              const ActiveCells<3> &, const Solvers::Constraints &);
} // namespace Stroma::Mpm
