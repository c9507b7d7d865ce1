#include <stroma/base/text.h>
#include <stroma/mpm/prescribed.h>
#include <stroma/output/collective.h>
#include <stroma/scene/consistency.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace Stroma::Mpm
{
  namespace
  {
    /// The node nearest to a place: equal on all ranks, smallest coordinates first among equals. Collective.
    template <int dim>
    dealii::Point<dim>
    nearest_node(const BackgroundGrid<dim> &grid, const dealii::Point<dim> &place, const double tolerance,
                 const MPI_Comm comm)
    {
      std::array<double, 4> best{{std::numeric_limits<double>::max(), 0, 0, 0}}; // distance, coordinates
      for (std::size_t i = 0; i < grid.nodes.n_nodes(); ++i)
        {
          const auto            X = grid.nodes.node(i).X;
          std::array<double, 4> candidate{{std::round(X.distance(place) / tolerance), 0, 0, 0}};
          for (unsigned int d = 0; d < dim; ++d)
            candidate[1 + d] = X[d];
          best = std::min(best, candidate);
        }
      const auto all = dealii::Utilities::MPI::all_gather(comm, best);
      best           = *std::min_element(all.begin(), all.end());
      dealii::Point<dim> nearest;
      for (unsigned int d = 0; d < dim; ++d)
        nearest[d] = best[1 + d];
      return nearest;
    }

    /// How the motions that two supports give one unknown contradict each other, in words; empty if they do not.
    template <int dim, typename HeldUnknown>
    std::string
    disagreement(const Scene<dim> &scene, const HeldUnknown &one, const HeldUnknown &other, const double end_time)
    {
      if (one.support == other.support)
        return "";
      try
        {
          check_agreement(scene, {one.support, one.X}, {other.support, other.X}, one.component, end_time);
        }
      catch (const UserError &error)
        {
          return error.what();
        }
      return "";
    }

    /// Whether node @p index may hold a side across @p axis: one in whose place the field has the node's value there.
    template <int dim>
    bool
    can_hold_side(const BackgroundGrid<dim> &grid, const typename ShapeFunctions<dim>::Index &index,
                  const unsigned int axis)
    {
      return grid.shape->interpolates() || index[axis] == 0 || index[axis] + 1 == grid.shape->lattice_size(axis);
    }
  } // namespace

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
          on_points.push_back(settings.may_reset() && !nodes_can_follow(s));
        else if (kind == Region<dim>::Kind::body) // see RigidSurfaces
          on_points.push_back(false);
        else if (kind == Region<dim>::Kind::nearest)
          on_points.push_back(settings.may_reset() || settings.shape > 0);
        else
          on_points.push_back(true);
      }
  }

  template <int dim>
  bool
  PrescribedMotion<dim>::nodes_can_follow(const unsigned int s) const
  {
    const auto        &displacement = scene.supports[s].displacement;
    const auto        &region       = scene.supports[s].region;
    const unsigned int axis         = region.axis;
    if (displacement.is_free(axis))
      return false;
    const auto   box  = scene.bounding_box();
    const double none = 1e-12 * box.side_length(axis);
    // Places all over the side, and times without a common period.
    const std::array<double, 5> fractions{{0., .21, .5, .83, 1.}};
    for (const double part : {0., .013, .061, .173, .29, .37, .471, .53, .618, .74, .83, .911, 1.})
      for (unsigned int i = 0; i < 25; ++i)
        {
          const std::array<double, 2> place{{fractions[i % 5], fractions[i / 5]}};
          dealii::Point<dim>          X;
          X[axis] = region.side_coordinate(box);
          for (unsigned int d = 1; d < dim; ++d)
            X[(axis + d) % dim] = box.lower_bound((axis + d) % dim) + place[d - 1] * box.side_length((axis + d) % dim);
          if (std::abs(displacement.value(X, part * end_time, axis)) > none)
            return false;
          for (unsigned int c = 0; c < dim; ++c)
            if (displacement.is_free(c))
              {
                auto shifted = X;
                shifted[c]   = box.lower_bound(c);
                if ((displacement.value(X, part * end_time) - displacement.value(shifted, part * end_time)).norm() >
                    none)
                  return false;
              }
        }
    return true;
  }

  /// The undeformed place of what support @p s has moved to @p x at time @p t: X + d(X, t) = x, by Newton's method.
  template <int dim>
  dealii::Point<dim>
  PrescribedMotion<dim>::origin(const unsigned int s, const dealii::Point<dim> &x, const double t) const
  {
    const auto        &displacement = scene.supports[s].displacement;
    const auto         box          = scene.bounding_box();
    const double       size         = box.get_boundary_points().first.distance(box.get_boundary_points().second);
    dealii::Point<dim> X            = x;
    for (unsigned int iteration = 0; iteration < 50; ++iteration)
      {
        const dealii::Tensor<1, dim> error = X + displacement.value(X, t) - x;
        if (error.norm() < (iteration < 20 ? 1e-15 : 1e-12) * size)
          return X;
        dealii::Tensor<2, dim> slope;
        for (unsigned int k = 0; k < dim; ++k)
          {
            const auto step   = dealii::Point<dim>::unit_vector(k) * (1e-6 * size);
            const auto change = (displacement.value(X + step, t) -
                                 displacement.value(dealii::Point<dim>(X - step), t)) /
                                (2e-6 * size);
            for (unsigned int i = 0; i < dim; ++i)
              slope[i][k] = (i == k) + change[i];
          }
        X -= invert(slope) * error;
      }
    X[0] = std::numeric_limits<double>::quiet_NaN(); // the motion folds the side: no place, no number
    return X;
  }

  /// A node of a reset grid lies where material is now, not where it was; published forces alone rebase without a reset.
  template <int dim>
  dealii::Point<dim>
  PrescribedMotion<dim>::undeformed_place(const unsigned int s, const dealii::Point<dim> &X, const double t_reset) const
  {
    return t_reset > 0 && settings.may_reset() ? origin(s, X, t_reset) : X;
  }

  template <int dim>
  double
  PrescribedMotion<dim>::motion_of(const HeldUnknown &unknown, const double t, const double t_reset) const
  {
    const auto &displacement = scene.supports[unknown.support].displacement;
    double      sum          = 0;
    for (const auto &sample : unknown.samples)
      {
        const auto X = undeformed_place(unknown.support, sample.X, t_reset);
        sum += sample.weight * displacement.value(X, t, unknown.component);
        if (t_reset > 0)
          sum -= sample.weight * displacement.value(X, t_reset, unknown.component);
      }
    return sum;
  }

  template <int dim>
  double
  PrescribedMotion<dim>::rate_of(const HeldUnknown &unknown, const double t, const double t_reset, const double h) const
  {
    const auto &displacement = scene.supports[unknown.support].displacement;
    double      sum          = 0;
    for (const auto &sample : unknown.samples)
      sum += sample.weight *
             displacement.rate(undeformed_place(unknown.support, sample.X, t_reset), t, unknown.component, h);
    return sum;
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
        const auto &region   = scene.supports[s].region;
        const bool  is_side  = region.kind == Region<dim>::Kind::side;
        const auto  nearest  = region.kind == Region<dim>::Kind::nearest ? points.nearest(region.first) : points.nobody;
        const auto  distance = [&](const dealii::Point<dim> &X) {
          return std::abs(X[region.axis] - region.side_coordinate(bodies));
        };
        double least = std::numeric_limits<double>::max(); // of the outermost points of a side
        if (is_side)
          {
            for (const auto &point : points.handler)
              least = std::min(least, distance(point.get_location()));
            least = dealii::Utilities::MPI::min(least, scene.comm);
          }
        unsigned long long count = 0;
        for (auto &point : points.handler)
          {
            const auto values = point.get_properties();
            const auto X      = points.initial_place(point.get_location(), values.data());
            const bool chosen = nearest != points.nobody ? point.get_id() == nearest :
                                is_side                  ? distance(X) <= least + tolerance :
                                                           region.contains(X, points.material_of(values.data()), bodies);
            if (chosen)
              {
                values[points.support.first] += std::ldexp(1., s);
                ++count;
              }
          }
        if (dealii::Utilities::MPI::sum(count, scene.comm) == 0)
          throw UserError(scene.supports[s].where,
                          "support '" + scene.supports[s].name + "' (" + region.text +
                            ") selects no material point; enlarge it or move it into the bodies");
      }
    if (any_drives_points())
      check_shared_points(points);
  }

  template <int dim>
  std::uint64_t
  PrescribedMotion<dim>::marks_of_inner_half(const unsigned int axis, const bool upper) const
  {
    std::uint64_t marks = 0;
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      {
        const auto &region = scene.supports[s].region;
        if (on_points[s] && region.kind == Region<dim>::Kind::side && region.axis == axis && region.upper != upper)
          marks |= std::uint64_t(1) << s;
      }
    return marks;
  }

  /// Two springs that pull a point to two places would hold it somewhere between them.
  template <int dim>
  void
  PrescribedMotion<dim>::check_shared_points(const Points<dim> &points) const
  {
    std::string message;
    for (const auto &point : points.handler)
      {
        const auto mask = static_cast<unsigned long long>(point.get_properties()[points.support.first]);
        const auto X    = points.initial_place(point.get_location(), point.get_properties().data());
        for (unsigned int b = 0; (mask & (mask - 1)) != 0 && b < scene.supports.size() && message.empty(); ++b)
          for (unsigned int a = 0; a < b; ++a)
            for (unsigned int c = 0; c < dim; ++c)
              if ((mask >> a & 1) && (mask >> b & 1) && !scene.supports[a].displacement.is_free(c) &&
                  !scene.supports[b].displacement.is_free(c) && message.empty())
                try
                  {
                    check_agreement(scene, {a, X}, {b, X}, c, end_time);
                  }
                catch (const UserError &error)
                  {
                    message = error.what();
                  }
      }
    Output::throw_if_any(message, scene.comm);
  }

  template <int dim>
  void
  PrescribedMotion<dim>::find_nodes(const BackgroundGrid<dim> &grid, const Rigid::Unknowns<dim> &rigid,
                                    const dealii::IndexSet &relevant)
  {
    using Kind                                = typename Region<dim>::Kind;
    const auto                      bodies    = scene.bounding_box();
    const double                    tolerance = 1e-6 * grid.box().cell_size.norm();
    std::vector<dealii::Point<dim>> nearest(scene.supports.size());
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      if (!on_points[s] && scene.supports[s].region.kind == Kind::nearest)
        nearest[s] = nearest_node(grid, scene.supports[s].region.first, tolerance, scene.comm);

    std::map<dealii::types::global_dof_index, HeldUnknown> found;
    std::vector<unsigned int>                              count(scene.supports.size(), 0);
    contradiction.clear();
    for (std::size_t i = 0; i < grid.nodes.n_nodes(); ++i)
      {
        const auto node = grid.nodes.node(i);
        for (unsigned int s = 0; s < scene.supports.size(); ++s)
          {
            const auto &support = scene.supports[s];
            if (on_points[s] || support.region.kind == Kind::body ||
                !(support.region.kind == Kind::side ? can_hold_side(grid, node.index, support.region.axis) &&
                                                        support.region.on_side(node.X, bodies, tolerance) :
                                                      node.X.distance(nearest[s]) < tolerance))
              continue;
            ++count[s];
            for (unsigned int c = 0; c < dim; ++c)
              if (!support.displacement.is_free(c))
                {
                  const HeldUnknown unknown{node.unknown + c, s, c, node.X, grid.shape->samples(node.index)};
                  const auto [known, is_new] = found.emplace(unknown.dof, unknown);
                  if (!is_new && contradiction.empty())
                    contradiction = disagreement(scene, known->second, unknown, end_time);
                }
          }
      }
    without_nodes.clear();
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      if (!on_points[s] && scene.supports[s].region.kind != Kind::body &&
          dealii::Utilities::MPI::sum(count[s], scene.comm) == 0)
        without_nodes.push_back(s);

    held_unknowns.clear();
    homogeneous.clear();
    homogeneous.reinit(relevant);
    for (const auto &[dof, unknown] : found)
      {
        held_unknowns.push_back(unknown);
        homogeneous.add_line(dof);
      }
    for (const auto &[r, c] : rigid.all_prescribed())
      homogeneous.add_line(rigid.unknown(r, c));
    homogeneous.close();
  }

  template <int dim>
  void
  PrescribedMotion<dim>::check_nodes(const BackgroundGrid<dim> &grid) const
  {
    Output::throw_if_any(contradiction, scene.comm);
    if (holds_nodes())
      return;
    const auto &support = scene.supports[without_nodes.front()];
    throw UserError(
      support.where,
      "support '" + support.name + "' (" + support.region.text + ") holds no grid node; let the " +
        (grid.shape->interpolates() ?
           "grid's cells end at that side ('MPM/Cells', corners)" :
           "grid itself end at that side ('MPM/Cells', corners, no margin there): B-splines have no node on "
           "sides between cells"));
  }

  template <int dim>
  void
  PrescribedMotion<dim>::hold(RigidMotions<dim> &motions, const ConnectedParts<dim> &parts,
                              const BackgroundGrid<dim> &grid, const Points<dim> &points) const
  {
    for (const auto &active : grid.active_cells())
      for (unsigned int a = 0; a < grid.shape->n_nodes(); ++a)
        {
          const auto node = grid.nodes.at(active.node[a]);
          for (unsigned int c = 0; c < dim; ++c)
            if (homogeneous.is_constrained(node.unknown + c))
              motions.hold(parts.piece_of(active.cell), node.X, c);
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
