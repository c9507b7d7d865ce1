#include <stroma/base/log.h>
#include <stroma/base/text.h>
#include <stroma/materials/reference_tangent.h>
#include <stroma/mpm/settings.h>
#include <stroma/scene/rheology.h>

#include <cmath>
#include <limits>

namespace Stroma::Mpm
{
  namespace
  {
    const std::vector<std::pair<std::string, ResetPolicy>> policies = {{"always", ResetPolicy::always},
                                                                       {"never", ResetPolicy::never},
                                                                       {"when distorted", ResetPolicy::when_distorted}};

    std::vector<std::pair<double, ResetPolicy>>
    parse_schedule(const Parameters &p, const std::string &name, const std::string &text)
    {
      std::vector<std::pair<double, ResetPolicy>> schedule;
      for (const auto &part : split(text, ','))
        {
          const auto words = split(part, ':');
          bool       known = false;
          if (words.size() == 2)
            for (const auto &[word, policy] : policies)
              if (word == words[1])
                {
                  schedule.emplace_back(p.parse_number(name, words[0], "s", Range::non_negative()), policy);
                  known = true;
                }
          if (!known || (schedule.size() > 1 && schedule[schedule.size() - 2].first >= schedule.back().first))
            throw UserError(p.where(name), "'" + name + "' was given as '" + text +
                                             "'; it must be 'time: policy, ...' with growing times and the policies " +
                                             "always, never, when distorted");
        }
      return schedule;
    }
  } // namespace

  template <int dim>
  void
  Settings<dim>::add(Parameters &p, const Scene<dim> &scene)
  {
    add_grid(p);
    add_points(p);
    add_resets(p);
    p.add_choice<InternalForce>(
      "Internal force", internal_force,
      "consistent, or the published scheme of Guilkey 2006 (reference gradients with Kirchhoff "
      "stress, compounded F), only to reproduce its tables",
      {{"consistent", InternalForce::consistent}, {"published", InternalForce::published}});
    p.add_choice<bool>("Dilatation", projected,
                       "change of volume at each point, or projected onto its mean over a cell (F-bar, no locking)",
                       {{"full", false}, {"projected", true}});
    add_quadrature(p, scene);
    p.add("Penalty", penalty,
          "stiffness that holds driven material points, over P-wave modulus times volume over cell size squared", "",
          Range::positive());
    if (!scene.contacts.empty() || p.get_mode() == Parameters::Mode::document)
      contact.add(p);
    order = is_viscous(scene) ? Solvers::Order::first : Solvers::Order::statics;
    scheme.add(p, order);
    where_dilatation = p.where("Dilatation");
    refuse_combinations(p, scene);
  }

  template <int dim>
  void
  Settings<dim>::add_grid(Parameters &p)
  {
    if (p.get_mode() == Parameters::Mode::document && cells.empty())
      cells.assign(dim, 64);
    p.add("Cells", cells, "number of cells over the grid's box (by default the box of the bodies) in each direction",
          Range::at_least(1), dim);
    p.add("Lower corner", lower_corner, "lower corner of the grid's box; empty: of the bodies' box", "m", Range::any());
    p.add("Upper corner", upper_corner, "upper corner of the grid's box; empty: of the bodies' box", "m", Range::any());
    for (const auto &[name, margin] : {std::pair{"below", &margin_below}, std::pair{"above", &margin_above}})
      {
        margin->assign(dim, 0.);
        p.add(std::string("Margin ") + name, *margin,
              std::string("room ") + name +
                " the grid's box in each direction, rounded up to whole cells; laid out only if the grid may be reset",
              "m", Range::non_negative(), dim);
      }
    std::vector<std::pair<std::string, unsigned int>> shapes;
    for (const auto &entry : Stroma::shape_functions<dim>())
      shapes.emplace_back(entry.name, shapes.size());
    p.add_choice<unsigned int>("Shape functions", shape,
                               "what carries the grid's displacement; the gradients of B-splines are continuous where "
                               "points cross from cell to cell",
                               shapes);
    where_grid  = p.where(lower_corner.empty() ? "Upper corner" : "Lower corner");
    where_cells = p.where("Cells");
    for (const auto *corner : {&lower_corner, &upper_corner})
      if (!corner->empty() && corner->size() != dim)
        throw UserError(where_grid, "a corner takes " + std::to_string(dim) + " coordinates");
  }

