// The scene's rigid bodies and what drives them, made of the supports and loads on 'body NAME'.

#include <stroma/scene/scene.h>

#include <algorithm>

namespace Stroma
{
  namespace
  {
    using Rigid::DrivenBy;

    /// What a component that a support prescribes is driven by.
    template <int dim, int n>
    DrivenBy
    prescribed(const SpaceTimeVector<dim, n> &motion, const unsigned int component, const DrivenBy kind)
    {
      const bool at_rest = !motion.depends_on_time() && motion.value(dealii::Point<dim>(), 0., component) == 0.;
      return at_rest ? DrivenBy::rest : kind;
    }

    template <int dim>
    void
    take_translation(Rigid::Drive<dim> &drive, const Support<dim> &support)
    {
      drive.displacement = support.displacement;
      drive.velocity     = support.velocity;
      for (unsigned int c = 0; c < dim; ++c)
        drive.translation[c] = !support.holds(c)        ? DrivenBy::free :
                               support.velocity.given() ? prescribed(support.velocity, c, DrivenBy::velocity) :
                                                          prescribed(support.displacement, c, DrivenBy::displacement);
    }

    /// Without an entry for it the body does not turn.
    template <int dim>
    void
    take_rotation(Rigid::Drive<dim> &drive, const Support<dim> &support)
    {
      const bool  of_velocity = support.angular_velocity.given();
      const auto &motion      = of_velocity ? support.angular_velocity : support.rotation;
      if (!motion.given())
        return;
      constexpr unsigned int n      = Rigid::n_rotations<dim>;
      unsigned int           n_free = 0;
      for (unsigned int c = 0; c < n; ++c)
        n_free += motion.is_free(c);
      if (n_free > 0 && n_free < n)
        throw UserError(support.where, "support '" + support.name + "' leaves some components of a rotation free; " +
                                         "in space a rigid body turns freely about all axes or about none: " +
                                         "write 'free; free; free' or give all three");
      if (n_free == n)
        {
          drive.rotation.fill(DrivenBy::free);
          return;
        }
      drive.angle = support.rotation;
      drive.spin  = support.angular_velocity;
      for (unsigned int c = 0; c < n; ++c)
        drive.rotation[c] = prescribed(motion, c, of_velocity ? DrivenBy::velocity : DrivenBy::displacement);
      if (std::any_of(drive.rotation.begin(), drive.rotation.end(), [](const auto k) { return k != DrivenBy::rest; }))
        drive.rotation.fill(of_velocity ? DrivenBy::velocity : DrivenBy::displacement);
    }

    /// A force moves what no support holds; a torque turns a body unless a support says how it turns.
    template <int dim>
    void
    take_loads(Rigid::Drive<dim> &drive, const bool is_supported, const bool rotation_is_given)
    {
      if (drive.has_force())
        for (auto &kind : drive.translation)
          if (kind == DrivenBy::free || !is_supported)
            kind = DrivenBy::force;
      if (!drive.torques.empty() && (!rotation_is_given || drive.rotation.front() == DrivenBy::free))
        drive.rotation.fill(DrivenBy::force);
    }
  } // namespace

  template <int dim>
  Rigid::Drive<dim>
  Scene<dim>::drive_of(const unsigned int b) const
  {
    const auto acts_on = [b](const auto &acting) {
      return acting.region.kind == Region<dim>::Kind::body && acting.region.body == b;
    };
    Rigid::Drive<dim> drive;
    bool              rotation_is_given = false;
    for (unsigned int s = 0; s < supports.size(); ++s)
      if (const auto &support = supports[s]; acts_on(support))
        {
          if (drive.support >= 0)
            throw UserError(support.where, "rigid body '" + bodies[b].name + "' has two supports; give it one");
          drive.support     = s;
          rotation_is_given = support.holds_rotation;
          take_translation(drive, support);
          take_rotation(drive, support);
        }
    for (const auto &load : loads)
      if (acts_on(load))
        {
          if (load.total.given())
            drive.forces.push_back(load.total);
          if (load.torque.given())
            drive.torques.push_back(load.torque);
        }
    for (const auto &migration : migrations)
      if (migration.body == b)
        drive.own_forces.push_back([migration](const double t) { return migration.force(t); });
    take_loads(drive, drive.support >= 0, rotation_is_given);
    if (bodies[b].initial_velocity.given() && drive.support < 0)
      for (auto &kind : drive.translation)
        if (kind == DrivenBy::rest)
          kind = DrivenBy::free;
    return drive;
  }

  template <int dim>
  void
  Scene<dim>::make_rigid_bodies()
  {
    for (unsigned int b = 0; b < bodies.size(); ++b)
      if (const auto &body = bodies[b]; body.rigid)
        {
          const auto moments    = body.shape->moments();
          auto       resistance = body.resistance;
          if (resistance.density > 0.)
            resistance.mass = resistance.density * moments.volume * (dim == 2 ? thickness : 1.);
          rigid_bodies.push_back(
            {body.name, body.where, b, body.pivot.value_or(moments.centroid), drive_of(b), resistance, moments});
          check_rigid_body(rigid_bodies.back());
        }
  }

