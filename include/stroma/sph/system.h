#pragma once

#include <stroma/base/log.h>
#include <stroma/particles/rigid_step.h>
#include <stroma/rigid/wrench.h>
#include <stroma/sph/area_vectors.h>
#include <stroma/sph/body_balance.h>
#include <stroma/sph/boundary_stress.h>
#include <stroma/sph/contact.h>
#include <stroma/sph/elasticity.h>
#include <stroma/sph/friction.h>
#include <stroma/sph/hourglass_control.h>
#include <stroma/sph/loads.h>
#include <stroma/sph/packing.h>

#include <memory>
#include <optional>

namespace Stroma::Sph
{
  /// Whether the particles' velocity follows from forces alone or from accelerations.
  enum class Dynamics
  {
    overdamped, ///< NSPH
    inertial    ///< SPH
  };

  /**
   * The particles of a scene, the geometry of their pairs, and the forces between them. A method decides how velocities follow
   * from the forces, and calls, step by step: set_step(), the forces, and commit().
   *
   * In two dimensions everything here is for a thickness of 1 m.
   */
  template <int dim>
  class System
  {
  public:
    using Velocities = std::vector<dealii::Tensor<1, dim>>; ///< one a particle, ghosts and wall points (Pairs) included

    /// Throws UserError for a scene that particles cannot solve.
    System(const Scene<dim> &scene, const Settings &settings, Dynamics dynamics, double end_time, Timers &timers);

    /// Lays out the particles. Throws UserError. Collective.
    void arrange();
    /// Takes those of a checkpoint instead: the owned ones, any on any rank. Collective.
    void restore(ParticleSet<dim> &&owned);

    /// Neighbours (if they are outdated, or @p anew) and pair geometry of the particles where they are, unless none has moved by
    /// a thousandth of the spacing since. Where it fails, everything is of the particles as they are, but for what failed, and
    /// is found anew at the next call. Collective.
    StepStatus update_geometry(bool anew = false);

    /// Takes back what update_geometry() did to the stresses of particles without inertia, after a step that failed.
    void undo_draw();

    /// At the start of a step, which keeps the contacts for restore_contacts(). @param by_places whether particles enter and leave
    /// by where they are, whatever the criterion. @param changed whether some do; pairs are then found anew. Collective.
    StepStatus start_contacts(bool by_places, bool &changed);

    /// The same by what the step of length @p dt would do with velocities @p mean over it and @p end at its end. @param changed whether
    /// anything has: then the solve has to be repeated. Collective.
    StepStatus change_contacts(const Velocities &mean, const Velocities &end, double dt, bool &changed);

    /// Goes back to the contacts that the step began with. Collective.
    void restore_contacts();

    /// Number of particles in touch, largest pressure, area and half width of each contact, of the committed state. Collective.
    std::vector<std::pair<std::string, double>> contact_scalars();

    /// The pairs that the particles of a checkpoint had, after restore() and set_step(): a resumed run finds new ones when the
    /// uninterrupted run does. On the same ranks all is the same to the last digit.
    /// @param found_at time of these pairs [s] @param n_in_order that of the neighbours. Collective.
    void restore_pairs(double found_at, unsigned int n_in_order);

    /// Loads, and velocities of fixed and held particles, for the step from @p t to @p t_next; bodies that the balance of forces
    /// moves go on as they moved last. Collective.
    void set_step(double t, double t_next);

    /// Lets these bodies go through the step with velocities @p mean, unknowns of bodies, and have @p end after commit(). Local.
    void take_body_velocities(const std::vector<double> &mean, const std::vector<double> &end);

    /// Adds the components that are given to @p twists, of the step.
    void add_given(std::vector<Rigid::Twist<dim>> &twists) const;

    /// After state_forces() or find_state_forces(): the parts of the pairs of row @p i with walls in it; calls visit(p, force).
    template <typename Visit>
    void visit_state_forces_of_walls(unsigned int i, const Visit &visit) const;
    /// Forces on these bodies of loads of time @p load_time, stresses and hourglass control, after state_forces(). Collective.
    std::vector<double> state_forces_on_bodies(double load_time) const;

