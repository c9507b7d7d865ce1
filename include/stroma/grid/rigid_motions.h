#pragma once

#include <stroma/scene/scene.h>

#include <Eigen/Core>

namespace Stroma
{
  /// Finds out whether the held components of a scene leave its bodies free to move as a whole.
  template <int dim>
  class RigidMotions
  {
  public:
    explicit RigidMotions(const Scene<dim> &scene);

    /// Component @p c of the material at @p X is held.
    void hold(const dealii::Point<dim> &X, unsigned int c);

    /// Throws UserError if a rigid-body motion is left free. Collective.
    void check() const;

  private:
    static constexpr unsigned int n_modes = dim == 2 ? 3 : 6;

    const Scene<dim>                       &scene;
    dealii::Point<dim>                      centre;
    double                                  length = 0; ///< [m]
    Eigen::Matrix<double, n_modes, n_modes> gram;       ///< of translations and rotations, as seen by what is held
  };
} // namespace Stroma
