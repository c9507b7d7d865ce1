#pragma once

#include <stroma/base/types.h>
#include <stroma/scene/scene.h>

#include <deal.II/base/index_set.h>
#include <deal.II/lac/affine_constraints.h>

#include <array>
#include <vector>

namespace Stroma::Fem
{
  /**
   * The unknowns of a scene's rigid bodies, and the nodes that lie on their surfaces and move with them:
   *   u(X) = U + (R(theta) - I) (X - pivot).
   * The unknowns of a body are U and l theta, l half the diagonal of its box, so that all are lengths and what is
   * conjugate to them are forces: as many as for two nodes (in the plane the last stands for nothing), which multigrid
   * expects. The nodes follow exactly; the ties are the derivatives of that at the present rotation,
   *   du(X) = dU + dtheta_k dR/dtheta_k (X - pivot).
   */
  template <int dim>
  class Inclusions
  {
  public:
    using Dof = dealii::types::global_dof_index;

    explicit Inclusions(const Scene<dim> &scene);

    /// Numbers the unknowns from @p first on.
    void number(Dof first);
    Dof
    size() const
    {
      return scene.rigid_bodies.size() * per_body;
    }

    /// Component @p c of rigid body @p r: along the axes first, then about them.
    Dof
    unknown(const unsigned int r, const unsigned int c) const
    {
      return first + r * per_body + c;
    }
    /// l of rigid body @p r [m].
    double
    length(const unsigned int r) const
    {
      return lengths[r];
    }

    /// Puts component @p c of a node at @p X, relevant on this rank, on the surface of rigid body @p r.
    void add(Dof dof, unsigned int c, unsigned int r, const dealii::Point<dim> &X);
    /// After the last of them, which may have come several times. Throws UserError if bodies share a node and not all of
    /// them are at rest. Collective.
    void close();
    /// The rigid body on whose surface an unknown of the mesh lies, or -1.
    int body_of(Dof dof) const;

    /// Whether a body that may turn is among them.
    bool turn() const;

    /// Poses of all bodies by the unknowns of @p u (owned or relevant). Collective.
    std::vector<Rigid::Pose<dim>> poses(const Vector &u) const;

    /// Sets the nodes of @p u (owned) to where the bodies take them. Compress afterwards.
    void place(Vector &u, const std::vector<Rigid::Pose<dim>> &poses) const;

    /// Adds the nodes' ties at @p poses; without any the places of all that there may be.
    void tie(dealii::AffineConstraints<double> &ties, const std::vector<Rigid::Pose<dim>> &poses) const;

    /// Moves the forces on the nodes of @p force (owned) to the bodies at @p poses: their sum, and what is conjugate to
    /// rotations. Collective.
    /// @return of each body, the sum of f (X - pivot)^T over its nodes [N m]
    std::vector<dealii::Tensor<2, dim>> condense(Vector &force, const std::vector<Rigid::Pose<dim>> &poses) const;

    /// What is conjugate to l theta_k at rotation @p theta of rigid body @p r, of forces on its nodes with the sum
    /// M = f (X - pivot)^T, @p virial, and of a @p torque T on it: (M : dR/dtheta_k + (J^T T)_k)/l [N], with w = J dtheta/dt.
    Rigid::Axial<dim> conjugate(unsigned int r, const Rigid::Axial<dim> &theta, const dealii::Tensor<2, dim> &virial,
                                const Rigid::Axial<dim> &torque) const;

    /// The torque about where the pivot is [N m] to which @p forces [N] are conjugate.
    Rigid::Axial<dim> torque(unsigned int r, const Rigid::Axial<dim> &theta, const Rigid::Axial<dim> &forces) const;

    static constexpr unsigned int per_body = 2 * dim;

  private:
    struct Node
    {
      Dof                dof;
      unsigned int       component, body;
      dealii::Point<dim> X;
    };
    /// Columns of J.
    std::array<Rigid::Axial<dim>, Rigid::n_rotations<dim>> axes(const Rigid::Axial<dim> &theta) const;

    const Scene<dim>   &scene;
    Dof                 first = 0;
    std::vector<double> lengths;
    std::vector<Node>   nodes; ///< by dof
  };
} // namespace Stroma::Fem
