#include <stroma/base/text.h>
#include <stroma/particles/border_volumes.h>
#include <stroma/particles/lattice.h>
#include <stroma/sph/contact.h>

#include "second_moment.h"

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace Stroma::Sph
{
  using dealii::Point;
  using dealii::Tensor;

  namespace
  {
    constexpr double reach  = 2.; ///< of a body's surface from a particle that may touch it, over the spacing
    constexpr double lowest = 3.; ///< distance from a body of particles that its wall may reach, over the spacing
    constexpr double surface_depth =
      1.; ///< of a particle that carries a piece of the surface, at most; over the spacing
    constexpr double       negligible_gap     = 1e-9; ///< over the spacing
    constexpr double       negligible_force   = 1e-9; ///< over P-wave modulus and spacing^(dim - 1)
    constexpr double       noise_of_forces    = 10.;  ///< of the several pairs of a particle, over what a solve leaves
    constexpr double       friction_tolerance = 1e-2; ///< of its largest size
    constexpr unsigned int halvings           = 30;   ///< of the spacing, on the way to the surface

    /// F of particle @p i by least squares over its free neighbours; I where they do not tell.
    template <int dim>
    Tensor<2, dim>
    deformation(const ParticleSet<dim> &particles, const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                const unsigned int i)
    {
      const auto displacement = [&](const unsigned int k) {
        return neighbours.image_near(particles.x[k], particles.X[k]) - particles.X[k];
      };
      Tensor<2, dim> mixed, moment;
      const auto     u_i = displacement(i);
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
        {
          const auto r = particles.x[pairs.j[p]] - particles.x[i], R = r - (displacement(pairs.j[p]) - u_i);
          mixed += outer_product(pairs.P[p] * r, R);
          moment += outer_product(pairs.P[p] * R, R);
        }
      if (!tells_gradient(moment))
        return dealii::unit_symmetric_tensor<dim>();
      return mixed * invert(moment);
    }
  } // namespace

  template <int dim>
  Contacts<dim>::Contacts(const Scene<dim> &scene, const std::vector<Mover<dim>> &movers, const Settings &settings)
    : scene(scene)
    , movers(movers)
    , settings(settings)
    , spacing(settings.arrangement.spacing)
    , depth_of_bodies(settings.has_segments() ? 0. : .5)
  {
    if (scene.is_fluid())
      throw UserError(scene.contacts.front().where,
                      "contact of a fluid with a rigid body cannot be solved with particles: they have no surface of "
                      "their own; remove the contact, and the fluid sticks to the body");
    if (settings.has_segments() && settings.contact.criterion == ContactCriterion::surface)
      throw UserError(
        scene.contacts.front().where,
        "the published scheme with 'Walls = facets' knows the contact criteria 'heck' and 'none'; set one "
        "of them as 'Criterion' of the method's section Contact");
    if (settings.walls == Walls::facets && !settings.published())
      throw UserError(scene.contacts.front().where,
                      "contact '" + scene.contacts.front().name +
                        "' cannot be solved with 'Walls = facets', whose bodies are bonded; set 'Walls = layers'");
    if (scene.contacts.size() > ContactState::max_contacts)
      throw UserError(scene.contacts[ContactState::max_contacts].where,
                      "particles know at most " + std::to_string(ContactState::max_contacts) + " contacts");
    for (const auto &material : scene.materials)
      modulus.push_back(material->p_wave_modulus());
    for (const auto &contact : scene.contacts)
      {
        any_coulomb |= contact.type == Contact::Type::coulomb;
        if (settings.published() && contact.type != Contact::Type::stick)
          throw UserError(contact.where,
                          "'Formulation = published' knows sticking contact only; set 'Type = stick', or "
                          "'Formulation = consistent'");
        if (contact.type == Contact::Type::coulomb && settings.contact.criterion != ContactCriterion::surface)
          throw UserError(contact.where, "friction goes with 'Criterion = surface' of the method's section Contact");
        unsigned int m = 0;
        while (!movers[m].rigid || movers[m].rigid->body != contact.body)
          ++m;
        mover_of.push_back(m);
      }
    require_beyond_periods();
  }

  /// Walls of layers do not know of the images of a body: one that goes on across a periodic face has to be drawn so far beyond it that no
  /// particle sees where the drawing ends.
  template <int dim>
  void
  Contacts<dim>::require_beyond_periods() const
  {
    const auto   scene_box = scene.bounding_box();
    const double support   = with_kernel<dim>(settings.kernel, settings.h(),
                                            [](const auto &kernel) { return kernel.support(); });
    for (const auto &contact : scene.contacts)
      for (unsigned int d = 0; d < dim; ++d)
        {
          const auto  &body  = scene.bodies[contact.body];
          const auto   box   = body.bounding_box();
          const double below = scene_box.lower_bound(d) - box.lower_bound(d),
                       above = box.upper_bound(d) - scene_box.upper_bound(d), least = (1. - 1e-9) * support;
          if (scene.periodic[d] && std::isfinite(support) && std::max(below, above) > -1e-9 * spacing &&
              std::min(below, above) < least)
            throw UserError(body.where, "rigid body '" + body.name +
                                          "' with contact reaches a side where the scene repeats; draw it " +
                                          brief(support) + " m or more beyond both sides along " + "xyz"[d] +
                                          ", or keep it inside");
        }
  }

  /// The place at the start of what is at @p x of the body of contact @p c, where its image nearest to x has pose @p pose.
  template <int dim>
  Point<dim>
  Contacts<dim>::place_at_start(const Neighbours<dim> &neighbours, const unsigned int c, const Rigid::Pose<dim> &pose,
                                const Point<dim> &x) const
  {
    const auto middle = pose.place(scene.bodies[scene.contacts[c].body].bounding_box().center());
    return pose.pivot + transpose(Rigid::rotation_matrix<dim>(pose.rotation)) *
                          (neighbours.image_near(x, middle) - pose.pivot - pose.translation);
  }

  template <int dim>
  void
  Contacts<dim>::start(ParticleSet<dim> &particles) const
  {
    std::uint64_t at_start = 0;
    for (unsigned int c = 0; c < mover_of.size() && settings.contact.criterion == ContactCriterion::none; ++c)
      at_start |= ContactState::touches(c);
    particles.contact.assign(particles.size(), at_start);
    std::fill(particles.contact.begin() + particles.n_free, particles.contact.end(), ContactState::all);
    particles.contact_gaps.assign(mover_of.size(), std::vector<double>(particles.size(), 0.));
    for (const unsigned int m : mover_of)
      {
        const auto &body        = scene.bodies[movers[m].rigid->body];
        double      deepest     = 0.; // of the material in the body [m]
        const auto  is_material = [&](const Point<dim> &X) {
          return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                              [&](const auto &other) { return !other.rigid && other.contains(X); });
        };
        for (unsigned int i = 0; i < particles.n_owned; ++i)
          if (const double depth = -body.shape->distance(particles.X[i]);
              depth > deepest && (i < particles.n_free || is_material(particles.X[i])))
            deepest = depth;
        deepest = dealii::Utilities::MPI::max(deepest, scene.comm);
        if (deepest > spacing)
          throw UserError(body.where, "rigid body '" + body.name + "' reaches " + brief(deepest) +
                                        " m into the material at the start, more than the spacing of " +
                                        brief(spacing) + " m; move it out, or remove its contact: then it is bonded");
      }
  }

  template <int dim>
  void
  Contacts<dim>::start_step(const ParticleSet<dim> &particles)
  {
    states_before  = particles.contact;
    offsets_before = particles.contact_gaps;
    approaches.clear();
    besides.clear();
    n_changes.assign(particles.n_free * mover_of.size(), 0);
    n_turns.assign(any_coulomb ? n_changes.size() : 0, 0);
    n_rounds = 0;
  }

  template <int dim>
  bool
  Contacts<dim>::restore(ParticleSet<dim> &particles) const
  {
    const bool differs     = particles.contact != states_before;
    particles.contact      = states_before;
    particles.contact_gaps = offsets_before;
    return differs;
  }

  template <int dim>
  bool
  Contacts<dim>::change(ParticleSet<dim> &particles, const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                        const std::vector<Rigid::Pose<dim>> &poses, const Motion &motion)
  {
    ++n_rounds;
    if (settings.contact.criterion == ContactCriterion::none)
      return false;
    neighbours.update_ghost_places(particles.x); // pairs, and ghosts with them, may be of earlier places
    const bool changed = settings.contact.criterion == ContactCriterion::surface ?
                           change_by_surface(particles, pairs, neighbours, poses, motion) :
                           change_by_distance(particles, pairs, neighbours, poses);
    neighbours.update_ghosts(particles.contact);
    return dealii::Utilities::MPI::max(changed ? 1 : 0, scene.comm) == 1;
  }

  /// The way from @p X along @p towards to where the material ends [m] as a multiple of the latter; more than surface_depth
  /// spacings where it does not end.
  template <int dim>
  double
  Contacts<dim>::depth_of(const Point<dim> &X, const Tensor<1, dim> &towards) const
  {
    const auto is_inside = [&](const double s) {
      const auto place = Particles::inside_periods(scene, X + s * towards);
      return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                         [&](const auto &body) { return !body.rigid && body.contains(place); });
    };
    double inside = 0., outside = surface_depth * spacing;
    if (is_inside(outside))
      return 2. * outside;
    for (unsigned int k = 0; k < halvings; ++k)
      {
        const double middle                    = .5 * (inside + outside);
        (is_inside(middle) ? inside : outside) = middle;
      }
    return .5 * (inside + outside);
  }

  /// The surface of the body of contact @p c as seen from particle @p i; nothing where it is too far off, or the particle not at its own
  /// surface.
  template <int dim>
  std::optional<typename Contacts<dim>::Seen>
  Contacts<dim>::see(const ParticleSet<dim> &particles, const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                     const unsigned int i, const unsigned int c, const Rigid::Pose<dim> &pose) const
  {
    const auto &shape = *scene.bodies[scene.contacts[c].body].shape;
    const auto  at    = shape.nearest(place_at_start(neighbours, c, pose, particles.x[i]));
    if (at.distance > reach * spacing)
      return std::nullopt;
    const Tensor<1, dim> normal  = Rigid::rotation_matrix<dim>(pose.rotation) * at.normal;
    const Tensor<1, dim> towards = -invert(deformation(particles, pairs, neighbours, i)) * normal;
    const double         h       = depth_of(particles.X[i], towards);
    if (h > surface_depth * spacing)
      return std::nullopt;
    return Seen{at.distance - h - particles.contact_gaps[c][i], normal, at.foot};
  }

  template <int dim>
  bool
  Contacts<dim>::change_by_surface(ParticleSet<dim> &particles, const Pairs<dim> &pairs,
                                   const Neighbours<dim> &neighbours, const std::vector<Rigid::Pose<dim>> &poses,
                                   const Motion &motion)
  {
    bool                        changed = false;
    std::vector<Tensor<1, dim>> forces(mover_of.size()); // of each body on the particle
    std::size_t                 q = 0;                   // of pairs.touching
    for (unsigned int i = 0; i < particles.n_free; ++i)
      {
        std::fill(forces.begin(), forces.end(), Tensor<1, dim>());
        for (; q < pairs.touching.size() && pairs.touching[q].i == i; ++q)
          forces[pairs.touching[q].contact] += motion.forces[q];
        for (unsigned int c = 0; c < mover_of.size(); ++c)
          changed |= (particles.contact[i] & ContactState::touches(c)) != 0 ?
                       !stays_as_it_is(particles, pairs, neighbours, i, c, poses[mover_of[c]], forces[c], motion) :
                       enters(particles, pairs, neighbours, i, c, poses[mover_of[c]], motion);
      }
    for (unsigned int c = 0; c < mover_of.size(); ++c)
      changed |= follow_surface(particles, pairs, neighbours, c, poses[mover_of[c]]);
    return changed;
  }

  /// Particles below the surface touch with those at it. Whether any changes. Collective.
  template <int dim>
  bool
  Contacts<dim>::follow_surface(ParticleSet<dim> &particles, const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                                const unsigned int c, const Rigid::Pose<dim> &pose)
  {
    const auto                 &shape = *scene.bodies[scene.contacts[c].body].shape;
    const auto                  turn  = Rigid::rotation_matrix<dim>(pose.rotation);
    std::vector<std::uint8_t>   is_at_surface(particles.size());
    std::vector<Tensor<1, dim>> ahead(particles.size()); // approaches
    for (unsigned int i = 0; i < particles.n_free; ++i)
      {
        is_at_surface[i] = see(particles, pairs, neighbours, i, c, pose).has_value();
        ahead[i]         = approach(i, c);
      }
    neighbours.update_ghosts(is_at_surface);
    neighbours.update_ghosts(ahead);
    neighbours.update_ghosts(particles.contact);
    bool changed = false;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      {
        const auto at = shape.nearest(place_at_start(neighbours, c, pose, particles.x[i]));
        if (is_at_surface[i] || at.distance > lowest * spacing)
          continue;
        const Tensor<1, dim> n     = turn * at.normal;
        double               cover = 0., touch = 0., slide = 0.; // weights of particles between it and the body
        Tensor<1, dim>       way; // by which those that touch go ahead, times their weight
        for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
          {
            const unsigned int k      = pairs.j[p];
            const double       height = pairs.r[p] * n / spacing;
            const double       aside  = (pairs.r[p] - height * spacing * n).norm_square() / (spacing * spacing);
            if (is_at_surface[k] == 0 || height > -.25 || aside >= 1.)
              continue;
            const double weight = (1. - aside) * (1. - aside);
            cover += weight;
            if ((particles.contact[k] & ContactState::primary(c)) != 0)
              {
                touch += weight;
                way += weight * ahead[k];
              }
            slide += (particles.contact[k] & ContactState::slides(c)) != 0 ? weight : 0.;
          }
        const std::uint64_t before = particles.contact[i];
        particles.contact[i] &= ~(ContactState::touches(c) | ContactState::slides(c));
        approaches.erase({i, c});
        if (touch > .5 * cover)
          {
            particles.contact[i] |= ContactState::touches(c) | (slide > .5 * touch ? ContactState::slides(c) : 0);
            if ((states_before[i] & ContactState::touches(c)) == 0)
              approaches[{i, c}] = way / touch;
          }
        if ((particles.contact[i] & ContactState::slides(c)) == 0)
          besides.erase({i, c});
        changed |= particles.contact[i] != before;
      }
    return changed;
  }

  /// Of a particle that touches: whether it neither leaves nor changes its friction.
  template <int dim>
  bool
  Contacts<dim>::stays_as_it_is(ParticleSet<dim> &particles, const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                                const unsigned int i, const unsigned int c, const Rigid::Pose<dim> &pose,
                                const Tensor<1, dim> &force, const Motion &motion)
  {
    const bool has_friction = scene.contacts[c].type == Contact::Type::coulomb;
    const bool may_leave    = settings.contact.tension_cut_off && changes_of(i, c) < max_changes;
    if (!has_friction && !may_leave)
      return true;
    const auto seen = see(particles, pairs, neighbours, i, c, pose);
    if (!seen) // one below the surface
      return true;
    if (may_leave && is_pulled(particles, i, c, *seen, force, motion))
      {
        leave(particles, i, c, *seen);
        return false;
      }
    return !has_friction ||
           !change_friction(particles, i, c, seen->normal, seen->X, force, motion.of(i, mover_of[c], seen->X));
  }

  /// By places alone, what still comes closer is not: it would be back at once. What nothing but the body holds takes no force, whichever
  /// way it moves: it goes where the body pushes it, and not where that only would draw it.
  template <int dim>
  bool
  Contacts<dim>::is_pulled(const ParticleSet<dim> &particles, const unsigned int i, const unsigned int c,
                           const Seen &seen, const Tensor<1, dim> &force, const Motion &motion) const
  {
    const double along = force * seen.normal;
    if (motion.dt == 0.)
      return along < 0. && motion.of(i, mover_of[c], seen.X) * seen.normal > 0.;
    const double negligible = std::max(negligible_force * modulus[particles.material_of(i)] *
                                         std::pow(spacing, dim - 1),
                                       noise_of_forces * motion.noise);
    const double pushed     = motion.dt * (motion.of_body(mover_of[c], seen.X) * seen.normal);
    return along < (pushed < -negligible_gap * spacing ? negligible : -negligible);
  }

  template <int dim>
  void
  Contacts<dim>::leave(ParticleSet<dim> &particles, const unsigned int i, const unsigned int c, const Seen &seen)
  {
    particles.contact[i] &= ~(ContactState::touches(c) | ContactState::primary(c) | ContactState::slides(c));
    besides.erase({i, c});
    if (changes_of(i, c) == 0) // else it has come within this step
      particles.contact_gaps[c][i] += seen.gap;
    approaches.erase({i, c});
    ++changes_of(i, c);
  }

  /// By the @p force of its pairs, as above, and its @p velocity relative to the body: whether particle @p i begins to slide or to stick, or
  /// its friction has another size than it should.
  template <int dim>
  bool
  Contacts<dim>::change_friction(ParticleSet<dim> &particles, const unsigned int i, const unsigned int c,
                                 const Tensor<1, dim> &normal, const Point<dim> &X, const Tensor<1, dim> &force,
                                 const Tensor<1, dim> &velocity)
  {
    const double         largest = scene.contacts[c].friction * std::max(0., force * normal);
    const Tensor<1, dim> shear = force - (force * normal) * normal, way = velocity - (velocity * normal) * normal;
    const bool           slides = (particles.contact[i] & ContactState::slides(c)) != 0;
    std::uint8_t        &turns  = n_turns[i * mover_of.size() + c];
    if (!slides)
      {
        if (shear.norm() <= largest)
          return false;
        particles.contact[i] |= ContactState::slides(c);
        add_force(i, c, X, largest / shear.norm() * shear);
        ++turns;
        return true;
      }
    const auto           found = besides.find({i, c});
    const Tensor<1, dim> last  = found == besides.end() ? Tensor<1, dim>() : found->second.force;
    if (turns < max_changes - 1 && last * way > 0.) // the last turn is one to sliding
      {
        particles.contact[i] &= ~ContactState::slides(c);
        besides.erase({i, c});
        ++turns;
        return true;
      }
    const double         size = last * way < 0. || last.norm() == 0. ? way.norm() : -last.norm();
    const Tensor<1, dim> next = size == 0. ? Tensor<1, dim>() : -largest / size * (size > 0. ? way : last);
    if (n_rounds >= max_friction_rounds || (next - last).norm() <= friction_tolerance * largest)
      return false;
    add_force(i, c, X, next);
    return true;
  }

  template <int dim>
  void
  Contacts<dim>::add_force(const unsigned int i, const unsigned int c, const Point<dim> &X,
                           const Tensor<1, dim> &friction)
  {
    besides[{i, c}] = Force{mover_of[c], X, friction};
  }

  template <int dim>
  void
  Contacts<dim>::find_friction(const ParticleSet<dim> &particles, const Pairs<dim> &pairs, const Motion &motion)
  {
    for (std::size_t e = 0; e < pairs.touching.size(); ++e)
      {
        const auto &[i, p, c, slides] = pairs.touching[e];
        if (!slides || (particles.contact[i] & ContactState::slides(c)) == 0)
          continue;
        const auto          &wall = pairs.wall(p);
        const Tensor<1, dim> v    = motion.of(i, mover_of[c], wall.X);
        const Tensor<1, dim> way  = v - (v * wall.normal) * wall.normal;
        const double         size = scene.contacts[c].friction * std::max(0., motion.forces[e] * wall.normal);
        if (const double speed = way.norm(); speed > 0.)
          add_force(i, c, wall.X, -size * (way / speed));
      }
  }

  template <int dim>
  bool
  Contacts<dim>::enters(ParticleSet<dim> &particles, const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                        const unsigned int i, const unsigned int c, const Rigid::Pose<dim> &pose, const Motion &motion)
  {
    const auto seen = see(particles, pairs, neighbours, i, c, pose);
    if (!seen)
      return false;
    const auto   way = motion.dt * motion.of(i, mover_of[c], seen->X);
    const double end = seen->gap + way * seen->normal;
    if (end >= -negligible_gap * spacing)
      return false;
    particles.contact[i] |= ContactState::touches(c) | ContactState::primary(c);
    ++changes_of(i, c);
    if (motion.dt > 0.)
      approaches[{i, c}] = std::clamp(seen->gap / (seen->gap - end), 0., 1.) / motion.dt * way;
    return true;
  }

  template <int dim>
  bool
  Contacts<dim>::change_by_distance(ParticleSet<dim> &particles, const Pairs<dim> &pairs,
                                    const Neighbours<dim> &neighbours, const std::vector<Rigid::Pose<dim>> &poses)
  {
    const auto before = particles.contact; // of ghosts, these are those of their owners in the end only
    besides.clear();
    for (unsigned int c = 0; c < mover_of.size(); ++c)
      {
        const std::uint64_t touches = ContactState::touches(c), primary = ContactState::primary(c);
        const auto         &pose  = poses[mover_of[c]];
        const auto         &shape = *scene.bodies[scene.contacts[c].body].shape;
        for (unsigned int i = 0; i < particles.n_free; ++i)
          {
            const auto   X   = place_at_start(neighbours, c, pose, particles.x[i]);
            const double d   = shape.distance(X) / spacing + depth_of_bodies;
            const bool   was = (particles.contact[i] & primary) != 0;
            particles.contact[i] &= ~(touches | primary);
            if (d <= (was ? settings.contact.release : settings.contact.distance))
              particles.contact[i] |= touches | primary;
            if (d < settings.contact.repulsion)
              add_repulsion(particles, i, c, pose, X);
          }
        neighbours.update_ghosts(particles.contact);
        for (unsigned int i = 0; i < particles.n_free; ++i)
          {
            const auto first = pairs.j.begin() + pairs.row_start[i], last = pairs.j.begin() + pairs.row_fixed[i];
            if (std::any_of(first, last, [&](const unsigned int k) { return (particles.contact[k] & primary) != 0; }) &&
                pairs.kernel_sum(particles, i, true) > settings.contact.support_threshold)
              particles.contact[i] |= touches;
          }
      }
    return !std::equal(before.begin(), before.begin() + particles.n_free, particles.contact.begin());
  }

  template <int dim>
  void
  Contacts<dim>::add_repulsion(const ParticleSet<dim> &particles, const unsigned int i, const unsigned int c,
                               const Rigid::Pose<dim> &pose, const Point<dim> &X)
  {
    const auto   at      = scene.bodies[scene.contacts[c].body].shape->nearest(X);
    const double missing = settings.contact.repulsion - depth_of_bodies - at.distance / spacing; // over the spacing
    add_force(i, c, at.foot,
              modulus[particles.material_of(i)] * std::pow(spacing, dim - 1) * missing *
                (Rigid::rotation_matrix<dim>(pose.rotation) * at.normal));
  }

  template class Contacts<2>;
  template class Contacts<3>;
} // namespace Stroma::Sph
