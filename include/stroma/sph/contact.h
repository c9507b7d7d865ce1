#pragma once

#include <stroma/sph/contact_state.h>
#include <stroma/sph/pairs.h>

#include <functional>
#include <map>
#include <optional>

namespace Stroma::Sph
{
  /**
   * Which particles touch the rigid bodies that have a contact. Only those have pairs with the body's wall: others do not feel it,
   * however near it is.
   *
   * By the criterion `surface` contact is one of surfaces. A particle next to the material's surface carries a piece of it: the place
   * where the line from X towards the body, -F^-1 n, leaves the material; n is the body's normal and F the deformation gradient at the
   * particle, by least squares over its neighbours. That piece is h away from the particle along -n, and
   *   gap = distance of the particle from the body - h - h_0.
   * A particle enters where the gap closes, and what closes it within a step makes no stress: the wall goes ahead by that much
   * (approach()). It leaves when it would be pulled. The gap at which it left is then its h_0 and the gap at which it enters again:
   * so the strain that a contact adds is undone when it breaks, and cycles of making and breaking let no stress drift. It fades as the
   * stress comes to that of the places (System::draw_to_strain_of_places).
   *
   * Particles further below within the kernel's support, which the area of the wall reaches as well, touch with those at the surface that
   * lie between them and the body: with most of these, by their distance from the line.
   *
   * Friction (Coulomb): a particle sticks until its force along the surface is more than the coefficient times that across. Then it
   * slides: it has the pair of a frictionless contact and, as a force by itself, a friction against its motion, which changes()
   * brings to its size round by round; and it sticks again where that would push it along.
   *
   * By the criterion `heck` (2.5.5 of Heck 2017) primary particles touch within a distance until they are beyond another one, and
   * with each all within the kernel's support that are not at the surface, going by (33). By `none` all do.
   */
  template <int dim>
  class Contacts
  {
  public:
    static constexpr unsigned int max_changes = 3; ///< of a particle in a step; after these it stays in contact
    /// Rounds of a step after which the size of friction is left as it is: the next step goes on from there.
    static constexpr unsigned int max_friction_rounds = 6;

    Contacts(const Scene<dim> &scene, const std::vector<Mover<dim>> &movers, const Settings &settings);

    /// Gives @p particles, owned ones just laid out, the states of the start. Throws UserError where a body reaches into the
    /// material by more than a spacing. Collective.
    void start(ParticleSet<dim> &particles) const;

    /// Keeps the states at the start of a step, for restore().
    void start_step(const ParticleSet<dim> &particles);
    /// Goes back to them; whether any differs on this rank.
    bool restore(ParticleSet<dim> &particles) const;
    /// Of a step that is committed: walls do not go ahead any more.
    void
    end_step()
    {
      approaches.clear();
    }
    /// Whether particles enter and leave by where they are at the start of a step, whatever it does.
    bool
    is_of_places() const
    {
      return settings.contact.criterion == ContactCriterion::heck;
    }

    /// What change() goes by.
    struct Motion
    {
      std::vector<dealii::Tensor<1, dim>> forces; ///< on the material, of pairs.touching at the end of the step [N]
      /// Velocity of particle i relative to what was at X of mover m [m/s].
      std::function<dealii::Tensor<1, dim>(unsigned int i, unsigned int m, const dealii::Point<dim> &X)> of;
      /// Velocity of what was at X of mover m [m/s].
      std::function<dealii::Tensor<1, dim>(unsigned int m, const dealii::Point<dim> &X)> of_body;
      double dt    = 0.; ///< length of the step [s]; 0: particles are where they are
      double noise = 0.; ///< what a solve has left of the balance: smaller forces may have either sign [N]
    };

    /// Lets particles enter and leave by where they are and what the step would do to them; whether any has. @p pairs are those
    /// of the particles as they are. Collective.
    bool change(ParticleSet<dim> &particles, const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                const std::vector<Rigid::Pose<dim>> &poses, const Motion &motion);

    /// Friction of the particles that slide, for the state that @p motion is of. After start_step().
    void find_friction(const ParticleSet<dim> &particles, const Pairs<dim> &pairs, const Motion &motion);
    bool
    has_friction() const
    {
      return any_coulomb;
    }