  template <int dim>
  void
  Settings<dim>::add_points(Parameters &p)
  {
    points_per_cell.assign(dim, 2);
    p.add("Points per cell", points_per_cell, "material points of drawn shapes in each direction of a cell",
          Range::closed(1, 16), dim);
    if (shape > 0 && *std::min_element(points_per_cell.begin(), points_per_cell.end()) < 2)
      throw UserError(p.where("Points per cell"),
                      "B-splines need at least 2 points in each direction of a cell; one does "
                      "not tell their three functions apart");
    p.add_choice<bool>(
      "Points at", gauss_points,
      "lattice: evenly in cells and voxels; Gauss points: of each cell, 'Points per cell' along each axis, " +
        std::string("for comparison with finite elements"),
      {{"lattice", false}, {"Gauss points", true}});
    points_per_voxel.assign(dim, 1);
    p.add("Points per voxel", points_per_voxel, "material points of images in each direction of a voxel",
          Range::closed(1, 16), dim);
  }

  template <int dim>
  void
  Settings<dim>::add_resets(Parameters &p)
  {
    p.add_choice<ResetPolicy>(
      "Grid reset", policy,
      "when the grid goes back to its original shape; a run ends as failed when the cells with points then hang " +
        std::string("together (by nodes) in more parts than at the start: the body was torn"),
      policies);
    std::string text;
    p.add("Grid reset schedule", text, "changes of policy, as 'time [s]: policy, ...'");
    schedule = parse_schedule(p, "Grid reset schedule", text);
    p.add("Distortion limit", distortion_limit,
          "'when distorted' resets once the Frobenius norm of the Green-Lagrange strain since the last reset passes it",
          "", Range::positive());
  }

  template <int dim>
  void
  Settings<dim>::add_quadrature(Parameters &p, const Scene<dim> &scene)
  {
    enum class Interface
    {
      automatic,
      bonded,
      composite
    };
    Interface interface = Interface::automatic;
    p.add_choice<Interface>(
      "Interface", interface,
      "what a cell does that holds two materials: bonded points all have the cell's deformation gradient; "
      "in composite cells it jumps, so that tractions agree; automatic: composite cells where they can be had, of points on a lattice",
      {{"automatic", Interface::automatic},
       {"bonded points", Interface::bonded},
       {"composite cells", Interface::composite}});
    enum class Integration
    {
      automatic,
      all_points,
      two_moments
    };
    Integration integration = Integration::automatic;
    p.add_choice<Integration>(
      "Integration", integration,
      "points that the solve takes: all, or in a cell with many points of a material "
      "2 along each axis with the same volume, centroid and second moments; of images, where a cell has few voxels, "
      "with those of these as boxes; automatic: two moments with linear functions where all bodies are images and nothing "
      "acts on single points, so that none is kept",
      {{"automatic", Integration::automatic},
       {"all points", Integration::all_points},
       {"two moments", Integration::two_moments}});
    two_moments        = integration == Integration::two_moments;
    const bool forgets = !is_rebased() && !is_viscous(scene) && n_history(scene) == 0 && !projected;
    for (const auto &[is_asked, name, choice] :
         {std::tuple{interface == Interface::composite, "Interface", "composite cells"},
          std::tuple{two_moments, "Integration", "two moments"}})
      if (is_asked && !forgets)
        throw UserError(p.where(name), std::string("'") + choice +
                                         "' go with 'Grid reset = never', consistent forces, 'Dilatation = full' and "
                                         "materials without viscosity or history");
    const bool has_two = scene.materials.size() > 1, is_open = interface == Interface::automatic;
    is_integration_open = integration == Integration::automatic && forgets && shape == 0;
    composite           = interface == Interface::composite || (is_open && has_two && forgets && !gauss_points);
    if (is_open && has_two)
      about_interfaces = composite ? "cells that hold two materials are composite" :
                                     "points of two materials in a cell are bonded";
  }

  template <int dim>
  void
  Settings<dim>::refuse_combinations(const Parameters &p, const Scene<dim> &scene) const
  {
    if (is_viscous(scene) && internal_force == InternalForce::published)
      throw UserError(p.where("Internal force"),
                      "'published' forces go with elastic materials; use 'consistent' with a viscosity");
    if (is_viscous(scene) && scene.plane == Materials::PlaneModel::stress)
      throw UserError(p.where_section(), "viscosity needs 'Plane = strain'");
    if (internal_force == InternalForce::published && may_reset() &&
        (policy != ResetPolicy::always || !schedule.empty()))
      throw UserError(p.where("Internal force"),
                      "'published' forces go with 'Grid reset = never' or 'always' throughout");
    if (!scene.rigid_bodies.empty() && is_rebased())
      throw UserError(scene.rigid_bodies.front().where,
                      "rigid bodies go with 'Grid reset = never' and consistent forces; for resets let driven points, "
                      "'Where = ball' or 'box', take the body's place");
    if (projected && internal_force == InternalForce::published)
      throw UserError(where_dilatation, "'published' forces go with 'Dilatation = full'");
  }

