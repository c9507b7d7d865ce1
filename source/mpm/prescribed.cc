#include <stroma/base/text.h>
#include <stroma/mpm/prescribed.h>
#include <stroma/scene/consistency.h>

#include <deal.II/base/mpi.h>

#include <cmath>
#include <limits>
#include <map>

namespace Stroma::Mpm
{

  template <int dim>
  PrescribedMotion<dim>::PrescribedMotion(const Scene<dim> &scene, const Settings<dim> &settings, const double end_time)
    : scene(scene)
    , settings(settings)
    , end_time(end_time)
  {
    if (scene.supports.size() > 50)
      throw UserError(scene.supports[50].where, "at most 50 supports");
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      {
        const auto kind = scene.supports[s].region.kind;
        if (kind == Region<dim>::Kind::side)
          on_points.push_back(settings.may_reset() && moves_normally(s));
        else if (kind == Region<dim>::Kind::nearest)
          on_points.push_back(settings.may_reset());
        else
          on_points.push_back(true);
      }
  }

  template <int dim>
  bool
  PrescribedMotion<dim>::moves_normally(const unsigned int s) const
  {
    const auto        &support = scene.supports[s];
    const unsigned int axis    = support.region.axis;
    if (support.displacement.is_free(axis))
      return true;
    const auto   box  = scene.bounding_box();
    const double size = box.side_length(axis);
    for (const double part : {0., .37, 1.})
      if (std::abs(support.displacement.value(box.center(), part * end_time, axis)) > 1e-12 * size)
        return true;
    return false;
  }

  template <int dim>
  bool
  PrescribedMotion<dim>::any_drives_points() const
  {
    return std::find(on_points.begin(), on_points.end(), true) != on_points.end();
  }

  template <int dim>
  void
  PrescribedMotion<dim>::mark_points(Points<dim> &points, const GridBox<dim> &box) const
  {
    const auto   bodies    = scene.bounding_box();
    const double tolerance = 1e-6 * box.cell_size.norm();
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      {
        if (!on_points[s])
          continue;
        const auto &region = scene.supports[s].region;
        const auto  distance = [&](const dealii::Point<dim> &X) {
          return region.kind == Region<dim>::Kind::nearest ? X.distance(region.first) :
                                                              std::abs(X[region.axis] - region.side_coordinate(bodies));
        };
        const bool by_distance = region.kind == Region<dim>::Kind::nearest || region.kind == Region<dim>::Kind::side;
        double     least       = std::numeric_limits<double>::max();
        if (by_distance)
          {
            for (const auto &point : points.handler)
              least = std::min(least, distance(point.get_location()));
            least = dealii::Utilities::MPI::min(least, scene.comm);
          }
        unsigned long long count = 0;
        for (auto &point : points.handler)
          {
            const auto values = point.get_properties();
            const bool chosen = by_distance ?
                                  distance(point.get_location()) <= least + tolerance :
                                  region.contains(point.get_location(), points.material_of(values.data()), bodies);
            if (chosen)
              {
                values[points.support.first] += std::ldexp(1., s);
                ++count;
              }
          }
        if (dealii::Utilities::MPI::sum(count, scene.comm) == 0)
          throw UserError(scene.supports[s].where, "support '" + scene.supports[s].name + "' (" + region.text +
                                                     ") selects no material point; enlarge it or move it into the bodies");
      }
  }