  template <int dim>
  void
  Scene<dim>::check_rigid_body(const Rigid::Body<dim> &rigid) const
  {
    for (const auto &support : supports)
      if (support.name == rigid.name &&
          (support.region.kind != Region<dim>::Kind::body || support.region.body != rigid.body))
        throw UserError(support.where, "support '" + support.name +
                                         "' has the name of a rigid body that it does not move, so " +
                                         "that their reactions could not be told apart; rename one of them");
    if (!rigid.drive.is_by_balance() && (rigid.resistance.drag > 0. || rigid.resistance.largest_approach > 0.))
      throw UserError(rigid.where, "rigid body '" + rigid.name + "' moves as given, so that its 'Drag' or 'Largest " +
                                     "approach' says nothing; remove it, or let a force move the body");
    for (unsigned int c = 0; c < dim; ++c)
      if (const auto &start = bodies[rigid.body].initial_velocity;
          start.given() && start.value(rigid.pivot, 0., c) != 0. && !Rigid::is_by_balance(rigid.drive.translation[c]))
        throw UserError(rigid.where, "rigid body '" + rigid.name + "' has an 'Initial velocity' along " + "xyz"[c] +
                                       ", where its support says how it moves; make it 0 there, or the support 'free'");
    const auto outer = bounding_box(), box = bodies[rigid.body].bounding_box();
    for (unsigned int d = 0; d < dim && rigid.drive.turns(); ++d)
      if (periodic[d] && (box.lower_bound(d) <= outer.lower_bound(d) || box.upper_bound(d) >= outer.upper_bound(d)))
        throw UserError(rigid.where,
                        "rigid body '" + rigid.name + "' turns, but reaches a side where the scene " +
                          "repeats, so that its parts would come apart; move it inside, or let it not turn");
  }

  template <int dim>
  void
  Scene<dim>::require_drives(const std::string &method, const Abilities &can) const
  {
    for (const auto &[name, where, body, pivot, drive, resistance, moments] : rigid_bodies)
      {
        const bool translates_freely = std::any_of(drive.translation.begin(), drive.translation.end(),
                                                   Rigid::is_by_balance);
        const auto refuse            = [&](const std::string &what, const std::string &advice) {
          throw UserError(drive.support >= 0 ? supports[drive.support].where : where,
                          "rigid body '" + name + "' " + what + ", which 'Method = " + method + "' does not solve; " +
                            advice);
        };
        if (!can.rigid_bodies)
          throw UserError(where, "rigid body '" + name + "' cannot be solved with 'Method = " + method +
                                   "'; remove it, or choose another method");
        if (translates_freely && !can.rigid_forces)
          refuse(!drive.has_force() ? "is left free to move" : "is moved by a force",
                 "prescribe all components of its motion by a support on 'body " + name + "'");
        if (drive.has_force() && !can.rigid_forces)
          refuse("has a force on it", "remove the load: the support prescribes the motion");
        if (drive.turns() && !can.rigid_rotations)
          refuse("turns", "let it not turn");
        if (Rigid::is_by_balance(drive.rotation.front()) && !can.rigid_torques)
          refuse(drive.torques.empty() ? "is left free to turn" : "is turned by a torque",
                 "prescribe its 'Rotation' by a support on 'body " + name + "'");
        if (!drive.torques.empty() && !can.rigid_torques)
          refuse("has a torque on it", "remove the load: the support prescribes the motion");
        if (resistance.drag > 0. && !can.rigid_drag)
          throw UserError(where, "rigid body '" + name + "' has a 'Drag', which 'Method = " + method +
                                   "' does not solve; remove it");
        if (resistance.mass > 0. && drive.is_by_balance() && can.inertia && !can.rigid_masses)
          throw UserError(where, "rigid body '" + name + "' has a mass, but with 'Method = " + method +
                                   "' rigid bodies move without one; remove its 'Density' or 'Mass'");
        if (resistance.largest_approach > 0. && !can.rigid_approach)
          throw UserError(where, "rigid body '" + name + "' has a 'Largest approach', which 'Method = " + method +
                                   "' does not need; remove it");
      }
  }

  template Rigid::Drive<2> Scene<2>::drive_of(unsigned int) const;
  template Rigid::Drive<3> Scene<3>::drive_of(unsigned int) const;
  template void            Scene<2>::make_rigid_bodies();
  template void            Scene<3>::make_rigid_bodies();
  template void            Scene<2>::check_rigid_body(const Rigid::Body<2> &) const;
  template void            Scene<3>::check_rigid_body(const Rigid::Body<3> &) const;
  template void            Scene<2>::require_drives(const std::string &, const Abilities &) const;
  template void            Scene<3>::require_drives(const std::string &, const Abilities &) const;
} // namespace Stroma
