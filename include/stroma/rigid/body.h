#pragma once

#include <stroma/rigid/drive.h>
#include <stroma/rigid/pose.h>
#include <stroma/rigid/resistance.h>
#include <stroma/shapes/shape.h>

#include <string>
#include <utility>

namespace Stroma::Rigid
{
  /// A rigid body of the scene: what it is called, about what it turns, what drives it.
  template <int dim>
  struct Body
  {
    std::string          name, where;
    unsigned int         body = 0; ///< index into the scene's bodies
    dealii::Point<dim>   pivot;    ///< [m]
    Drive<dim>           drive;
    Resistance           resistance;
    Shapes::Moments<dim> moments; ///< of its shape, at the start

    /// Its pose at time @p t [s], as far as displacements and rotations give it; other components are 0. Those driven by
    /// a velocity have to be integrated, see Motion.
    Pose<dim> pose(double t) const;

    /// Its velocity at time @p t [s], of components that a function of time gives, others are 0; of displacements and
    /// rotations by differences over the short time @p h [s], of second order.
    Twist<dim> twist(double t, double h) const;

    /// Displacement since the start at time @p t of what was at @p X [m].
    dealii::Tensor<1, dim>
    displacement(const dealii::Point<dim> &X, const double t) const
    {
      return pose(t).displacement(X);
    }

    /// Its velocity [m/s]; @p h as in twist().
    dealii::Tensor<1, dim>
    velocity(const dealii::Point<dim> &X, const double t, const double h) const
    {
      return twist(t, h).at(pose(t).arm(X));
    }

    /// Names and values of results, the same for all methods: displacement and rotation where it may move, force [N] and
    /// torque about where the pivot is [N m] by which it acts on the material.
    std::vector<std::pair<std::string, double>> results(const Pose<dim> &pose, const dealii::Tensor<1, dim> &force,
                                                        const Axial<dim> &torque) const;
  };
} // namespace Stroma::Rigid
