#pragma once

#include <stroma/rigid/rotation.h>

#include <deal.II/base/point.h>

namespace Stroma::Rigid
{
  /// Where a rigid body is: what was at X is at pivot + translation + R(rotation) (X - pivot).
  template <int dim>
  struct Pose
  {
    dealii::Point<dim>     pivot;       ///< about which it turns, at the start [m]
    dealii::Tensor<1, dim> translation; ///< of the pivot, since the start [m]
    Axial<dim>             rotation;    ///< since the start [rad]

    /// From where the pivot is now to where @p X is now [m].
    dealii::Tensor<1, dim>
    arm(const dealii::Point<dim> &X) const
    {
      return rotation_matrix<dim>(rotation) * (X - pivot);
    }

    /// Since the start, of what was at @p X [m].
    dealii::Tensor<1, dim>
    displacement(const dealii::Point<dim> &X) const
    {
      if (rotation == Axial<dim>())
        return translation;
      return translation + arm(X) - (X - pivot);
    }

    dealii::Point<dim>
    place(const dealii::Point<dim> &X) const
    {
      return X + displacement(X);
    }
  };

  /// How a rigid body moves at one time.
  template <int dim>
  struct Twist
  {
    dealii::Tensor<1, dim> velocity;         ///< of the pivot [m/s]
    Axial<dim>             angular_velocity; ///< [rad/s]

    /// At the end of an @p arm from where the pivot is [m/s].
    dealii::Tensor<1, dim>
    at(const dealii::Tensor<1, dim> &arm) const
    {
      return velocity + cross<dim>(angular_velocity, arm);
    }
  };
} // namespace Stroma::Rigid
