#pragma once

#include <stroma/processes/degradation_law.h>
#include <stroma/processes/migration.h>
#include <stroma/rigid/pose.h>
#include <stroma/shapes/shape.h>

namespace Stroma::Processes
{
  /**
   * A rigid body that degrades the solid around it (section 3.4 of Heck 2017): the share f of its bonds that are left falls by a
   * law of the distance from the body's surface, up to the width l_degr and within the angle theta_degr from the direction in
   * which the body propels itself, on either side, as seen from its pivot. At the start everything within another width is
   * a fluid.
   */
  template <int dim>
  class Degradation
  {
  public:
    /// Declares and reads the entries of the current section. @param migrations of the scene. Throws UserError.
    void add(Parameters &p, const std::string &name, const std::vector<Migration<dim>> &migrations);

    /// f of what was at @p X in the body's frame at the start, undegraded until then.
    double at_start(const Shapes::Shape<dim> &shape, const dealii::Point<dim> &X) const;

    /// f of what is at @p x, with @p f before, after @p dt in which the body was at @p pose and time was @p t in the mean.
    double after(double f, const Shapes::Shape<dim> &shape, const Rigid::Pose<dim> &pose, const dealii::Point<dim> &x,
                 double t, double dt) const;

    std::string  name, where;
    unsigned int body = 0; ///< index into the scene's bodies

  private:
    bool is_in_front(const dealii::Tensor<1, dim> &arm, double t) const;

    Migration<dim>                        migration;                                                ///< of the body
    double                                width         = std::numeric_limits<double>::quiet_NaN(); ///< [m]
    double                                angle         = 90.; ///< [degrees], then [rad]
    double                                initial_width = std::numeric_limits<double>::quiet_NaN(); ///< [m]
    std::shared_ptr<const DegradationLaw> law;
  };
} // namespace Stroma::Processes
