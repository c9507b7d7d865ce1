#include <stroma/rigid/motion.h>

namespace Stroma::Rigid
{
  template <int dim>
  Motion<dim>::Motion(const Body<dim> &body)
    : body(&body)
    , committed(body.pose(0.))
  {}

  template <int dim>
  Pose<dim>
  Motion<dim>::next(const double t, const double t_next, const Twist<dim> &of_balance) const
  {
    const auto &drive = body->drive;
    const auto  given = body->pose(t_next);
    const auto  twist = body->twist(t_next, 1e-6 * (t_next - t));
    Pose<dim>   pose  = committed;
    for (unsigned int c = 0; c < dim; ++c)
      if (drive.translation[c] == DrivenBy::displacement)
        pose.translation[c] = given.translation[c];
      else if (drive.translation[c] == DrivenBy::velocity)
        pose.translation[c] += (t_next - t) * twist.velocity[c];
      else if (is_by_balance(drive.translation[c]))
        pose.translation[c] += (t_next - t) * of_balance.velocity[c];
    if (drive.rotation.front() == DrivenBy::displacement)
      pose.rotation = given.rotation;
    else if (drive.rotation.front() == DrivenBy::velocity)
      pose.rotation = compose<dim>(committed.rotation, (t_next - t) * twist.angular_velocity);
    else if (is_by_balance(drive.rotation.front()))
      pose.rotation = compose<dim>(committed.rotation, (t_next - t) * of_balance.angular_velocity);
    return pose;
  }

  /// Tells @p value the name and place of each number of the state.
  template <int dim>
  template <typename Value>
  void
  Motion<dim>::visit(const Value &value)
  {
    const std::string name = "rigid_" + body->name;
    for (unsigned int c = 0; c < dim; ++c)
      value(name + "_translation_" + "xyz"[c], committed.translation[c]);
    for (unsigned int c = 0; c < n_rotations<dim>; ++c)
      value(name + "_rotation_" + std::to_string(c), committed.rotation[c]);
  }

  template <int dim>
  void
  Motion<dim>::save(Output::ArchiveWriter &archive) const
  {
    Motion copy(*this);
    copy.visit([&](const std::string &name, const double number) { archive.attribute(name, number); });
  }

  template <int dim>
  void
  Motion<dim>::load(const Output::ArchiveReader &archive)
  {
    visit([&](const std::string &name, double &number) { number = archive.attribute_double(name); });
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  velocity_results(const Body<dim> &body, const Twist<dim> &twist)
  {
    std::vector<std::pair<std::string, double>> all;
    for (unsigned int c = 0; c < dim; ++c)
      if (is_by_balance(body.drive.translation[c]))
        all.emplace_back(body.name + "_velocity_" + "xyz"[c] + "_m_per_s", twist.velocity[c]);
    for (unsigned int k = 0; k < n_rotations<dim>; ++k)
      if (is_by_balance(body.drive.rotation[k]))
        all.emplace_back(body.name + "_angular_velocity_" + (dim == 2 ? "" : std::string(1, "xyz"[k]) + "_") +
                           "rad_per_s",
                         twist.angular_velocity[k]);
    return all;
  }

  template std::vector<std::pair<std::string, double>> velocity_results(const Body<2> &, const Twist<2> &);
  template std::vector<std::pair<std::string, double>> velocity_results(const Body<3> &, const Twist<3> &);
  template class Motion<2>;
  template class Motion<3>;
} // namespace Stroma::Rigid