  template <int dim>
  void
  PrescribedMotion<dim>::find_nodes(const BackgroundGrid<dim> &grid)
  {
    const auto   bodies    = scene.bounding_box();
    const double h         = grid.box().cell_size.norm();
    const double tolerance = 1e-6 * h;

    // The node nearest to a place: equal on all ranks, smallest coordinates first among equals.
    std::vector<dealii::Point<dim>> nearest(scene.supports.size());
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      if (!on_points[s] && scene.supports[s].region.kind == Region<dim>::Kind::nearest)
        {
          std::array<double, 4> best{{std::numeric_limits<double>::max(), 0, 0, 0}}; // distance, coordinates
          for (const auto &cell : grid.dofs.active_cell_iterators())
            if (cell->is_locally_owned() && grid.is_active(cell))
              for (const unsigned int v : cell->vertex_indices())
                {
                  const auto &X = cell->vertex(v);
                  std::array<double, 4> candidate{
                    {std::round(X.distance(scene.supports[s].region.first) / tolerance), 0, 0, 0}};
                  for (unsigned int d = 0; d < dim; ++d)
                    candidate[1 + d] = X[d];
                  best = std::min(best, candidate);
                }
          const auto all = dealii::Utilities::MPI::all_gather(scene.comm, best);
          best           = *std::min_element(all.begin(), all.end());
          for (unsigned int d = 0; d < dim; ++d)
            nearest[s][d] = best[1 + d];
        }

    std::map<dealii::types::global_dof_index, HeldUnknown> found;
    std::vector<unsigned int>                              count(scene.supports.size(), 0);
    std::vector<dealii::types::global_dof_index>           dofs(dim << dim);
    std::string                                            contradiction;
    for (const auto &cell : grid.dofs.active_cell_iterators())
      {
        if (cell->is_artificial() || !grid.is_active(cell))
          continue;
        cell->get_dof_indices(dofs);
        for (const unsigned int v : cell->vertex_indices())
          for (unsigned int s = 0; s < scene.supports.size(); ++s)
            {
              if (on_points[s])
                continue;
              const auto &support = scene.supports[s];
              const auto &X       = cell->vertex(v);
              const bool  held    = support.region.kind == Region<dim>::Kind::side ?
                                      support.region.on_side(X, bodies, tolerance) :
                                      X.distance(nearest[s]) < tolerance;
              if (!held)
                continue;
              ++count[s];
              for (unsigned int c = 0; c < dim; ++c)
                if (!support.displacement.is_free(c))
                  {
                    const HeldUnknown unknown{dofs[v * dim + c], s, c, X};
                    const auto [known, is_new] = found.emplace(unknown.dof, unknown);
                    if (!is_new && known->second.support != s && contradiction.empty())
                      try
                        {
                          check_agreement(scene, {known->second.support, known->second.X}, {s, X}, c, end_time);
                        }
                      catch (const UserError &error)
                        {
                          contradiction = error.what();
                        }
                  }
            }
      }
    for (const auto &message : dealii::Utilities::MPI::all_gather(scene.comm, contradiction))
      if (!message.empty())
        throw UserError(message);
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      if (!on_points[s] && dealii::Utilities::MPI::sum(count[s], scene.comm) == 0)
        throw UserError(scene.supports[s].where,
                        "support '" + scene.supports[s].name + "' (" + scene.supports[s].region.text +
                          ") holds no grid node; let the grid's cells end at that side ('MPM/Cells', corners)");

    held_unknowns.clear();
    homogeneous.clear();
    homogeneous.reinit(grid.relevant);
    for (const auto &[dof, unknown] : found)
      {
        held_unknowns.push_back(unknown);
        homogeneous.add_line(dof);
      }
    homogeneous.close();
  }

  template <int dim>
  void
  PrescribedMotion<dim>::hold(RigidMotions<dim> &motions, const ConnectedParts<dim> &parts, const BackgroundGrid<dim> &grid,
                              const Points<dim> &points) const
  {
    std::vector<dealii::types::global_dof_index> dofs(dim << dim);
    for (const auto &cell : grid.dofs.active_cell_iterators())
      if (cell->is_locally_owned() && grid.is_active(cell))
        {
          cell->get_dof_indices(dofs);
          for (const unsigned int v : cell->vertex_indices())
            for (unsigned int c = 0; c < dim; ++c)
              if (homogeneous.is_constrained(dofs[v * dim + c]))
                motions.hold(parts.piece_of(cell), cell->vertex(v), c);
        }
    if (points.support.stored())
      for (const auto &point : points.handler)
        if (const auto mask = static_cast<unsigned long long>(point.get_properties()[points.support.first]))
          for (unsigned int s = 0; s < scene.supports.size(); ++s)
            if (mask >> s & 1)
              for (unsigned int c = 0; c < dim; ++c)
                if (!scene.supports[s].displacement.is_free(c))
                  motions.hold(parts.piece_of(point.get_surrounding_cell()), point.get_location(), c);
  }

  template class PrescribedMotion<2>;
  template class PrescribedMotion<3>;
} // namespace Stroma::Mpm
