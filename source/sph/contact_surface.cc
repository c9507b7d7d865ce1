#include <stroma/particles/border_volumes.h>
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

  template bool Contacts<2>::change_by_surface(ParticleSet<2> &, const Pairs<2> &, const Neighbours<2> &,
                                               const std::vector<Rigid::Pose<2>> &, const Motion &);
  template bool Contacts<3>::change_by_surface(ParticleSet<3> &, const Pairs<3> &, const Neighbours<3> &,
                                               const std::vector<Rigid::Pose<3>> &, const Motion &);
} // namespace Stroma::Sph
