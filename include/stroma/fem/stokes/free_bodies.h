#pragma once

#include <stroma/fem/stokes/space.h>

#include <deal.II/lac/full_matrix.h>

namespace Stroma::Fem
{
  /**
   * The rigid bodies in a flow that the balance of forces moves. The equations are linear, so the flow is that of these bodies
   * at rest, plus q_k times the flows of unit velocities; and q are the velocities at which the forces of the flow and of loads
   * on the bodies add up to nothing.
   */
  template <int dim>
  class FreeBodies
  {
  public:
    explicit FreeBodies(const StokesSpace<dim> &space);

    unsigned int
    size() const
    {
      return static_cast<unsigned int>(unknowns.size());
    }

    /// Sets @p v where the body of unknown @p k holds it to what that unknown = 1 makes of it, and distributes. Collective.
    void impose(Vector &v, unsigned int k) const;

    /// Forces of the flow on the unknowns, @p unbalanced minus the reactions on held unknowns [N], [N m]. Collective.
    std::vector<double> forces(const Vector &unbalanced) const;

    /// Forces of loads on them at time @p t [s].
    std::vector<double> loads(double t) const;

    /// Velocities of the scene's rigid bodies, 0 in components that are given.
    std::vector<Rigid::Twist<dim>> twists(const std::vector<double> &q) const;

  private:
    struct Unknown
    {
      unsigned int rigid, motion; ///< component of velocity, then of angular velocity
    };
    /// Velocity that unknown @p k = 1 means for @p X.
    dealii::Tensor<1, dim> velocity(unsigned int k, const dealii::Point<dim> &X) const;

    const StokesSpace<dim> &space;
    std::vector<Unknown>    unknowns;
  };
} // namespace Stroma::Fem
