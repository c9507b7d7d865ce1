#pragma once

#include <stroma/base/types.h>
#include <stroma/fem/inclusions.h>
#include <stroma/fem/loads.h>
#include <stroma/grid/free_parts.h>

#include <deal.II/base/index_set.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_system.h>

#include <cstdint>
#include <set>
#include <vector>

namespace Stroma::Fem
{
  /// A prescribed component of an unknown.
  template <int dim>
  struct HeldUnknown
  {
    dealii::types::global_dof_index dof;
    unsigned int                    support;    ///< index, or n_supports for a rigid body at rest
    unsigned int                    component;  ///< of a rigid body also dim and more: of its rotation
    dealii::Point<dim>              X;          ///< place of the node; pivot of the rigid body
    int                             rigid = -1; ///< index of the rigid body, -1: a node
  };

  /**
   * The displacement unknowns of a solid: those of the mesh's nodes and, after them, those of the scene's rigid bodies
   * (Inclusions). Knows which are tied to others (hanging nodes, periodic sides, surfaces of rigid bodies) and which are
   * held by supports.
   */
  template <int dim>
  class Unknowns
  {
  public:
    /// Numbers the unknowns of the present mesh. Throws UserError for supports that hold nothing or contradict each other.
    /// Collective.
    Unknowns(const Scene<dim> &scene, const Settings<dim> &settings, const Mesh<dim> &mesh, double end_time);

    /// Unknown of component @p c of the rigid body that is the scene's body @p b.
    dealii::types::global_dof_index of_body(unsigned int b, unsigned int c) const;

    /// Number of all unknowns.
    dealii::types::global_dof_index
    size() const
    {
      return dofs.n_dofs() + inclusions.size();
    }

    /// Sets the tied entries of a displacement (owned unknowns) from those they are tied to; ties are then those at this
    /// displacement. Collective.
    void distribute(Vector &u);

    /// The same of a velocity or an acceleration at the displacement of the last distribute(). Collective.
    void
    distribute_rate(Vector &v) const
    {
      ties.distribute(v);
    }

    /// What is prescribed to a held unknown at time @p t [s], and its rate of change just before, from values over 2 @p h
    /// (just after, if @p h is negative), of second order [m], [m/s].
    double prescribed(const HeldUnknown<dim> &unknown, double t) const;
    double prescribed_rate(const HeldUnknown<dim> &unknown, double t, double h) const;

    /// Ties and held unknowns, the latter with inhomogeneity @p jump (by position in held). Closed.
    dealii::AffineConstraints<double> constraints(const std::vector<double> &jump) const;

    /// Ties and held unknowns with all entries that the former may ever have. Closed.
    dealii::AffineConstraints<double> pattern_constraints() const;

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
    Inclusions<dim>                   inclusions;
    dealii::AffineConstraints<double> mesh_ties; ///< hanging nodes and periodic sides
    dealii::AffineConstraints<double> ties;      ///< all, at the displacement of the last distribute()
    std::vector<HeldUnknown<dim>>     held;      ///< relevant ones

  private:
    void number_rigid_bodies();
    void find_inclusions();
    /// First unknowns of the relevant nodes on the steps where body @p b took cells out of a mesh that need not fit it.
    std::set<dealii::types::global_dof_index> nodes_on_steps(unsigned int b) const;
    void tie(const std::vector<Rigid::Pose<dim>> &poses, dealii::AffineConstraints<double> &all) const;
    void find_held(double end_time);
    void hold(const HeldUnknown<dim> &unknown, double end_time, std::string &contradiction);
    /// @param at_surfaces unknowns of rigid bodies to whose surfaces supports reach, the same on all ranks
    void hold_bodies(const std::vector<HeldUnknown<dim>> &at_surfaces, double end_time);
    /// Whether the unknown follows several others.
    bool hangs(dealii::types::global_dof_index dof) const;
    /// Calls visit(X, dofs of the node's components, whether the node is on the mesh's boundary) for nodes of local cells.
    template <typename Visit>
    void for_each_node(const Visit &visit) const;

    const Scene<dim> &scene;
    const Mesh<dim>  &mesh;
    std::vector<int>  held_place; ///< place in held of each relevant unknown, -1 if free
  };

  template <int dim>
  template <typename Visit>
  void
  Unknowns<dim>::for_each_node(const Visit &visit) const
  {
    const unsigned int                               n_nodes = fe.n_dofs_per_cell() / dim;
    const auto                                      &nodes   = fe.base_element(0).get_unit_support_points();
    std::vector<dealii::types::global_dof_index>     cell_dofs(fe.n_dofs_per_cell());
    std::vector<bool>                                outer(n_nodes);
    std::array<dealii::types::global_dof_index, dim> node_dofs;
    for (const auto &cell : dofs.active_cell_iterators())
      {
        if (cell->is_artificial())
          continue;
        cell->get_dof_indices(cell_dofs);
        std::fill(outer.begin(), outer.end(), false);
        for (const unsigned int f : cell->face_indices())
          if (cell->face(f)->at_boundary() && !cell->has_periodic_neighbor(f))
            for (unsigned int i = 0; i < n_nodes; ++i)
              if (fe.base_element(0).has_support_on_face(i, f))
                outer[i] = true;
        for (unsigned int i = 0; i < n_nodes; ++i)
          {
            for (unsigned int c = 0; c < dim; ++c)
              node_dofs[c] = cell_dofs[fe.component_to_system_index(c, i)];
            visit(mesh.mapping().transform_unit_to_real_cell(cell, nodes[i]), node_dofs, outer[i]);
          }
      }
  }
} // namespace Stroma::Fem
