#pragma once

#include <stroma/scene/scene.h>

#include <vector>

namespace Stroma
{
  /// Times from the start to @p end_time [s] at which functions of time are compared: both ends, the middle, and between them
  /// times that are no common part of any period, so that no oscillation hides from them.
  std::vector<double> sample_times(double end_time);

  /// A place that a support moves along a component.
  template <int dim>
  struct HeldPlace
  {
    unsigned int       support; ///< index into the scene's supports, or their number: a rigid body at rest
    dealii::Point<dim> X;       ///< undeformed [m]; that of a periodic image where the support holds that image
  };

  /// Throws UserError if the motions that supports prescribe to @p first and @p second, which are one place (or one and its
  /// periodic image), differ along @p component at some time up to @p end_time [s].
  template <int dim>
  void check_agreement(const Scene<dim> &scene, const HeldPlace<dim> &first, const HeldPlace<dim> &second,
                       unsigned int component, double end_time);
} // namespace Stroma
