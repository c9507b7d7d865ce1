#pragma once

#include <stroma/base/types.h>
#include <stroma/fem/loads.h>
#include <stroma/grid/free_parts.h>

#include <deal.II/base/index_set.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_system.h>

#include <cstdint>
#include <vector>

namespace Stroma::Fem
{
  /// A prescribed component of an unknown.
  template <int dim>
  struct HeldUnknown
  {
    dealii::types::global_dof_index dof;
    unsigned int                    support; ///< index, or n_supports for a rigid body at rest
    unsigned int                    component;
    dealii::Point<dim>              X; ///< place of the node; centre of the rigid body
  };

  /**
   * The displacement unknowns of a solid: those of the mesh's nodes and, after them, the translations of the scene's rigid
   * bodies (dim each). Knows which are tied to others (hanging nodes, periodic sides, surfaces of rigid inclusions) and
   * which are held by supports.
   */
  template <int dim>
  class Unknowns
  {
  public:
    /// Numbers the unknowns of the present mesh. Throws UserError for supports that hold nothing or contradict each other.
    /// Collective.
    Unknowns(const Scene<dim> &scene, const Settings<dim> &settings, const Mesh<dim> &mesh, double end_time);

    /// Unknown of component @p c of rigid body @p b.
    dealii::types::global_dof_index
    of_body(const unsigned int b, const unsigned int c) const
    {
      return dofs.n_dofs() + rigid_index[b] * dim + c;
    }

    /// Number of all unknowns.
    dealii::types::global_dof_index
    size() const
    {
      return dofs.n_dofs() + n_rigid * dim;
    }

    /// Sets the tied entries of a vector of owned unknowns from those they are tied to. Collective.
    void
    distribute(Vector &u) const
    {
      ties.distribute(u);
    }

    /// Ties and held unknowns, the latter with inhomogeneity @p jump (by position in held). Closed.
    dealii::AffineConstraints<double> constraints(const std::vector<double> &jump) const;

    /// The part of @p u (owned unknowns) that belongs to the mesh, with ghosts: what deal.II's functions take.
    Vector on_mesh(const Vector &u) const;

    /// Names of the owned unknowns that do not depend on the number of ranks, for a checkpoint. Collective.
    std::vector<std::uint64_t> names() const;

    struct OwnedNode
    {
      dealii::types::global_dof_index dof;
      unsigned int                    component;
      dealii::Point<dim>              X;
    };
    /// The owned unknowns of the mesh with their places.
    std::vector<OwnedNode> owned_nodes() const;

    unsigned int
    n_rigid_bodies() const
    {
      return n_rigid;
    }
    /// Tells @p motions what is held or tied to rigid bodies; those are numbered after the pieces of the mesh.
    void hold(RigidMotions<dim> &motions, const ConnectedParts<dim> &parts) const;
    /// Tells @p add the piece and place of each owned force. Local.
    void visit_forces(const Vector &force, const ConnectedParts<dim> &parts,
                      const typename FreeParts<dim>::AddForce &add) const;

    /// The node nearest to @p place, of those that follow no others across a change of cell size; of nodes equally near the
    /// one with the smallest coordinates. Collective.
    dealii::Point<dim> nearest_node(const dealii::Point<dim> &place) const;

    /// Of each load, the owned unknowns on which it acts alone: of the nearest node or of a rigid body. Collective.
    std::vector<std::vector<SingleUnknown<dim>>> loaded_singly() const;

    /// Rigid-body motions, zero on held unknowns: the near null space of the stiffness.
    std::vector<Vector> rigid_motions() const;

    dealii::FESystem<dim>             fe;
    dealii::DoFHandler<dim>           dofs;
    dealii::IndexSet                  owned, relevant;
    dealii::AffineConstraints<double> ties;
    std::vector<HeldUnknown<dim>>     held; ///< relevant ones

  private:
    void add_rigid_bodies();
    void tie_inclusions();
    void find_held(double end_time);
    void hold(const HeldUnknown<dim> &unknown, double end_time, std::string &contradiction);
    /// @param at_surfaces unknowns of rigid bodies to whose surfaces supports reach, the same on all ranks
    void hold_bodies(const std::vector<HeldUnknown<dim>> &at_surfaces, double end_time);
    /// Whether the unknown follows several others.
    bool hangs(dealii::types::global_dof_index dof) const;
    /// Calls visit(X, dofs of the node's components, whether the node is on the mesh's boundary) for nodes of local cells.
    template <typename Visit>
    void for_each_node(const Visit &visit) const;

    const Scene<dim>         &scene;
    const Mesh<dim>          &mesh;
    std::vector<unsigned int> rigid_index; ///< of each body among the rigid ones
    unsigned int              n_rigid = 0;
    std::vector<int>          held_place; ///< place in held of each relevant unknown, -1 if free
  };
} // namespace Stroma::Fem
