#pragma once

#include <stroma/fem/unknowns.h>
#include <stroma/output/archive.h>
#include <stroma/rigid/contact.h>
#include <stroma/solvers/time_scheme.h>

namespace Stroma::Fem
{
  /**
   * Contact of a solid's surface with a rigid body, node by node (Rigid::ContactLaw): an active set, and multipliers that
   * bring the gap of the active nodes to zero.
   *
   * A node with surface area w (the integral of its shape function) carries the force w T, and the body the opposite.
   * Between Newton's solves update() moves the multipliers and the set. A body that is driven by a force is held back by a
   * spring to its last place while the set still changes, so that it never runs away; the spring is gone at the end.
   */
  template <int dim>
  class RigidContact
  {
  public:
    /// Throws UserError if the rigid body lies in the material at the start. Collective.
    RigidContact(const Scene<dim> &scene, const Contact &contact, const Settings<dim> &settings, const Mesh<dim> &mesh,
                 const Unknowns<dim> &unknowns);

    /// Scales the stiffness of contact to that of a solid whose velocity changes by @p v_factor [1/s] with its displacement.
    void set_stage(double v_factor);

    /// Starts a step from displacement @p u (relevant unknowns): keeps the state for restore().
    void start_step(const Vector &u);
    /// Back to the state at start_step().
    void restore();

    /// Moves a body that touches nothing and is driven by @p external forces until it touches, in the first guess @p u
    /// (owned unknowns). Returns false if it never would. Collective.
    bool approach(Vector &u, const Vector &external);

    /// Norm of the contact forces of the active nodes before the gap's parts cancel [N]: their round-off is a part of
    /// that. Collective. @param u relevant unknowns
    double summed_force(const Vector &u) const;

    /// Adds the contact forces at @p u (relevant unknowns) to @p r. Local; compress afterwards.
    void add_force(Vector &r, const Vector &u) const;
    /// Adds their negative derivative to K and the share of jumps to @p r.
    void add_stiffness(Matrix &K, Vector &r, const Vector &u,
                       const dealii::AffineConstraints<double> &constraints) const;
    /// Adds the places of add_stiffness() to the pattern.
    template <typename Pattern>
    void add_pattern(Pattern &pattern, const dealii::AffineConstraints<double> &constraints) const;

    /// After Newton: moves multipliers and active set to @p u. Whether the solution must be found anew. Collective.
    bool update(const Vector &u);

    /// Results, named after the body: its displacement in @p u, and of the forces at @p balanced their sum on the body, the
    /// largest pressure, the area and (in the plane) half the width along x. Collective.
    std::vector<std::pair<std::string, double>> scalars(const Vector &u, const Vector &balanced) const;

    void save(Output::ArchiveWriter &archive) const;
    void load(const Output::ArchiveReader &archive);

  private:
    using Vec   = dealii::Tensor<1, dim>;
    using State = Rigid::ContactState<dim>;

    struct Node
    {
      std::array<dealii::types::global_dof_index, dim> dofs;
      dealii::Point<dim>                               X;
      double                                           area = 0; ///< w [m^2], in the plane times the thickness
      State                                            state;
    };

    void find_nodes(const Settings<dim> &settings, const Mesh<dim> &mesh);
    Vec  translation(const Vector &u) const;
    /// In the body's frame.
    dealii::Point<dim> place(const Node &node, const Vector &u) const;
    std::uint64_t      name_of(const Node &node) const;

    const Scene<dim>            &scene;
    const Contact               &contact;
    const Unknowns<dim>         &unknowns;
    const Shapes::Shape<dim>    &shape;
    const dealii::Point<dim>     pivot; ///< of the body, where torques are taken [m]
    const double                 arm;   ///< length that makes its rotations displacements, see Inclusions [m]
    const double                 cell_size, penalty, tolerance;
    const Rigid::ContactLaw<dim> law;
    double                       half_width = 0.;                 ///< of the body [m]
    double                       eps = 0., spring_stiffness = 0.; ///< of the stage [Pa/m], [N/m]
    bool                         driven_by_force = false;         ///< some component is not prescribed
    std::vector<Node>            nodes, saved_nodes;              ///< of this rank
    Vector                       start;                           ///< relevant unknowns at the start of the step
    Vec                          spring_place;                    ///< translation at which the spring is free
    bool                         has_spring = false;
  };
} // namespace Stroma::Fem