    /// Velocities in the step of what was at @p X of mover @p m at the start [m/s].
    dealii::Tensor<1, dim> wall_velocity(unsigned int m, const dealii::Point<dim> &X) const;

    /// The same of the step that led to the state of a checkpoint, with poses of its start. Collective.
    void restore_step(double t, double t_next, const std::vector<double> &body_motions);
    /// Of the fastest place of these bodies' boxes in the step [m/s].
    double fastest_body() const;
    /// Kinetic energy of these bodies [J over the thickness].
    double energy_of_bodies() const;

    /// Poses, velocities and momenta now of the bodies that the balance of forces moves, for a checkpoint.
    std::vector<double> body_motions();

    /// Sets @p v's fixed and held entries to those of the step, its ghosts, and adds those of wall points. Collective.
    void impose(Velocities &v);
    /// Velocities @p v of particles and ghosts with those of the wall points, as they were imposed last. Local.
    Velocities with_walls(Velocities v) const;
    /// Whose wall pair @p p ends at, one with a wall.
    unsigned int
    mover_of(const std::size_t p) const
    {
      return pairs.mover(particles, p);
    }
    /// Whether a component of a free particle is held.
    bool
    is_held(const unsigned int i, const unsigned int c) const
    {
      return loads->is_held(i, c);
    }

    /// Cauchy stress of the state, ghosts included; in-plane part [Pa]. With segments that of wall points follows.
    std::vector<dealii::SymmetricTensor<2, dim>> stresses() const;

    /// f = loads of time @p load_time + stresses + hourglass control of the state, on free particles [N]. Collective.
    void state_forces(Velocities &f, double load_time);
    /// What the parts of pairs in it go by, without the sums. Collective.
    void find_state_forces(double load_time);

    /// f = state_forces() and friction of velocities @p v, in the same sums over pairs where that can be. Collective.
    void forces(Velocities &f, const Velocities &v, double load_time);

    /// f += friction of velocities @p v on free particles. Collective.
    void add_friction(Velocities &f, const Velocities &v) const;
    /// What the parts of pairs in it go by, without the sums. Collective.
    void find_friction(const Velocities &v) const;

    /// After add_friction(f, v) or find_friction(v): the part of pair @p p in the force on particle @p i of its row.
    dealii::Tensor<1, dim> friction_of_pair(unsigned int i, std::size_t p, const Velocities &v) const;

    /// Finds the gradient of @p v, which check() and commit() go by.
    void set_gradient(const Velocities &v);

    /// Whether velocities @p v may be committed over @p dt: no particle may move by more than @p largest_move spacings, be
    /// strained by more than @p largest_strain (norm of L dt), or be left with less than a tenth of its volume; and all must be
    /// finite; nor may the places and volumes of a fluid have drifted apart. After set_gradient(v). Collective.
    StepStatus check(const Velocities &v, double dt, double largest_move, double largest_strain) const;

    double largest_gradient() const; ///< norm of those of set_gradient(), of this rank [1/s]

    /// Moves the owned particles by @p v dt, and updates volumes, stresses and hourglass control with its gradient, see
    /// set_gradient(). The state is then that of the step's end. Collective.
    void commit(const Velocities &v, double dt);

    /// Of a fluid, and of what is degraded, that has moved with velocities @p v over @p dt: shifts crowded particles, see Packing. Collective.
    void shift(const Velocities &v, double dt);

    /// Speeds of bodies that propel themselves, particles within them, volume of the whole; of the committed state. Collective.
    std::vector<std::pair<std::string, double>> process_scalars() const;

    /// Why nothing more can be told of the scene, or "": a body that propels itself has come so near to a side, or to another body, that
    /// particles between them see both.
    std::string reason_to_end() const;

    /// Forces by which what holds the material does so, of the committed state [N over the thickness].
    struct Reactions
    {
      std::vector<dealii::Tensor<1, dim>> of_supports;
      std::vector<Rigid::Wrench<dim>>     of_movers; ///< torques: of rigid bodies
    };
    /// Collective.
    Reactions reactions();

