#include <stroma/particles/rigid_step.h>
#include <stroma/rigid/motion.h>

namespace Stroma::Particles
{
  template <int dim>
  RigidStep<dim>::RigidStep(const Rigid::Body<dim> &body, const Rigid::Pose<dim> &before, const double t,
                            const double t_next)
    : from(body.pose(t))
  {
    const auto &drive = body.drive;
    if (!drive.displacement.given())
      from.translation = before.translation;
    if (!drive.angle.given())
      from.rotation = before.rotation;
    to = from;
    if (!(t_next > t))
      return;
    Rigid::Motion<dim> motion(body);
    motion.commit(from);
    to                = motion.next(t, t_next);
    velocity_of_pivot = drive.velocity.given() ? drive.velocity.value(body.pivot, t_next) :
                                                 (to.translation - from.translation) / (t_next - t);
    if (drive.turns())
      rotation_rate = (Rigid::rotation_matrix<dim>(to.rotation) - Rigid::rotation_matrix<dim>(from.rotation)) /
                      (t_next - t);
  }

  template class RigidStep<2>;
  template class RigidStep<3>;
} // namespace Stroma::Particles
