#pragma once

#include <stroma/rigid/unknowns.h>

#include <deal.II/lac/affine_constraints.h>

#include <vector>

namespace Stroma::Fem
{
  /**
   * The unknowns of a scene's rigid bodies, and the nodes that lie on their surfaces and move with them:
   *   u(X) = U + (R(theta) - I) (X - pivot).
   * The nodes follow exactly; the ties are the derivatives of that at the present rotation,
   *   du(X) = dU + dtheta_k dR/dtheta_k (X - pivot).
   */
  template <int dim>
  class Inclusions : public Rigid::Unknowns<dim>
  {
  public:
    using Dof = dealii::types::global_dof_index;

    using Rigid::Unknowns<dim>::Unknowns;

    /// Puts component @p c of a node at @p X, relevant on this rank, on the surface of rigid body @p r.
    void add(Dof dof, unsigned int c, unsigned int r, const dealii::Point<dim> &X);
    /// After the last of them, which may have come several times. Throws UserError if bodies share a node and not all of
    /// them are at rest. Collective.
    void close();
    /// The rigid body on whose surface an unknown of the mesh lies, or -1.
    int body_of(Dof dof) const;

    /// Sets the nodes of @p u (owned) to where the bodies take them. Compress afterwards.
    void place(Vector &u, const std::vector<Rigid::Pose<dim>> &poses) const;

    /// Adds the nodes' ties at @p poses; without any the places of all that there may be.
    void tie(dealii::AffineConstraints<double> &ties, const std::vector<Rigid::Pose<dim>> &poses) const;

    /// Moves the forces on the nodes of @p force (owned) to the bodies at @p poses: their sum, and what is conjugate to
    /// rotations. Collective.
    /// @return of each body, the sum of f (X - pivot)^T over its nodes [N m]
    std::vector<dealii::Tensor<2, dim>> condense(Vector &force, const std::vector<Rigid::Pose<dim>> &poses) const;

  private:
    using Rigid::Unknowns<dim>::scene;
    using Rigid::Unknowns<dim>::lengths;

    struct Node
    {
      Dof                dof;
      unsigned int       component, body;
      dealii::Point<dim> X;
    };

    std::vector<Node> nodes; ///< by dof
  };
} // namespace Stroma::Fem
