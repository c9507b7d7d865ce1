#pragma once

#include <stroma/scene/scene.h>

namespace Stroma::Particles
{
  /**
   * What moves the fixed particles: a held side or a rigid body.
   *
   * A side moves as its support says, at undeformed places of the wall: a fixed particle beyond it keeps its place beside
   * its foot on the side, which turns and shears as the support's expression does there. A support gives either a displacement, from which the velocity follows by a difference in time, or a
   * velocity, which has to be integrated step by step. For a rigid body, see RigidStep.
   */
  template <int dim>
  struct Mover
  {
    std::string  name;
    int          support = -1; ///< index of the support that prescribes the motion, -1: at rest
    unsigned int axis    = 0;  ///< of a side

    const Rigid::Body<dim> *rigid = nullptr; ///< of the scene; none: a held side

    bool   upper              = false;
    double coordinate         = 0.;    ///< of a side, at the start [m]
    bool   moves              = false; ///< whether it ever does
    bool   gives_displacement = true;  ///< whether displacement() of a side may be asked for
    bool   varies_in_space    = false; ///< whether the motion depends on the place on the wall, or it turns
    double time_difference    = 1e-6;  ///< by which a displacement is differentiated [s]
    double place_difference   = 1e-3;  ///< the same in space; half a spacing of particles [m]

    /// The surface at the start as seen from @p X: distance and normal are positive on the material's side, and into it.
    Shapes::Nearest<dim> nearest(const Scene<dim> &scene, const dealii::Point<dim> &X) const;

    /// Distance from the surface at the start, positive on the material's side [m].
    double
    distance(const Scene<dim> &scene, const dealii::Point<dim> &X) const
    {
      return nearest(scene, X).distance;
    }

    /// The place on the side below or above @p X; of a rigid body, which moves as one, @p X itself.
    dealii::Point<dim> foot(dealii::Point<dim> X) const;

    // Of a side:

    /// Displacement since the start at time @p t of the particle that was at @p X [m].
    dealii::Tensor<1, dim> displacement(const Scene<dim> &scene, const dealii::Point<dim> &X, double t) const;

    /// Gradient of the side's motion at the foot of @p X: as the support's expression goes on across the side, so that an affine
    /// motion is continued as it is, but across the side by no less than half and no more than twice. Differences over half a spacing,
    /// inside the specimen's box.
    dealii::Tensor<2, dim> gradient_of_motion(const Scene<dim> &scene, const dealii::Point<dim> &X, double t) const;

    /// Displacement since the start of a fixed particle that was at @p X, beyond the side [m].
    dealii::Tensor<1, dim> displacement_beyond(const Scene<dim> &scene, const dealii::Point<dim> &X, double t) const;

    /// The constant velocity that takes it from time @p t to @p t_next [m/s].
    dealii::Tensor<1, dim> velocity_beyond(const Scene<dim> &scene, const dealii::Point<dim> &X, double t,
                                           double t_next) const;

    /// Whether the side may turn, tilt or stretch, as far as it is known where it is.
    bool
    deforms() const
    {
      return !rigid && varies_in_space && gives_displacement;
    }

    /// Velocity of the place that was at @p X [m/s].
    dealii::Tensor<1, dim> velocity(const Scene<dim> &scene, const dealii::Point<dim> &X, double t) const;

    /// The constant velocity that takes it from time @p t to @p t_next; of a support that gives a velocity, that at the end [m/s].
    dealii::Tensor<1, dim> velocity(const Scene<dim> &scene, const dealii::Point<dim> &X, double t,
                                    double t_next) const;
  };

  /**
   * The scene's movers: one a side that a support holds in all components, in the order of the supports, then one a
   * rigid body. Supports on sets of material (`layer`, `box`, `ball`, `material`, `nearest`, `all`) are no movers.
   * @param end_time of the run [s], by which the differences in time are scaled
   * @param spacing of the particles [m], by which those in space are
   * Throws UserError for what particles cannot do: a side held in some components only or twice, a held side where the
   * scene repeats, a support on a rim, a displacement or rotation that does not start from 0. What drives rigid bodies is
   * for Scene::require.
   */
  template <int dim>
  std::vector<Mover<dim>> movers_of(const Scene<dim> &scene, double end_time = 1., double spacing = 2e-3);
} // namespace Stroma::Particles
