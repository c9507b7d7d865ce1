#pragma once

#include <stroma/output/archive.h>
#include <stroma/rigid/body.h>

namespace Stroma::Rigid
{
  /**
   * Where a rigid body is, from step to step. Components given by a displacement or rotation are functions of time;
   * those given by a velocity are integrated with the velocity at the end of each step; those left to the balance of
   * forces are what the method commits.
   */
  template <int dim>
  class Motion
  {
  public:
    explicit Motion(const Body<dim> &body);

    /// At the end of the last step.
    const Pose<dim> &
    pose() const
    {
      return committed;
    }

    /// At the end of a step from @p t to @p t_next [s]; components left to the balance of forces go on with @p twist.
    Pose<dim> next(double t, double t_next, const Twist<dim> &twist = {}) const;

    /// Takes the pose at the end of a step.
    void
    commit(const Pose<dim> &pose)
    {
      committed = pose;
    }

    void save(Output::ArchiveWriter &archive) const;
    void load(const Output::ArchiveReader &archive);

  private:
    template <typename Value>
    void visit(const Value &value);

    const Body<dim> *body;
    Pose<dim>        committed;
  };

  /// Names and values of results, the same for all methods: the velocity [m/s] and angular velocity [rad/s] @p twist of the
  /// body, in components that the balance of forces determines.
  template <int dim>
  std::vector<std::pair<std::string, double>> velocity_results(const Body<dim> &body, const Twist<dim> &twist);
} // namespace Stroma::Rigid
