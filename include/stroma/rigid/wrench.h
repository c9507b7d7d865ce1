#pragma once

#include <stroma/rigid/rotation.h>

namespace Stroma::Rigid
{
  /// What acts on a rigid body, or by which it acts.
  template <int dim>
  struct Wrench
  {
    dealii::Tensor<1, dim> force;  ///< [N]
    Axial<dim>             torque; ///< about where the pivot is [N m]

    /// Adds a force @p f at the end of an @p arm from where the pivot is.
    void
    add(const dealii::Tensor<1, dim> &arm, const dealii::Tensor<1, dim> &f)
    {
      force += f;
      torque += moment<dim>(arm, f);
    }

    bool
    operator==(const Wrench &other) const
    {
      return force == other.force && torque == other.torque;
    }
  };
} // namespace Stroma::Rigid
