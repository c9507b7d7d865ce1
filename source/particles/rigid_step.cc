#include <stroma/particles/rigid_step.h>
#include <stroma/rigid/motion.h>

namespace Stroma::Particles
{
  template <int dim>
  RigidStep<dim>::RigidStep(const Rigid::Body<dim> &body, const Rigid::Pose<dim> &before,
                            const Rigid::Twist<dim> &twist, const double t, const double t_next)
    : from(body.pose(t))
  {
    const auto &drive = body.drive;
    for (unsigned int c = 0; c < dim; ++c)
      if (!drive.displacement.given() || is_by_balance(drive.translation[c]))
        from.translation[c] = before.translation[c];
    if (!drive.angle.given())
      from.rotation = before.rotation;
    to = from;
    if (!(t_next > t))
      return;
    Rigid::Motion<dim> motion(body);
    motion.commit(from);
    to                = motion.next(t, t_next, twist);
    velocity_of_pivot = (to.translation - from.translation) / (t_next - t);
    for (unsigned int c = 0; c < dim; ++c)
      if (drive.velocity.given() && !is_by_balance(drive.translation[c]))
        velocity_of_pivot[c] = drive.velocity.value(body.pivot, t_next, c);
    if (drive.turns())
      rotation_rate = (Rigid::rotation_matrix<dim>(to.rotation) - Rigid::rotation_matrix<dim>(from.rotation)) /
                      (t_next - t);
  }

  template class RigidStep<2>;
  template class RigidStep<3>;
} // namespace Stroma::Particles