    /// Of Hooke's law, the equation of state and, as state_forces() left it, hourglass control [J over the thickness]; collective.
    double                 strain_energy() const;
    double                 largest_displacement() const;       ///< [m]; collective
    dealii::Tensor<1, dim> displacement(unsigned int i) const; ///< since the start, less than half a period [m]
    double
    thickness() const
    {
      return dim == 2 ? scene.thickness : 1.;
    }
    unsigned int
    material_of(const unsigned int i) const
    {
      return particles.material_of(i);
    }
    bool
    has_solids() const
    {
      return !scene.is_fluid();
    }
    /// Not a fluid, nor degraded to one.
    bool
    is_solid(const unsigned int i) const
    {
      return has_solids() && !(degraded && i < particles.n_free && particles.intact[i] == 0.);
    }
    bool
    has_interfaces() const
    {
      return has_solids() && !settings.published() && Interfaces<dim>::exist_among(constitutions);
    }
    bool
    is_viscous() const
    {
      return friction != nullptr || is_smooth;
    } ///< whether anything is, in either form
    bool
    is_supported() const
    {
      return has_walls() || loads->holds_any();
    } ///< on any rank
    bool
    has_walls() const
    {
      return n_fixed > 0 || pairs.has_facets();
    } ///< on any rank
    double
    mass(const unsigned int i) const
    {
      return constitutions[material_of(i)].rho * particles.V0[i];
    } ///< [kg], per metre in 2D

    const Scene<dim>               &scene;
    const Settings                  settings;
    const std::vector<Constitution> constitutions;
    const std::vector<Mover<dim>>   movers;
    ParticleSet<dim>                particles;

    std::unique_ptr<Neighbours<dim>>  neighbours;
    Pairs<dim>                        pairs;
    std::unique_ptr<AreaVectors<dim>> area_vectors; ///< not where the formulation is published
    std::unique_ptr<Friction<dim>>    friction; ///< of pairs; not where nothing is viscous, or the friction is smooth
    bool                              is_smooth = false; ///< friction is that of the velocity gradient, see Elasticity
    /// Of solids whose moduli differ; not where the formulation is published.
    std::unique_ptr<Interfaces<dim>>       interfaces;
    std::unique_ptr<DegradedShear<dim>>    degraded;          ///< where the scene has a degradation
    std::unique_ptr<DegradedFriction<dim>> degraded_friction; ///< the same
    std::unique_ptr<Elasticity<dim>>       elasticity;
    /// Of solids; not where the formulation is published.
    std::unique_ptr<HourglassControl<dim>> hourglass_control;
    std::unique_ptr<Packing<dim>> packing; ///< of fluids and what is degraded, not where the formulation is published
    std::unique_ptr<Loads<dim>>   loads;
    std::unique_ptr<BoundaryStress<dim>> boundary_stress; ///< where published pairs meet segments
    std::unique_ptr<BodyBalance<dim>>    bodies;          ///< where the balance of forces moves any
    std::unique_ptr<Contacts<dim>>       contacts;        ///< where the scene has some

    // State besides the particles.
    double       now        = 0.; ///< time of the particles' places [s]
    double       residual   = 0.; ///< bound of what the last solve has left of the balance [N]
    double       pairs_time = 0.; ///< and of those that the pairs were found at [s]
    unsigned int n_pairings = 0;  ///< times that pairs were found
    double       drawn_at   = 0.; ///< and when stresses were drawn to the strain of places last [s]
    double
    step_start() const
    {
      return t;
    } ///< of the last step [s]
    std::vector<Rigid::Pose<dim>>
      poses; ///< of the rigid bodies now, by mover; of a side that moves as one, its translation
    std::vector<Rigid::Pose<dim>>                    pairs_poses; ///< and when the pairs were found
    std::vector<Rigid::Twist<dim>>                   twists;      ///< of those that the balance of forces moves, now
    std::vector<std::optional<Rigid::Momentum<dim>>> momenta;     ///< of these, with inertia
    std::uint64_t                                    n_free = 0, n_fixed = 0; ///< of all ranks
    /// When the last step began: what set_step() goes by.
    std::vector<Rigid::Pose<dim>> poses_before() const;