  template <int dim>
  void
  Settings<dim>::check(const Scene<dim> &scene) const
  {
    if (scene.plane == Materials::PlaneModel::stress)
      {
        if (projected)
          throw UserError(where_dilatation, "plane stress does not lock; use 'Dilatation = full'");
        return;
      }
    for (unsigned int m = 0; m < scene.materials.size() && !projected; ++m)
      {
        // Poisson's ratio of the undeformed material.
        const auto   Jc = Materials::reference_tangent(*scene.materials[m]);
        const double nu = Jc[0][0][1][1] / (Jc[0][0][0][0] + Jc[0][0][1][1]);
        if (nu > .45)
          Log::warning(scene.of_material(m) + " is nearly incompressible (Poisson's ratio " + brief(nu) +
                       "): with 'MPM/Dilatation = full' it locks, and forces come out too large, on 8 cells " +
                       "across by some 10 % at .49 and 8 times at .4999; use 'MPM/Dilatation = projected'");
      }
  }

  template <int dim>
  ResetPolicy
  Settings<dim>::policy_at(const double t) const
  {
    ResetPolicy now = policy;
    for (const auto &[time, next] : schedule)
      if (t >= time * (1 - 1e-12))
        now = next;
    return now;
  }

  template <int dim>
  bool
  Settings<dim>::may_reset() const
  {
    bool may = policy != ResetPolicy::never;
    for (const auto &change : schedule)
      may |= change.second != ResetPolicy::never;
    return may;
  }

  template <int dim>
  void
  Settings<dim>::choose_integration(const Scene<dim> &scene, const bool drives_points)
  {
    const bool has_image = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                       [](const auto &body) { return body.is_image(); });
    if (!is_integration_open || !has_image)
      return;
    two_moments       = can_find_points_in_images(scene, drives_points);
    about_integration = two_moments ?
                          "a cell's voxels act through their moments" :
                          "all points are kept, since loads or motions act on some or not all bodies are images";
  }

  template <int dim>
  bool
  Settings<dim>::can_find_points_in_images(const Scene<dim> &scene, const bool drives_points) const
  {
    const bool are_images = std::all_of(scene.bodies.begin(), scene.bodies.end(),
                                        [](const auto &body) { return body.rigid || body.is_image(); });
    const bool is_loaded  = std::any_of(scene.loads.begin(), scene.loads.end(),
                                        [](const auto &load) { return load.region.kind != Region<dim>::Kind::body; });
    return are_images && !gauss_points && !drives_points && !is_loaded;
  }

  template <int dim>
  double
  Settings<dim>::points_of_images_in_cell(const Scene<dim> &scene, const GridBox<dim> &box) const
  {
    double least = std::numeric_limits<double>::infinity();
    for (const auto &body : scene.bodies)
      for (unsigned int d = 0; d < dim && body.is_image(); ++d)
        least = std::min(least, box.cell_size[d] * points_per_voxel[d] / body.voxels.voxel_size[d]);
    return least;
  }

  template <int dim>
  GridBox<dim>
  Settings<dim>::grid_box(const Scene<dim> &scene) const
  {
    const auto         bodies = scene.bounding_box().get_boundary_points();
    dealii::Point<dim> lower = bodies.first, upper = bodies.second;
    for (unsigned int d = 0; d < dim; ++d)
      {
        if (!lower_corner.empty())
          lower[d] = lower_corner[d];
        if (!upper_corner.empty())
          upper[d] = upper_corner[d];
        const double tolerance = 1e-9 * (bodies.second[d] - bodies.first[d]);
        if (lower[d] > bodies.first[d] + tolerance || upper[d] < bodies.second[d] - tolerance)
          throw UserError(where_grid, std::string("the grid spans ") + brief(lower[d]) + " to " + brief(upper[d]) +
                                        " m along " + "xyz"[d] + ", but the bodies span " + brief(bodies.first[d]) +
                                        " to " + brief(bodies.second[d]) + " m; enlarge the grid");
      }
    GridBox<dim> box;
    box.lower = lower;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double h   = (upper[d] - lower[d]) / cells[d];
        box.cell_size[d] = h;
        box.n_cells[d]   = cells[d];
        if (may_reset())
          {
            const double below = std::ceil(margin_below[d] / h - 1e-9), above = std::ceil(margin_above[d] / h - 1e-9);
            if (!(below + above + cells[d] < Parameters::largest_whole))
              throw UserError(where_cells, std::string("the grid with its margins would have ") +
                                             brief(below + above + cells[d]) + " cells along " + "xyz"[d] +
                                             "; make the margins smaller");
            box.lower[d] -= below * h;
            box.n_cells[d] += static_cast<unsigned int>(below + above);
          }
      }
    return box;
  }

  template class Settings<2>;
  template class Settings<3>;
} // namespace Stroma::Mpm