    /// Forces that particles and bodies have upon each other besides those of their pairs.
    struct Force
    {
      unsigned int           mover;
      dealii::Point<dim>     X;     ///< undeformed place of the body where it acts
      dealii::Tensor<1, dim> force; ///< on the particle [N]
    };
    using Forces = std::map<std::pair<unsigned int, unsigned int>, Force>; ///< by particle and contact
    /// Friction and repulsion.
    const Forces &
    forces() const
    {
      return besides;
    }

    /// Velocity by which the wall of contact @p c goes ahead for particle @p i, which enters in this step [m/s].
    dealii::Tensor<1, dim>
    approach(const unsigned int i, const unsigned int c) const
    {
      const auto found = approaches.find({i, c});
      return found == approaches.end() ? dealii::Tensor<1, dim>() : found->second;
    }

  private:
    std::uint8_t &
    changes_of(const unsigned int i, const unsigned int c)
    {
      return n_changes[i * mover_of.size() + c];
    }

    /// A body's surface as seen from a particle.
    struct Seen
    {
      double                 gap; ///< between the surfaces [m]
      dealii::Tensor<1, dim> normal;
      dealii::Point<dim>     X; ///< undeformed place of the body's surface
    };
    std::optional<Seen> see(const ParticleSet<dim> &particles, const Pairs<dim> &pairs,
                            const Neighbours<dim> &neighbours, unsigned int i, unsigned int c,
                            const Rigid::Pose<dim> &pose) const;
    dealii::Point<dim>  place_at_start(const Neighbours<dim> &neighbours, unsigned int c, const Rigid::Pose<dim> &pose,
                                       const dealii::Point<dim> &x) const;
    void                require_beyond_periods() const;
    double              depth_of(const dealii::Point<dim> &X, const dealii::Tensor<1, dim> &towards) const;
    bool change_by_surface(ParticleSet<dim> &particles, const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                           const std::vector<Rigid::Pose<dim>> &poses, const Motion &motion);
    bool stays_as_it_is(ParticleSet<dim> &particles, const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                        unsigned int i, unsigned int c, const Rigid::Pose<dim> &pose,
                        const dealii::Tensor<1, dim> &force, const Motion &motion);
    bool is_pulled(const ParticleSet<dim> &particles, unsigned int i, unsigned int c, const Seen &seen,
                   const dealii::Tensor<1, dim> &force, const Motion &motion) const;
    void leave(ParticleSet<dim> &particles, unsigned int i, unsigned int c, const Seen &seen);
    bool enters(ParticleSet<dim> &particles, const Pairs<dim> &pairs, const Neighbours<dim> &neighbours, unsigned int i,
                unsigned int c, const Rigid::Pose<dim> &pose, const Motion &motion);
    bool follow_surface(ParticleSet<dim> &particles, const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                        unsigned int c, const Rigid::Pose<dim> &pose);
    bool change_friction(ParticleSet<dim> &particles, unsigned int i, unsigned int c,
                         const dealii::Tensor<1, dim> &normal, const dealii::Point<dim> &X,
                         const dealii::Tensor<1, dim> &force, const dealii::Tensor<1, dim> &velocity);
    void add_force(unsigned int i, unsigned int c, const dealii::Point<dim> &X, const dealii::Tensor<1, dim> &force);
    void add_repulsion(const ParticleSet<dim> &particles, unsigned int i, unsigned int c, const Rigid::Pose<dim> &pose,
                       const dealii::Point<dim> &X);
    bool change_by_distance(ParticleSet<dim> &particles, const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                            const std::vector<Rigid::Pose<dim>> &poses);

    const Scene<dim>              &scene;
    const std::vector<Mover<dim>> &movers;
    const Settings                 settings;
    const double                   spacing; ///< [m]
    const double depth_of_bodies; ///< of the particles that stand for them, within their surface; over the spacing
    std::vector<unsigned int> mover_of; ///< of each contact
    bool                      any_coulomb = false;
    std::vector<double>       modulus; ///< of P-waves, of each material [Pa]

    // Of the step.
    std::vector<std::uint64_t>       states_before;
    std::vector<std::vector<double>> offsets_before; ///< of each contact
    std::map<std::pair<unsigned int, unsigned int>, dealii::Tensor<1, dim>>
                              approaches; ///< by particle and contact; not there: 0
    std::vector<std::uint8_t> n_changes,
      n_turns; ///< of each particle's contacts; turns from sticking to sliding and back
    unsigned int n_rounds = 0;
    Forces       besides;
  };
} // namespace Stroma::Sph
