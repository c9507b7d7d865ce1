#pragma once

#include <stroma/base/expression.h>
#include <stroma/rigid/rotation.h>

#include <array>
#include <functional>
#include <vector>

namespace Stroma::Rigid
{
  /// What determines one component of a rigid body's translation or rotation.
  enum class DrivenBy
  {
    rest,         ///< it is held where it is
    displacement, ///< a displacement or rotation, given as a function of time
    velocity,     ///< a velocity or angular velocity, given as a function of time
    force,        ///< the balance of forces, with a force or torque
    free          ///< the balance of forces, without one
  };

  inline bool
  is_by_balance(const DrivenBy kind)
  {
    return kind == DrivenBy::force || kind == DrivenBy::free;
  }

  /// What drives a rigid body: the support and the loads on it. Nothing here depends on place.
  template <int dim>
  struct Drive
  {
    std::array<DrivenBy, dim>              translation{}; ///< along each axis
    std::array<DrivenBy, n_rotations<dim>> rotation{};    ///< about each axis; in space all are driven alike

    int                                                 support = -1; ///< index into the scene's supports, -1: none
    SpaceTimeVector<dim>                                displacement, velocity; ///< [m], [m/s]; one of them, or none
    SpaceTimeVector<dim, n_rotations<dim>>              angle, spin; ///< [rad], [rad/s]; one of them, or none
    std::vector<SpaceTimeVector<dim>>                   forces;      ///< at the pivot [N]
    std::vector<SpaceTimeVector<dim, n_rotations<dim>>> torques;     ///< [N m]
    /// By which it propels itself, at time t [s] [N].
    std::vector<std::function<dealii::Tensor<1, dim>(double t)>> own_forces;

    bool
    has_force() const
    {
      return !forces.empty() || !own_forces.empty();
    }

    /// Whether some component is of this kind.
    bool any(DrivenBy kind) const;
    /// Whether the balance of forces determines some component.
    bool
    is_by_balance() const
    {
      return any(DrivenBy::force) || any(DrivenBy::free);
    }
    /// Whether it may turn.
    bool turns() const;
    /// Whether it may move or turn.
    bool moves() const;

    /// Sums of the loads at time @p t [s].
    dealii::Tensor<1, dim> force(double t) const;
    Axial<dim>             torque(double t) const;
  };
} // namespace Stroma::Rigid
