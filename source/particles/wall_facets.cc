#include <stroma/base/text.h>
#include <stroma/particles/border_volumes.h>
#include <stroma/particles/wall_facets.h>
#include <stroma/shapes/triangulation.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Stroma::Particles
{
  namespace
  {
    /// Largest distance of a facet's centre from the surface that it stands for, over the spacing.
    constexpr double facet_tolerance = .005;
    /// Cosine of the largest angle between the normals of a part, and of one that counts as flat.
    constexpr double same_part = .7, one_normal = 1. - 1e-12;
    /// How far off its surface a facet is asked what is there, and how fine, over the spacing.
    constexpr double just_off = 1e-3, probe_size = .5;
    /// Between a wall and the material at the start, over the spacing.
    constexpr double negligible_gap = 1e-6;

    /// With the normal into the shape's outside, as of shapes.
    template <int dim>
    dealii::Tensor<1, dim>
    normal_of_facet(const std::array<dealii::Point<dim>, dim> &facet)
    {
      const auto n = Shapes::Facet<dim>{facet}.area_vector();
      return n / n.norm();
    }

    template <int dim>
    using Facets = std::vector<std::array<dealii::Point<dim>, dim>>;

    template <int dim>
    Facets<dim>
    corners_of(const std::vector<Shapes::Facet<dim>> &facets)
    {
      Facets<dim> corners;
      for (const auto &facet : facets)
        corners.push_back(facet.corners);
      return corners;
    }

    /// As large as they may be.
    template <int dim>
    Facets<dim>
    facets_of_shape(const Shapes::Shape<dim> &shape, const double spacing)
    {
      const auto box  = shape.bounding_box();
      double     size = box.get_boundary_points().first.distance(box.get_boundary_points().second);
      while (true)
        {
          const auto facets = shape.facets(size);
          double     worst  = 0.;
          for (const auto &facet : facets)
            worst = std::max(worst, std::abs(shape.distance(facet.centre())));
          if (worst < facet_tolerance * spacing)
            return corners_of<dim>(facets);
          size /= 1.5;
        }
    }

    /// A side of the box, with the normal into it.
    template <int dim>
    Facets<dim>
    facets_of_side(const dealii::BoundingBox<dim> &box, const unsigned int axis, const bool upper)
    {
      dealii::Tensor<1, dim> inward;
      inward[axis]             = upper ? -1. : 1.;
      const unsigned int first = upper ? 1u << axis : 0u;
      const auto         at    = [&](const unsigned int v) { return box.vertex(first + v); };
      const unsigned int s = 1u << (axis + 1) % dim, t = dim == 3 ? 1u << (axis + 2) % dim : 0u;
      Facets<dim>        facets;
      if constexpr (dim == 2)
        facets = {{{at(0), at(s)}}};
      else
        facets = {{{at(0), at(s), at(s + t)}}, {{at(0), at(s + t), at(t)}}};
      for (auto &facet : facets)
        if (normal_of_facet<dim>(facet) * inward < 0.)
          std::swap(facet[0], facet[1]);
      return facets;
    }

    template <int dim>
    Facets<dim>
    pieces_of(const std::array<dealii::Point<dim>, dim> &facet, const double size)
    {
      return corners_of<dim>(Shapes::split_to_size(std::vector<Shapes::Facet<dim>>{{facet}}, size));
    }
  } // namespace

  template <int dim>
  WallFacets<dim>::WallFacets(const Scene<dim> &scene, const std::vector<Mover<dim>> &movers, const KernelName kernel,
                              const double h, const double spacing, const bool bonded_to_all)
    : scene(scene)
    , movers(movers)
    , integrals(kernel, h)
    , spacing(spacing)
    , reach(with_kernel<dim>(kernel, h, [](const auto &k) { return k.support(); }))
    , images(1)
  {
    for (unsigned int d = 0; d < dim; ++d)
      if (scene.periodic[d])
        for (unsigned int k = 0, n = images.size(); k < n; ++k)
          for (const double sign : {-1., 1.})
            {
              auto shift = images[k];
              shift[d]   = sign * scene.bounding_box().side_length(d);
              images.push_back(shift);
            }
    for (unsigned int m = 0; m < movers.size(); ++m)
      {
        Surface surface;
        if (movers[m].rigid || bonded_to_all)
          surface.at_start = uncovered(facets_of(movers[m]), m);
        if (movers[m].rigid)
          require_no_wider_than_period(*movers[m].rigid);
        if (movers[m].rigid && bonded_to_all)
          require_near(surface, *movers[m].rigid);
        if (deforms(m))
          {
            Facets<dim> pieces;
            for (const auto &facet : surface.at_start)
              for (const auto &piece : pieces_of<dim>(facet, spacing))
                pieces.push_back(piece);
            surface.at_start = pieces;
          }
        surface.facets = surface.at_start;
        lay_cells(surface);
        surfaces.push_back(std::move(surface));
      }
  }

  /// Whether a displacement varies along the side.
  template <int dim>
  bool
  WallFacets<dim>::deforms(const unsigned int m) const
  {
    return !movers[m].rigid && movers[m].moves && movers[m].varies_in_space;
  }

  template <int dim>
  std::vector<typename WallFacets<dim>::Facet>
  WallFacets<dim>::facets_of(const Mover<dim> &mover) const
  {
    return mover.rigid ? facets_of_shape(*scene.bodies[mover.rigid->body].shape, spacing) :
                         facets_of_side(scene.bounding_box(), mover.axis, mover.upper);
  }

  /// Those of @p facets, in pieces where it must be, that no other wall covers.
  template <int dim>
  std::vector<typename WallFacets<dim>::Facet>
  WallFacets<dim>::uncovered(const std::vector<Facet> &facets, const unsigned int m) const
  {
    std::vector<Facet> all;
    for (const auto &facet : facets)
      {
        const auto         normal = normal_of_facet<dim>(facet);
        std::vector<Facet> open;
        const auto         pieces = pieces_of<dim>(facet, probe_size * spacing);
        for (const auto &piece : pieces)
          if (!is_covered(Shapes::Facet<dim>{piece}.centre(), normal, m))
            open.push_back(piece);
        if (open.size() == pieces.size())
          open.assign(1, facet);
        all.insert(all.end(), open.begin(), open.end());
      }
    return all;
  }

  template <int dim>
  bool
  WallFacets<dim>::is_covered(const dealii::Point<dim> &X, const dealii::Tensor<1, dim> &normal,
                              const unsigned int m) const
  {
    const auto                    outside = X + just_off * spacing * normal, inside = X - just_off * spacing * normal;
    const Rigid::Body<dim> *const rigid = movers[m].rigid;
    if (rigid)
      if (const int b = body_at(scene, inside_periods(scene, inside));
          b > static_cast<int>(rigid->body) && !scene.bodies[b].rigid)
        throw UserError(scene.bodies[b].where, "body '" + scene.bodies[b].name + "' covers a part of the rigid body '" +
                                                 rigid->name +
                                                 "', whose facets are then not those of its shape; put the rigid one "
                                                 "after it in the file, or set 'Walls = layers'");
    const auto takes_up = [&](const Rigid::Body<dim> &body, const dealii::Point<dim> &place) {
      return std::any_of(images.begin(), images.end(), [&](const auto &shift) {
        return (&body != rigid || shift.norm_square() > 0.) &&
               scene.bodies[body.body].shape->contains(dealii::Point<dim>(place + shift));
      });
    };
    for (const auto &other : scene.rigid_bodies)
      if (takes_up(other, outside) || // or the same facet twice: the first body has it
          (rigid && other.body < rigid->body && takes_up(other, inside)))
        return true;
    for (unsigned int side = 0; side < movers.size(); ++side)
      if (side != m && !movers[side].rigid && movers[side].distance(scene, outside) < 0.)
        return true;
    return false;
  }

  template <int dim>
  double
  WallFacets<dim>::clearance(const dealii::Point<dim> &X) const
  {
    double     nearest = scene.is_fluid() ? 0. : std::numeric_limits<double>::max();
    const auto inside  = inside_periods(scene, X);
    for (const auto &body : scene.bodies)
      for (unsigned int k = 0; k < images.size() && !body.rigid && nearest > 0.; ++k)
        nearest = std::min(nearest, body.shape ? std::max(body.shape->distance(inside + images[k]), 0.) : 0.);
    return nearest < negligible_gap * spacing ? 0. : nearest;
  }

  template <int dim>
  void
  WallFacets<dim>::require_no_wider_than_period(const Rigid::Body<dim> &rigid) const
  {
    const auto box = scene.bounding_box(), mine = scene.bodies[rigid.body].bounding_box();
    for (unsigned int d = 0; d < dim; ++d)
      if (scene.periodic[d] && mine.side_length(d) > (1. + 1e-9) * box.side_length(d))
        throw UserError(rigid.where, "rigid body '" + rigid.name + "' is " + brief(mine.side_length(d)) +
                                       " m wide along " + "xyz"[d] + ", where the scene repeats every " +
                                       brief(box.side_length(d)) +
                                       " m; with 'Walls = facets' draw it no wider than that");
  }

  /// The first two rows of particles have to see a wall.
  template <int dim>
  void
  WallFacets<dim>::require_near(const Surface &surface, const Rigid::Body<dim> &rigid) const
  {
    const double most = reach - 1.5 * spacing;
    double       gap  = std::numeric_limits<double>::max();
    for (const auto &facet : surface.at_start)
      for (const auto &piece : pieces_of<dim>(facet, probe_size * spacing))
        if (gap > most)
          gap = std::min(gap, clearance(Shapes::Facet<dim>{piece}.centre()));
    if (gap > most && !surface.at_start.empty())
      throw UserError(rigid.where, "rigid body '" + rigid.name + "' is " + brief(gap) +
                                     " m off the material at the start, but facets, which are bonded to it, reach " +
                                     brief(most) + " m; draw the body nearer, or set 'Walls = layers'");
  }

  template <int dim>
  typename WallFacets<dim>::Cell
  WallFacets<dim>::cell_of(const dealii::Point<dim> &x) const
  {
    Cell cell;
    for (unsigned int d = 0; d < dim; ++d)
      cell[d] = static_cast<int>(std::floor((x[d] - scene.bounding_box().lower_bound(d)) / reach));
    return cell;
  }

  template <int dim>
  std::uint64_t
  WallFacets<dim>::key_of(const Cell &cell)
  {
    std::uint64_t key = 0;
    for (const int c : cell)
      key = (key << 21) | static_cast<std::uint64_t>((c + (1 << 20)) & ((1 << 21) - 1));
    return key;
  }

  /// Each facet goes to all cells with places within reach of it.
  template <int dim>
  void
  WallFacets<dim>::lay_cells(Surface &surface) const
  {
    surface.near.clear();
    dealii::Point<dim> low, high;
    for (unsigned int f = 0; f < surface.facets.size(); ++f)
      {
        const auto        &facet = surface.facets[f];
        dealii::Point<dim> lower = facet[0], upper = facet[0];
        for (const auto &corner : facet)
          for (unsigned int d = 0; d < dim; ++d)
            {
              lower[d] = std::min(lower[d], corner[d] - reach);
              upper[d] = std::max(upper[d], corner[d] + reach);
            }
        for (unsigned int d = 0; d < dim; ++d)
          {
            low[d]  = f == 0 ? lower[d] : std::min(low[d], lower[d]);
            high[d] = f == 0 ? upper[d] : std::max(high[d], upper[d]);
          }
        const Cell first = cell_of(lower), last = cell_of(upper);
        const auto normal = normal_of_facet<dim>(facet);
        for (Cell cell = first; cell[dim - 1] <= last[dim - 1];)
          {
            dealii::Point<dim> centre;
            for (unsigned int d = 0; d < dim; ++d)
              centre[d] = scene.bounding_box().lower_bound(d) + (cell[d] + .5) * reach;
            if (std::abs(normal * (centre - facet[0])) < (1. + .5 * std::sqrt(double(dim))) * reach)
              surface.near[key_of(cell)].push_back(f);
            for (unsigned int d = 0; d < dim && (++cell[d] > last[d]) && d + 1 < dim; ++d)
              cell[d] = first[d];
          }
      }
    surface.box = dealii::BoundingBox<dim>(std::make_pair(low, high));
  }

  template <int dim>
  void
  WallFacets<dim>::update(const double t, const std::vector<Rigid::Pose<dim>> &all)
  {
    now   = t;
    poses = all;
    rotations.clear();
    for (const auto &pose : poses)
      rotations.push_back(Rigid::rotation_matrix<dim>(pose.rotation));
    for (unsigned int m = 0; m < movers.size(); ++m)
      if (deforms(m))
        {
          auto &surface = surfaces[m];
          for (unsigned int f = 0; f < surface.facets.size(); ++f)
            for (unsigned int k = 0; k < dim; ++k)
              surface.facets[f][k] = surface.at_start[f][k] + movers[m].displacement(scene, surface.at_start[f][k], t);
          lay_cells(surface);
        }
  }

  /// Adds the facets seen from @p x in the mover's frame, those that face it and the others; returns their parts of 1 - gamma and
  /// the weight of all.
  template <int dim>
  std::array<double, 2>
  WallFacets<dim>::add_facets(const Surface &surface, const dealii::Point<dim> &x, std::vector<Sum> &front,
                              std::vector<Sum> &back) const
  {
    std::array<double, 2> totals{};
    if (surface.facets.empty() || !surface.box.point_inside(x))
      return totals;
    const auto cell = surface.near.find(key_of(cell_of(x)));
    if (cell == surface.near.end())
      return totals;
    for (const unsigned int f : cell->second)
      {
        const auto  &facet  = surface.facets[f];
        const auto   values = integrals(x, facet);
        const double weight = values.gradient.norm();
        if (!(weight * reach > 1e-12))
          continue;
        totals[0] += values.missing;
        totals[1] += weight;
        auto &sums = (x - facet[0]) * values.gradient >= 0. ? front : back;
        auto  sum  = std::find_if(sums.begin(), sums.end(), [&](const Sum &s) {
          return s.gradient * values.gradient > same_part * weight * s.gradient.norm();
        });
        if (sum == sums.end())
          {
            sum    = sums.insert(sums.end(), Sum());
            sum->x = x;
          }
        sum->gradient += values.gradient;
        sum->place += weight * (values.place - x);
        sum->weight += weight;
      }
    return totals;
  }

  template <int dim>
  typename WallFacets<dim>::Part
  WallFacets<dim>::part_of(const unsigned int m, const Sum &sum) const
  {
    const Mover<dim> &mover = movers[m];
    Part              part;
    part.mover = m;
    auto place = dealii::Point<dim>(sum.x + sum.place / sum.weight);
    if (mover.rigid) // of a curved one, the mean place lies off the surface
      place = scene.bodies[mover.rigid->body].shape->nearest(place).foot;
    part.X        = place;
    part.to       = rotations[m] * (place - sum.x);
    part.gradient = rotations[m] * sum.gradient;
    part.flat     = sum.gradient.norm() > one_normal * sum.weight;
    if (deforms(m)) // the place whose X + u(X) it is, by two rounds
      {
        part.X = mover.foot(place);
        for (unsigned int round = 0; round < 3; ++round)
          part.X = mover.foot(dealii::Point<dim>(place - mover.displacement(scene, part.X, now)));
      }
    return part;
  }

  /// The image of @p x across periodic faces that is nearest to @p centre.
  template <int dim>
  dealii::Point<dim>
  WallFacets<dim>::beside(dealii::Point<dim> x, const dealii::Point<dim> &centre) const
  {
    const auto box = scene.bounding_box();
    for (unsigned int d = 0; d < dim; ++d)
      if (scene.periodic[d])
        x[d] += box.side_length(d) * std::round((centre[d] - x[d]) / box.side_length(d));
    return x;
  }

  template <int dim>
  double
  WallFacets<dim>::look(const dealii::Point<dim> &x, std::vector<Part> &parts) const
  {
    double           missing = 0.;
    std::vector<Sum> front, back;
    for (unsigned int m = 0; m < surfaces.size(); ++m)
      {
        front.clear();
        back.clear();
        const auto &pose     = poses[m];
        const auto  in_frame = [&](const dealii::Point<dim> &place) {
          return dealii::Point<dim>(pose.pivot + (place - pose.pivot - pose.translation) * rotations[m]);
        };
        if (surfaces[m].facets.empty())
          continue;
        const auto place    = beside(x, pose.place(surfaces[m].box.center()));
        double     of_mover = 0., weight = 0.;
        for (const auto &shift : images)
          {
            const auto totals = add_facets(surfaces[m], in_frame(place + shift), front, back);
            of_mover += totals[0];
            weight += totals[1];
          }
        if (weight == 0.)
          continue;
        if (of_mover < 0.) // behind the wall
          {
            of_mover += 1.;
            front.insert(front.end(), back.begin(), back.end());
          }
        double seen = 0.;
        for (const auto &sum : front)
          seen += sum.weight;
        for (const auto &sum : front)
          {
            parts.push_back(part_of(m, sum));
            parts.back().missing = of_mover * sum.weight / seen;
          }
        missing += of_mover;
      }
    return missing;
  }

  template class WallFacets<2>;
  template class WallFacets<3>;
} // namespace Stroma::Particles
