#include <stroma/rigid/body.h>

namespace Stroma::Rigid
{
  namespace
  {
    /// Rate of @p value at @p t by differences over @p h, of second order; none looks back before the start.
    template <typename Function>
    auto
    rate(const Function &value, const double t, const double h)
    {
      return t < h ? (4. * value(t + h) - 3. * value(t) - value(t + 2. * h)) / (2. * h) :
                     (value(t + h) - value(t - h)) / (2. * h);
    }

    /// "rotation_rad" in the plane, "rotation_x_rad", ... in space.
    template <int dim>
    std::string
    axial_name(const std::string &quantity, const unsigned int axis, const std::string &unit)
    {
      return quantity + (dim == 2 ? "" : std::string("_") + "xyz"[axis]) + "_" + unit;
    }
  } // namespace

  template <int dim>
  Pose<dim>
  Body<dim>::pose(const double t) const
  {
    Pose<dim> pose;
    pose.pivot = pivot;
    if (drive.displacement.given())
      pose.translation = drive.displacement.value(pivot, t);
    if (drive.angle.given())
      pose.rotation = drive.angle.value(pivot, t);
    return pose;
  }

  template <int dim>
  Twist<dim>
  Body<dim>::twist(const double t, const double h) const
  {
    Twist<dim> twist;
    if (drive.velocity.given())
      twist.velocity = drive.velocity.value(pivot, t);
    else if (drive.any(DrivenBy::displacement))
      twist.velocity = rate([&](const double at) { return pose(at).translation; }, t, h);
    if (drive.spin.given())
      twist.angular_velocity = drive.spin.value(pivot, t);
    else if (drive.angle.given() && drive.any(DrivenBy::displacement))
      twist.angular_velocity = angular_velocity<dim>(pose(t).rotation,
                                                     rate([&](const double at) { return pose(at).rotation; }, t, h));
    return twist;
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  Body<dim>::results(const Pose<dim> &pose, const dealii::Tensor<1, dim> &force, const Axial<dim> &torque) const
  {
    std::vector<std::pair<std::string, double>> all;
    const auto                                  axis = [](const unsigned int c) { return std::string(1, "xyz"[c]); };
    for (unsigned int c = 0; c < dim && drive.moves(); ++c)
      all.emplace_back(name + "_displacement_" + axis(c) + "_m", pose.translation[c]);
    for (unsigned int c = 0; c < n_rotations<dim> && drive.turns(); ++c)
      all.emplace_back(axial_name<dim>(name + "_rotation", c, "rad"), pose.rotation[c]);
    for (unsigned int c = 0; c < dim; ++c)
      all.emplace_back(name + "_force_" + axis(c) + "_N", force[c]);
    for (unsigned int c = 0; c < n_rotations<dim>; ++c)
      all.emplace_back(axial_name<dim>(name + "_torque", c, "Nm"), torque[c]);
    return all;
  }

  template struct Body<2>;
  template struct Body<3>;
} // namespace Stroma::Rigid
