#pragma once

#include <stroma/sph/system.h>

namespace Stroma::Sph
{
  /**
   * What changes the energy of inertial particles and bodies: kinetic energy + strain energy + heat - work stays what it was at the
   * start, but for what steps of finite length and the rate form of the law lose. Forces do their work with the mean of the
   * velocities before and after a part of a step, as the kinetic energy changes by it.
   *
   * Not counted is what accelerates components of a body that are given while the balance of forces moves others.
   */
  template <int dim>
  class EnergyFlow
  {
  public:
    using Velocities = typename System<dim>::Velocities;

    explicit EnergyFlow(const System<dim> &system);

    /// At the start of a step.
    void
    start_step()
    {
      in_step = {};
    }
    /// Of a part of a step, after System::state_forces(): its @p force, and velocities @p v of all points with which it begins.
    void take_state(const Velocities &force, const Velocities &v);
    /// Of the part, of bodies that forces move: loads, friction and drag on them, and velocities, as unknowns of BodyBalance.
    void take_bodies(const std::vector<double> &loads, const std::vector<double> &resisting,
                     const std::vector<double> &before, const std::vector<double> &after, double dt);
    /// The part that ends with velocities @p v, after System::add_friction() and System::impose(): its whole @p force, of which
    /// friction is the rest. @param dt its length [s]
    void take_part(const Velocities &force, const Velocities &v, double dt);
    /// Adds the step to what has been. Collective.
    void end_step();

    /// Since the start [J over the thickness].
    struct Sums
    {
      double work = 0.; ///< of loads, and of what moves as given
      double heat = 0.; ///< of friction in the material and in contacts, and of drag
    };
    Sums total;

  private:
    bool                   moves_as_given(unsigned int m) const;
    void                   add_walls(double dt, const Velocities &v);
    void                   add_forces_of_contacts(const Velocities &v, double dt);
    dealii::Tensor<1, dim> given_velocity(std::size_t p, const Velocities &v) const;

    const System<dim>                  &system;
    std::vector<std::uint8_t>           is_given; ///< of each mover: whether it moves as given
    bool                                any_given;
    std::vector<Rigid::Twist<dim>>      given; ///< of bodies, components that are
    Velocities                          of_state, before;
    std::vector<dealii::Tensor<1, dim>> of_walls; ///< state forces of pairs with walls that move as given
    Sums                                in_step;  ///< of this rank
  };
} // namespace Stroma::Sph
