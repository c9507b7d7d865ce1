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
    /// are not given by a displacement or rotation @param twist velocity of those that the balance of forces determines
    RigidStep(const Rigid::Body<dim> &body, const Rigid::Pose<dim> &before, const Rigid::Twist<dim> &twist, double t,
              double t_next);

    /// Changes the velocities, not the poses, by what @p change is at the pose @p at.
    void
    change_velocity(const Rigid::Twist<dim> &change, const Rigid::Pose<dim> &at)
    {
      velocity_of_pivot += change.velocity;
      rotation_rate += Rigid::cross_matrix<dim>(change.angular_velocity) * Rigid::rotation_matrix<dim>(at.rotation);
    }

    /// Takes the velocities, not the poses, of @p other.
    void
    set_velocity(const RigidStep &other)
    {
      velocity_of_pivot = other.velocity_of_pivot;
      rotation_rate     = other.rotation_rate;
    }

    /// Calls visit(number) for each number of the velocities.
    template <typename Visit>
    void
    visit_velocity(const Visit &visit)
    {
      for (unsigned int c = 0; c < dim; ++c)
        {
          visit(velocity_of_pivot[c]);
          for (unsigned int d = 0; d < dim; ++d)
            visit(rotation_rate[c][d]);
        }
    }

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
