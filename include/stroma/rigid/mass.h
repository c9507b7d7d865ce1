#pragma once

#include <stroma/rigid/body.h>
#include <stroma/rigid/wrench.h>

#include <deal.II/lac/full_matrix.h>

namespace Stroma::Rigid
{
  /// Unknowns of a rigid body's motion: components of its velocity, then those of its angular velocity.
  template <int dim>
  constexpr unsigned int n_motions = dim + n_rotations<dim>;

  /// M of a mass @p mass [kg] spread evenly over the body's shape, at the pose @p pose: momentum and angular momentum about
  /// where the pivot is are [P; L] = M [U; omega], U the velocity of the pivot. Of a drag, M/m c is what it resists with.
  template <int dim>
  dealii::FullMatrix<double> mass_matrix(const Body<dim> &body, double mass, const Pose<dim> &pose);

  /// Radius of gyration about the pivot [m].
  template <int dim>
  double gyration(const Body<dim> &body);

  /**
   * How a rigid body with a mass moves in time: dP/dt = F, dL/dt = T - U x P (Newton, Euler), where components are left to the
   * balance of forces, and as given where they are not. P and L are the state, so that without forces they stay what they are,
   * and the velocities that belong to them come from the pose: the symplectic Euler scheme.
   */
  template <int dim>
  class Momentum
  {
  public:
    /// Starts with the velocities @p twist.
    Momentum(const Body<dim> &body, double mass, const Twist<dim> &twist, const Pose<dim> &pose);

    /// Velocities after @p dt under @p acting [N], [N m]. @param given those of components that are given, others are not used
    /// @param pose at the start of the step
    Twist<dim> advance(const Wrench<dim> &acting, const Twist<dim> &given, const Pose<dim> &pose, double dt);

    double kinetic_energy(const Twist<dim> &twist, const Pose<dim> &pose) const;

    dealii::Tensor<1, dim> linear;  ///< P [N s]
    Axial<dim>             angular; ///< L [N m s]

  private:
    const Body<dim> *body;
    double           mass; ///< [kg]
  };
} // namespace Stroma::Rigid
