#pragma once

#include <stroma/output/archive.h>
#include <stroma/rigid/contact.h>
#include <stroma/rigid/contact_settings.h>
#include <stroma/rigid/coupling.h>

namespace Stroma::Rigid
{
  /// A point of the material's surface that may touch rigid bodies.
  template <int dim>
  struct ContactPoint : CarriedPoint<dim>
  {
    std::uint64_t     name = 0; ///< the same on any number of ranks
    double            area = 0; ///< w [m^2], in the plane times the thickness
    ContactState<dim> state;
  };

  /**
   * Contact of a material's surface with a rigid body, point by point (ContactLaw): an active set, and multipliers that bring the
   * gap of the active points to zero. What carries the points, nodes of a mesh or of a grid, is the method's.
   *
   * A point with surface area w carries the force w T, and the body the opposite (Coupling). Between Newton's solves update()
   * moves the multipliers and the set. A body that forces move without inertia is held back by springs to its last place while the
   * set still changes, so that it never runs away; they are gone at the end.
   */
  template <int dim>
  class ContactSet
  {
  public:
    using Points = std::vector<ContactPoint<dim>>;

    /// @param inertia whether a body with a mass has it @param cell_size of the cells at the surface [m] @param points of this rank, without state. Throws UserError if the
    /// rigid body lies in the material at the start. Collective.
    ContactSet(const Scene<dim> &scene, const Contact &contact, const ContactSettings &settings, bool inertia,
               double cell_size, const Unknowns<dim> &unknowns, Points points);

    /// Scales the stiffness of contact to that of a solid whose velocity changes by @p v_factor [1/s] with its displacement.
    void set_stage(double v_factor);

    /// Starts a step from displacement @p u (relevant unknowns): keeps the state for restore().
    void start_step(const Vector &u);
    /// Back to the state at start_step().
    void restore();

    /// Moves a body that touches nothing along the force on it, or turns it along the torque if there is no force, until it
    /// touches, in the first guess @p u (owned unknowns). Returns false if it never would. Collective.
    /// @param external forces, if there are any @param t time of the loads [s]
    bool approach(Vector &u, const Vector &external, double t);

    /// Norm of the contact forces of the active points before the gap's parts cancel [N]: their round-off is a part of
    /// that. Collective. @param u relevant unknowns
    double summed_force(const Vector &u) const;

    /// Adds the contact forces at @p u (relevant unknowns) to @p r. Local; compress afterwards.
    void add_force(Vector &r, const Vector &u) const;
    /// Adds their negative derivative to K and the share of jumps to @p r.
    void add_tangent(Matrix &K, Vector &r, const Vector &u, const Solvers::Constraints &constraints) const;
    /// Adds the places of add_tangent() to the pattern.
    void add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const;

    /// After Newton: moves multipliers and active set to @p u. Whether the solution must be found anew. Collective.
    bool update(const Vector &u);

    /// Whether the last update() has found that only the springs bear the loads on the body, which touches nothing.
    bool
    is_unborne() const
    {
      return unborne;
    }
    const std::string &
    body_name() const
    {
      return scene.bodies[contact.body].name;
    }

    /// Results, named after the body: its displacement in @p u, and of the tractions of the last update(), found at
    /// @p balanced, their sum on the body, the largest pressure, the area, with friction that of it which slides, and (in the plane) half the
    /// width along x.
    /// Collective.
    std::vector<std::pair<std::string, double>> scalars(const Vector &u, const Vector &balanced) const;

    void save(Output::ArchiveWriter &archive) const;
    void load(const Output::ArchiveReader &archive);

  private:
    using Vec = dealii::Tensor<1, dim>;

    /// What a round of update() has seen; sums and maxima over the points of this rank, then of all.
    struct Round
    {
      bool   changed   = false;
      double violation = 0., missing = 0., total = 0.;
    };
    static constexpr unsigned int n_components = dim + n_rotations<dim>;

    void          check_start() const;
    bool          touches() const;
    Coupling<dim> coupling(const Vector &u) const;
    Vec           driving_force(const Vector &external) const;
    Axial<dim>    driving_torque(double t) const;
    double        gap_along(const Vec &direction) const;
    bool          move(Vector &u, const Vec &direction);
    Coupling<dim> turned(const Axial<dim> &change) const;
    double        angle_along(const Axial<dim> &direction) const;
    bool          turn(Vector &u, const Axial<dim> &direction);
    void          shift(Vector &u, unsigned int component, double way);
    void update(ContactPoint<dim> &point, const dealii::Point<dim> &from, const dealii::Point<dim> &x, double inside,
                Round &round) const;
    bool release_spring(const Vector &u, const Round &round);

    const Scene<dim>                &scene;
    const Contact                   &contact;
    const Unknowns<dim>             &unknowns;
    const Shapes::Shape<dim>        &shape;
    const unsigned int               rigid; ///< index among the rigid bodies
    const double                     cell_size, penalty, tolerance;
    const ContactLaw<dim>            law;
    double                           half_width = 0.;                 ///< of the body [m]
    double                           eps = 0., spring_stiffness = 0.; ///< of the stage [Pa/m], [N/m]
    Points                           points, saved_points;            ///< of this rank
    Vector                           start;                           ///< relevant unknowns at the start of the step
    std::vector<unsigned int>        by_balance;   ///< components of the body that forces move without inertia
    std::array<double, n_components> spring_place; ///< of the body's unknowns, at which the springs are free [m]
    bool                             has_spring = false, unborne = false;
  };
} // namespace Stroma::Rigid