  private:
    void                           start_fields();
    std::vector<bool>              degrading_movers() const;
    void                           make_parts();
    void                           count();
    bool                           has_moved() const;
    double                         move_of_facets() const;
    double                         largest_wall_speed() const;
    void                           find_hourglass_forces();
    void                           swap_with_pairs();
    StepStatus                     find_pairs(bool from_scratch);
    StepStatus                     find_pairs_here();
    typename Contacts<dim>::Motion contact_motion(const Velocities &mean, const Velocities &end, double dt) const;
    Velocities                     contact_forces(const Velocities &mean, const Velocities &end, double dt) const;
    void                           set_coefficients();
    void                           start_degradation();
    void                           degrade(double dt);
    dealii::Tensor<1, dim>         off_bodies(const dealii::Point<dim> &x) const;
    double                         distance_of(unsigned int body, const dealii::Point<dim> &x) const;
    dealii::BoundingBox<dim>       box_of(unsigned int body) const;
    void                           find_wall_velocities();
    void                           prescribe();
    template <typename Visit>
    void visit_motions(const Visit &visit);
    void add_to_mover(std::vector<Rigid::Wrench<dim>> &wrenches, std::size_t p,
                      const dealii::Tensor<1, dim> &force) const;
    void move_bodies();
    /// Of wall points, with bodies at @p at and sides as at time @p time.
    typename HourglassControl<dim>::OfWalls wall_displacements(const std::vector<Rigid::Pose<dim>> &at,
                                                               double                               time) const;
    /// Of particle @p i's volume in a step with velocity gradient @p L; of solids that of its places.
    double     volume_change(unsigned int i, const dealii::Tensor<2, dim> &L, double dt) const;
    StepStatus renew_geometry(bool anew);
    /// J and S of solid particles whose neighbours are those of the start: draws what rates have added up to towards the strain of now, the
    /// same operator's gradient of displacements, so that nothing stays of a deformation that is undone. Collective.
    void   draw_to_strain_of_places();
    double share_of_places(unsigned int material, double dt) const;
    /// What it changes, as it was before.
    struct Undrawn
    {
      decltype(ParticleSet<dim>::S)            S;
      decltype(ParticleSet<dim>::J)            J;
      decltype(ParticleSet<dim>::contact_gaps) contact_gaps;
      double                                   drawn_at;
    };
    /// With the gradient at the middle of the step, so that a step back undoes a step (Hughes & Winget 1980).
    void update_stress(unsigned int i, const dealii::Tensor<2, dim> &L, double dt);

    const bool                                 is_inertial;
    const double                               end_time; ///< of the run [s]
    Timers                                    &timers;
    std::optional<Undrawn>                     undrawn; ///< of the step
    std::vector<dealii::Tensor<2, dim>>        L;       ///< of the rows, of the last velocities it was asked for [1/s]
    std::vector<std::optional<RigidStep<dim>>> steps;   ///< of rigid bodies, by mover
    std::vector<std::optional<RigidStep<dim>>>
                                   at_end;     ///< with the velocities at the end of the step, once these are known
    std::vector<Rigid::Twist<dim>> ends_as;    ///< and these themselves
    Velocities                     prescribed; ///< of owned fixed particles [m/s]
    Velocities                     of_walls;   ///< of wall points [m/s]
    double                         t = 0., t_next = 0.; ///< of the step [s]
  };

  template <int dim>
  template <typename Visit>
  void
  System<dim>::visit_state_forces_of_walls(const unsigned int i, const Visit &visit) const
  {
    elasticity->visit_wall_forces(i, [&](const unsigned int p, const dealii::Tensor<1, dim> &force) {
      visit(p, hourglass_control ? force + hourglass_control->pair_force(i, p) : force);
    });
  }
} // namespace Stroma::Sph
