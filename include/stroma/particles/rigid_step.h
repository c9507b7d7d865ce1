#pragma once

#include <stroma/rigid/body.h>

namespace Stroma::Particles
{
  /// How a rigid body goes through a step: each of its places along the chord from where it was to where it will be.
  template <int dim>
  class RigidStep
  {
  public:
    /// From @p t to @p t_next [s]; one without length is at rest. @param before pose at the start, of which components count that
    /// are given by a velocity.
    RigidStep(const Rigid::Body<dim> &body, const Rigid::Pose<dim> &before, double t, double t_next);

    /// Of what was at @p X when the run began [m/s].
    dealii::Tensor<1, dim>
    velocity(const dealii::Point<dim> &X) const
    {
      return velocity_of_pivot + rotation_rate * (X - from.pivot);
    }

    Rigid::Pose<dim> from, to;

  private:
    dealii::Tensor<1, dim> velocity_of_pivot;
    dealii::Tensor<2, dim> rotation_rate; ///< of the rotation matrix [1/s]
  };
} // namespace Stroma::Particles
