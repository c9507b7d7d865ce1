#include <stroma/base/text.h>
#include <stroma/sph/contact.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace Stroma::Sph
{
  using dealii::Point;
  using dealii::Tensor;

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
