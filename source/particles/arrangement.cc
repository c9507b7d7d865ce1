#include <stroma/base/text.h>
#include <stroma/particles/arrangement.h>
#include <stroma/particles/border_volumes.h>
#include <stroma/particles/lattice.h>
#include <stroma/particles/voronoi.h>
#include <stroma/scene/body_part.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Particles
{
  void
  ArrangementSettings::add(Parameters &p)
  {
    p.add("Spacing", spacing, "distance of neighbouring particles; it is fitted to the bodies along each axis", "m",
          Range::positive());
    where_spacing = p.where("Spacing");
    p.add_choice<ArrangementName>(
      "Arrangement", name, "of the particles at the start: square or hexagonal lattice, or relaxed Voronoi cells",
      {{"square", ArrangementName::square},
       {"hexagonal", ArrangementName::hexagonal},
       {"voronoi", ArrangementName::voronoi}});
    p.add(
      "Jitter", jitter,
      "largest random shift along each axis over the spacing, for tests; at .4 uniform stresses are 3 % too small, however "
      "small the spacing, and 9 % at .5, which is refused",
      "", Range::closed(0., .4));
    p.add("Jitter seed", seed, "of the random numbers of 'Jitter' and of 'Arrangement = voronoi'");
  }

  namespace
  {
    /// Length along axis @p d that two boxes have in common, with images of @p b across periodic faces; negative: the gap [m].
    template <int dim>
    double
    overlap(const Scene<dim> &scene, const dealii::BoundingBox<dim> &a, const dealii::BoundingBox<dim> &b,
            const unsigned int d)
    {
      const auto of_image = [&](const double shift) {
        return std::min(a.upper_bound(d), b.upper_bound(d) + shift) -
               std::max(a.lower_bound(d), b.lower_bound(d) + shift);
      };
      if (!scene.periodic[d])
        return of_image(0.);
      const double period = scene.bounding_box().side_length(d);
      const double shift  = period * std::round((a.center()[d] - b.center()[d]) / period);
      double       common = of_image(shift);
      for (const double next : {of_image(shift - period), of_image(shift + period)})
        common = std::min(common, next) > 0. ? common + next : std::max(common, next);
      return common;
    }

    /// Exact volume that body @p b has to itself, later bodies going before it [m^dim]; 0 where it is not known: where a later one
    /// reaches out of it, or two of them may overlap.
    template <int dim>
    double
    own_volume(const Scene<dim> &scene, const unsigned int b)
    {
      const auto                            mine   = scene.bodies[b].bounding_box();
      double                                volume = volume_of(scene.bodies[b]);
      std::vector<dealii::BoundingBox<dim>> inside;
      for (unsigned int later = b + 1; later < scene.bodies.size(); ++later)
        {
          const auto theirs   = scene.bodies[later].bounding_box();
          bool       overlaps = true, is_inside = scene.bodies[b].is_box();
          for (unsigned int d = 0; d < dim; ++d)
            {
              const double slack = 1e-9 * mine.side_length(d), common = overlap(scene, mine, theirs, d);
              overlaps &= common > slack;
              is_inside &= common > theirs.side_length(d) - slack;
            }
          if (!overlaps)
            continue;
          for (const auto &other : inside)
            {
              bool meet = true;
              for (unsigned int d = 0; d < dim; ++d)
                meet &= overlap(scene, other, theirs, d) > 1e-9 * mine.side_length(d);
              is_inside &= !meet;
            }
          if (!is_inside)
            return 0.;
          inside.push_back(theirs);
          volume -= volume_of(scene.bodies[later]);
        }
      return volume;
    }

    /// Of a shape's outline, where two of its segments meet.
    template <int dim>
    struct OutlineCorner
    {
      dealii::Point<dim> X;
      double             angle;  ///< outside the shape
      double             length; ///< half of both segments [m]
    };

    template <int dim>
    std::vector<OutlineCorner<dim>>
    corners_of_outline(const Shapes::Shape<dim> &shape, const double size)
    {
      std::vector<OutlineCorner<dim>> corners;
      if constexpr (dim == 2)
        {
          const auto facets = shape.facets(size);
          for (const auto &next : facets)
            for (const auto &last : facets)
              if (last.corners[1].distance(next.corners[0]) < 1e-6 * size)
                {
                  const auto   from = last.corners[1] - last.corners[0], to = next.corners[1] - next.corners[0];
                  const double turn = std::atan2(from[0] * to[1] - from[1] * to[0], from * to);
                  corners.push_back({next.corners[0], dealii::numbers::PI + turn, .5 * (from.norm() + to.norm())});
                }
        }
      return corners;
    }

    template <int dim>
    class Arranger
    {
    public:
      Arranger(const Scene<dim> &scene, const ArrangementSettings &settings, const std::vector<Mover<dim>> &movers,
               const double reach)
        : scene(scene)
        , settings(settings)
        , movers(movers)
        , reach(reach)
        , lattice(scene.bounding_box(), settings.spacing, settings.name == ArrangementName::hexagonal, scene.periodic,
                  settings.where_spacing)
        , rank(dealii::Utilities::MPI::this_mpi_process(scene.comm))
        , n_ranks(dealii::Utilities::MPI::n_mpi_processes(scene.comm))
      {}

      ParticleSet<dim>
      run()
      {
        if (settings.name == ArrangementName::voronoi)
          add_voronoi();
        else
          add_lattice();
        if (settings.follows_borders && settings.name != ArrangementName::voronoi)
          n_pieces = shares_at_borders(scene, lattice, particles);
        set_free_volumes();
        jitter();
        particles.n_free = particles.size();
        if (reach > 0.)
          add_fixed();
        particles.n_owned = particles.size();
        particles.x       = particles.X;
        particles.J.assign(particles.size(), 1.);
        return std::move(particles);
      }

    private:
      void add(std::uint64_t id, const dealii::Point<dim> &X, int body, unsigned int material, std::uint16_t mover);
      void add_lattice();
      void add_voronoi();
      void set_free_volumes();
      void jitter();
      void add_fixed();
      int  side_behind(const dealii::Point<dim> &X, dealii::Point<dim> &inside) const;
      void add_fixed_at(std::uint64_t id, const dealii::Point<dim> &X);
      void add_boundary(std::uint64_t first);
      bool is_covered(const dealii::Point<dim> &X, unsigned int m) const;
      IndexBlock<dim> fixed_block() const;
      double          layer_depth(unsigned int axis) const;
      void            check_bodies(bool rigid, const std::vector<unsigned long long> &n_of_body) const;
      void            check_materials() const;

      const Scene<dim>              &scene;
      const ArrangementSettings     &settings;
      const std::vector<Mover<dim>> &movers;
      const double                   reach;
      const Lattice<dim>             lattice;
      const std::uint64_t            rank, n_ranks;

      ParticleSet<dim>    particles;
      std::vector<int>    body;       ///< of each particle; -1: beyond a side
      std::vector<double> n_pieces;   ///< of volume `piece`, of each free particle
      double              piece = 0.; ///< [m^dim]
    };

    template <int dim>
    void
    Arranger<dim>::add(const std::uint64_t id, const dealii::Point<dim> &X, const int of_body,
                       const unsigned int material, const std::uint16_t mover)
    {
      particles.id.push_back(id);
      particles.X.push_back(X);
      particles.V0.push_back(lattice.site_volume());
      if (scene.materials.size() > 1)
        particles.material.push_back(material);
      particles.mover.push_back(mover);
      body.push_back(of_body);
    }

    template <int dim>
    void
    Arranger<dim>::add_lattice()
    {
      piece            = lattice.site_volume();
      const auto sites = lattice.inside();
      for (std::uint64_t id = rank; id < sites.size(); id += n_ranks)
        {
          const auto X = lattice.site(sites.at(id));
          if (const auto material = material_at(scene, X))
            {
              add(id, X, body_at(scene, X), *material, ParticleSet<dim>::no_mover);
              n_pieces.push_back(1);
            }
        }
    }

    template <int dim>
    void
    Arranger<dim>::add_voronoi()
    {
      const auto cells = relaxed_voronoi_cells(scene, lattice, settings.seed);
      piece            = cells.sample_volume;
      for (std::uint64_t id = rank; id < cells.centre.size(); id += n_ranks)
        if (cells.n_samples[id] > 0)
          {
            const auto &X = cells.centre[id];
            add(id, X, body_at(scene, X), *material_at(scene, X), ParticleSet<dim>::no_mover);
            n_pieces.push_back(cells.n_samples[id]);
          }
    }

    /// Throws UserError if a body got no particle on any rank.
    template <int dim>
    void
    Arranger<dim>::check_bodies(const bool rigid, const std::vector<unsigned long long> &n_of_body) const
    {
      for (unsigned int b = 0; b < scene.bodies.size(); ++b)
        if (scene.bodies[b].rigid == rigid && n_of_body[b] == 0)
          throw UserError(scene.bodies[b].where, "body '" + scene.bodies[b].name + "' holds no particle of spacing " +
                                                   brief(settings.spacing) + " m; use a smaller 'Spacing' (" +
                                                   settings.where_spacing + ")");
    }

    /// Throws UserError if an image's voxels of some material got no particle on any rank, though there are some.
    template <int dim>
    void
    Arranger<dim>::check_materials() const
    {
      std::vector<unsigned int> n_of_material(scene.materials.size(), 0);
      for (const auto material : particles.material)
        ++n_of_material[material];
      dealii::Utilities::MPI::sum(n_of_material, scene.comm, n_of_material);
      for (const auto &body : scene.bodies)
        for (unsigned int m = 0; m < scene.materials.size() && scene.materials.size() > 1; ++m)
          if (n_of_material[m] == 0 &&
              std::find(body.voxels.material.begin(), body.voxels.material.end(), m) != body.voxels.material.end())
            throw UserError(body.where, "material '" + scene.material_names[m] + "' of body '" + body.name +
                                          "' holds no particle of spacing " + brief(settings.spacing) +
                                          " m; use a smaller 'Spacing' (" + settings.where_spacing + ")");
    }

    template <int dim>
    void
    Arranger<dim>::set_free_volumes()
    {
      std::vector<unsigned long long> n_of_body(scene.bodies.size(), 0);
      std::vector<double>             pieces_of_body(scene.bodies.size(), 0.);
      for (unsigned int i = 0; i < particles.size(); ++i)
        {
          ++n_of_body[body[i]];
          pieces_of_body[body[i]] += n_pieces[i];
        }
      dealii::Utilities::MPI::sum(n_of_body, scene.comm, n_of_body);
      dealii::Utilities::MPI::sum(pieces_of_body, scene.comm, pieces_of_body);
      check_bodies(false, n_of_body);
      check_materials();
      std::vector<double> piece_of_body(scene.bodies.size(), piece);
      for (unsigned int b = 0; b < scene.bodies.size(); ++b)
        if (const double volume = own_volume(scene, b); !scene.bodies[b].rigid && volume > 0.)
          piece_of_body[b] = volume / pieces_of_body[b];
      for (unsigned int i = 0; i < particles.size(); ++i)
        particles.V0[i] = n_pieces[i] * piece_of_body[body[i]];
    }

    /// A shift that would leave the body is turned round, or left out.
    template <int dim>
    void
    Arranger<dim>::jitter()
    {
      for (unsigned int i = 0; settings.jitter > 0. && i < particles.size(); ++i)
        {
          dealii::Tensor<1, dim> shift;
          for (unsigned int d = 0; d < dim; ++d)
            shift[d] = settings.jitter * lattice.spacing[d] * (2. * uniform(settings.seed, particles.id[i], d) - 1.);
          for (const auto &X : {particles.X[i] + shift, particles.X[i] - shift})
            if (body_at(scene, X) == body[i])
              {
                particles.X[i] = X;
                break;
              }
        }
    }

    /// Of whole rows, not less than the reach [m].
    template <int dim>
    double
    Arranger<dim>::layer_depth(const unsigned int axis) const
    {
      return std::ceil(reach / lattice.spacing[axis] - 1e-9) * lattice.spacing[axis];
    }

    /// Indices of all sites that may hold fixed particles, with one more row each way for shifted rows.
    template <int dim>
    IndexBlock<dim>
    Arranger<dim>::fixed_block() const
    {
      auto block = lattice.inside();
      for (unsigned int d = 0; d < dim; ++d)
        {
          double below = 0., above = 0.; // the box [m]
          for (const auto &mover : movers)
            if (mover.rigid)
              {
                const auto box = scene.bodies[mover.rigid->body].bounding_box();
                below          = std::max(below, lattice.lower[d] - box.lower_bound(d));
                above          = std::max(above, box.upper_bound(d) - lattice.upper[d]);
              }
            else if (mover.axis == d)
              (mover.upper ? above : below) = std::max(mover.upper ? above : below, layer_depth(d));
          if (scene.periodic[d])
            continue;
          const int n_below = below > 0. ? static_cast<int>(std::ceil(below / lattice.spacing[d])) + 1 : 0;
          const int n_above = above > 0. ? static_cast<int>(std::ceil(above / lattice.spacing[d])) + 1 : 0;
          block.first[d]    = -n_below;
          block.n[d] += n_below + n_above;
        }
      return block;
    }

    /// The first mover of the held sides that @p X lies beyond and not too deep, -1 if any of these sides is free.
    /// @param inside set to the place just inside the sides.
    template <int dim>
    int
    Arranger<dim>::side_behind(const dealii::Point<dim> &X, dealii::Point<dim> &inside) const
    {
      int          first  = -1;
      unsigned int n_axes = 0, n_held = 0;
      inside = X;
      for (unsigned int d = 0; d < dim; ++d)
        n_axes += X[d] < lattice.lower[d] || X[d] > lattice.upper[d];
      for (unsigned int m = 0; m < movers.size(); ++m)
        {
          const auto &mover = movers[m];
          if (mover.rigid)
            continue;
          const double depth = -mover.distance(scene, X);
          if (depth <= 0. || depth >= layer_depth(mover.axis))
            continue;
          ++n_held;
          first              = first < 0 ? static_cast<int>(m) : first;
          inside[mover.axis] = mover.coordinate + (mover.upper ? -.5 : .5) * lattice.spacing[mover.axis];
        }
      return n_held == n_axes ? first : -1;
    }

    template <int dim>
    void
    Arranger<dim>::add_fixed_at(const std::uint64_t id, const dealii::Point<dim> &X)
    {
      dealii::Point<dim> in_body;
      const int          b = body_at(scene, X, &in_body);
      if (b >= 0 && scene.bodies[b].rigid)
        {
          if (settings.bodies_by_surface)
            return;
          for (unsigned int m = 0; m < movers.size(); ++m)
            if (movers[m].rigid && int(movers[m].rigid->body) == b && movers[m].distance(scene, in_body) >= -reach)
              add(id, in_body, b, 0, m);
          return;
        }
      if (lattice.is_inside(X))
        return;
      dealii::Point<dim> inside;
      const int          m = side_behind(X, inside);
      if (m < 0)
        return;
      if (const auto material = material_at(scene, inside))
        add(id, X, -1, *material, m);
    }

    /// Whether a held side or another rigid body covers the place @p X on the outline of mover @p m.
    template <int dim>
    bool
    Arranger<dim>::is_covered(const dealii::Point<dim> &X, const unsigned int m) const
    {
      return std::any_of(movers.begin(), movers.end(),
                         [&](const auto &other) { return &other != &movers[m] && other.distance(scene, X) < 0.; });
    }

    /// Boundary particles, with ids from @p id on.
    template <int dim>
    void
    Arranger<dim>::add_boundary(std::uint64_t id)
    {
      for (unsigned int m = 0; m < movers.size(); ++m)
        {
          if (!movers[m].rigid)
            continue;
          const unsigned int b = movers[m].rigid->body;
          for (const auto &corner : corners_of_outline(*scene.bodies[b].shape, settings.spacing))
            if (++id % n_ranks == rank && !is_covered(corner.X, m))
              {
                add(id, corner.X, b, 0, m);
                particles.V0.back() *= corner.angle / (2. * dealii::numbers::PI) * corner.length / settings.spacing;
              }
        }
    }

    template <int dim>
    void
    Arranger<dim>::add_fixed()
    {
      const auto          block = fixed_block();
      const std::uint64_t first = lattice.inside().size(); // ids below are of free ones
      for (std::uint64_t i = (rank + n_ranks - first % n_ranks) % n_ranks; i < block.size(); i += n_ranks)
        add_fixed_at(first + i, lattice.site(block.at(i)));
      if (settings.bodies_by_surface)
        add_boundary(first + block.size());
      std::vector<unsigned long long> n_of_body(scene.bodies.size(), 0);
      for (unsigned int i = particles.n_free; i < particles.size(); ++i)
        if (body[i] >= 0)
          ++n_of_body[body[i]];
      dealii::Utilities::MPI::sum(n_of_body, scene.comm, n_of_body);
      check_bodies(true, n_of_body);
    }
  } // namespace

  template <int dim>
  ParticleSet<dim>
  arrange(const Scene<dim> &scene, const ArrangementSettings &settings, const std::vector<Mover<dim>> &movers,
          const double reach)
  {
    return Arranger<dim>(scene, settings, movers, reach).run();
  }

  template ParticleSet<2> arrange(const Scene<2> &, const ArrangementSettings &, const std::vector<Mover<2>> &, double);
  template ParticleSet<3> arrange(const Scene<3> &, const ArrangementSettings &, const std::vector<Mover<3>> &, double);
} // namespace Stroma::Particles
