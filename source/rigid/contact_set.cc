#include <stroma/base/parameters.h>
#include <stroma/output/named_rows.h>
#include <stroma/rigid/contact_results.h>
#include <stroma/rigid/contact_set.h>
#include <stroma/shapes/ball.h>
#include <stroma/shapes/path.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Stroma::Rigid
{
  namespace
  {
    constexpr unsigned int max_changes = 4; ///< after these a point stays active for the step
    /// What may be missing of the contact force, and of a step's motion where points meet the body: the tolerance, a length,
    /// can be more than all there is.
    constexpr double largest_part_missing = 1e-4;
    /// What may be missing of the balance of a body that touches nothing: a move of its springs, over the tolerance.
    constexpr double largest_move_untouched = 1e-3;
    /// How close a body is brought to the material that it does not touch yet, over half its width; in so many turns.
    constexpr double       touching   = 1e-9;
    constexpr unsigned int most_turns = 10000;
    /// How deep the body may lie in the material at the start, over the cell size.
    constexpr double deepest_start = 1e-3;
  } // namespace

  void
  ContactSettings::add(Parameters &p)
  {
    p.add("Contact penalty", penalty, "stiffness of contact over P-wave modulus over cell size", "", Range::positive());
    p.add("Contact tolerance", tolerance, "penetration left by the augmented Lagrangian, over cell size", "",
          Range::positive());
  }

  template <int dim>
  ContactSet<dim>::ContactSet(const Scene<dim> &scene, const Contact &contact, const ContactSettings &settings,
                              const bool inertia, const double cell_size, const Unknowns<dim> &unknowns, Points points)
    : scene(scene)
    , contact(contact)
    , unknowns(unknowns)
    , shape(*scene.bodies[contact.body].shape)
    , rigid(unknowns.index_of(contact.body))
    , cell_size(cell_size)
    , penalty(settings.penalty)
    , tolerance(settings.tolerance * cell_size)
    , law(shape, contact, tolerance)
    , points(std::move(points))
  {
    const auto box = shape.bounding_box();
    for (unsigned int d = 0; d < dim; ++d)
      half_width = std::max(half_width, .5 * box.side_length(d));
    set_stage(0.);
    for (unsigned int c = 0; c < n_components; ++c)
      if (!unknowns.is_prescribed(rigid, c) && !(inertia && scene.rigid_bodies[rigid].resistance.mass > 0.))
        by_balance.push_back(c);
    check_start();
  }

  template <int dim>
  void
  ContactSet<dim>::check_start() const
  {
    const auto &body = scene.bodies[contact.body];
    if (contact.type == Contact::Type::frictionless && dynamic_cast<const Shapes::Ball<dim> *>(&shape) != nullptr &&
        !unknowns.is_prescribed(rigid, dim))
      throw UserError(contact.where,
                      "nothing resists the turning of ball '" + body.name +
                        "', which is free, where its contact is frictionless; prescribe its 'Rotation', or "
                        "use 'Type = stick'");
    double deepest = 0;
    for (const auto &point : points)
      deepest = std::max(deepest, -shape.distance(point.X));
    if (dealii::Utilities::MPI::max(deepest, scene.comm) > cell_size * deepest_start)
      throw UserError(body.where, "rigid body '" + body.name + "' lies inside the material at the start; move it out");
  }

  template <int dim>
  void
  ContactSet<dim>::set_stage(const double v_factor)
  {
    double modulus = 0; // of the P-wave, K + 4/3 G, and 3 mu of the central viscosity
    for (unsigned int m = 0; m < scene.materials.size(); ++m)
      modulus = std::max(modulus, scene.materials[m]->p_wave_modulus() + 3. * scene.media[m].viscosity * v_factor);
    eps              = penalty * modulus / cell_size;
    spring_stiffness = modulus * (dim == 2 ? scene.thickness : cell_size);
  }

  template <int dim>
  void
  ContactSet<dim>::start_step(const Vector &u)
  {
    start               = u;
    const auto at_start = coupling(u);
    for (auto &point : points)
      law.start_step(point.state, at_start.place(point, u));
    saved_points = points;
    for (unsigned int c = 0; c < n_components; ++c)
      spring_place[c] = u(unknowns.unknown(rigid, c));
    has_spring = !by_balance.empty();
  }

  template <int dim>
  void
  ContactSet<dim>::restore()
  {
    points = saved_points;
  }

  template <int dim>
  Coupling<dim>
  ContactSet<dim>::coupling(const Vector &u) const
  {
    Coupling<dim> coupling(scene, unknowns, rigid);
    coupling.set_pose(u);
    return coupling;
  }

  /// Whether any point does, on any rank.
  template <int dim>
  bool
  ContactSet<dim>::touches() const
  {
    int any = 0;
    for (const auto &point : points)
      any |= point.state.active;
    return dealii::Utilities::MPI::max(any, scene.comm) > 0;
  }

  /// The loads on the components that the balance of forces moves.
  template <int dim>
  typename ContactSet<dim>::Vec
  ContactSet<dim>::driving_force(const Vector &external) const
  {
    Vec force;
    for (const unsigned int c : by_balance)
      if (const auto dof = unknowns.unknown(rigid, c); c < dim && external.in_local_range(dof))
        force[c] = external(dof);
    return dealii::Utilities::MPI::sum(force, scene.comm);
  }

  /// The torque that is conjugate to the rotation that the balance of forces determines, at the start of the step.
  template <int dim>
  Axial<dim>
  ContactSet<dim>::driving_torque(const double t) const
  {
    if (by_balance.back() < dim)
      return {}; // all components turn alike
    const auto theta = coupling(start).frame().pose.rotation;
    return unknowns.conjugate(rigid, theta, {}, scene.rigid_bodies[rigid].drive.torque(t));
  }

  /// How far the body may move along @p e from the start of the step until it touches; numeric max if it never does.
  template <int dim>
  double
  ContactSet<dim>::gap_along(const Vec &e) const
  {
    const auto at_start = coupling(start);
    const Vec  in_body  = transpose(at_start.frame().R) * e;
    double     distance = std::numeric_limits<double>::max();
    for (const auto &point : points)
      {
        const auto   x   = at_start.place(point, start);
        const double far = std::min(distance, x.distance(shape.bounding_box().center()) + 2. * dim * half_width);
        if (const auto s = Shapes::first_meeting(shape, x, dealii::Point<dim>(x - far * in_body)))
          distance = std::min(distance, *s * far);
      }
    return dealii::Utilities::MPI::min(distance, scene.comm);
  }

  template <int dim>
  bool
  ContactSet<dim>::approach(Vector &u, const Vector &external, const double t)
  {
    if (by_balance.empty() || touches())
      return true;
    const Vec force = external.size() > 0 ? driving_force(external) : Vec();
    if (force.norm() > 0.)
      return move(u, force / force.norm());
    const Axial<dim> torque = driving_torque(t);
    return torque.norm() == 0. || turn(u, torque / torque.norm());
  }

  /// Moves the body along @p e.
  template <int dim>
  bool
  ContactSet<dim>::move(Vector &u, const Vec &e)
  {
    const double distance = gap_along(e);
    if (distance == std::numeric_limits<double>::max())
      return false;
    for (unsigned int c = 0; c < dim; ++c)
      shift(u, c, distance * e[c]);
    u.compress(dealii::VectorOperation::add);
    const auto at_start = coupling(start);
    const Vec  in_body  = transpose(at_start.frame().R) * e;
    for (auto &point : points)
      if (const auto x = at_start.place(point, start); shape.distance(x - distance * in_body) <= touching * half_width)
        law.enter(point.state, x, dealii::Point<dim>(x - (distance + tolerance) * in_body));
    return true;
  }

  /// The body as it was at the start of the step, turned on by @p change of its rotation [rad].
  template <int dim>
  Coupling<dim>
  ContactSet<dim>::turned(const Axial<dim> &change) const
  {
    auto body = coupling(start);
    body.turn(change);
    return body;
  }

  /// How far the body's rotation may go along @p e from the start of the step until it touches [rad]; numeric max if it never
  /// does. No point comes nearer than by its distance from the pivot times the angle.
  template <int dim>
  double
  ContactSet<dim>::angle_along(const Axial<dim> &e) const
  {
    double angle = 0.;
    for (unsigned int i = 0; i < most_turns && angle < 2. * dealii::numbers::PI; ++i)
      {
        const auto body = turned(angle * e);
        double     step = std::numeric_limits<double>::max();
        for (const auto &point : points)
          {
            const auto x = body.place(point, start);
            if (const double r = x.distance(body.frame().pose.pivot); r > 0.)
              step = std::min(step, (shape.distance(x) - .5 * touching * half_width) / r);
          }
        step = dealii::Utilities::MPI::min(step, scene.comm);
        if (step <= .1 * touching)
          return angle;
        angle += step;
      }
    return std::numeric_limits<double>::max();
  }

  /// Turns the body along @p e.
  template <int dim>
  bool
  ContactSet<dim>::turn(Vector &u, const Axial<dim> &e)
  {
    const double angle = angle_along(e);
    if (angle == std::numeric_limits<double>::max())
      return false;
    for (unsigned int k = 0; k < n_rotations<dim>; ++k)
      shift(u, dim + k, unknowns.length(rigid) * angle * e[k]);
    u.compress(dealii::VectorOperation::add);
    const auto before = turned((angle - tolerance / half_width) * e), now = turned(angle * e);
    for (auto &point : points)
      if (const auto x = now.place(point, start); shape.distance(x) <= touching * half_width)
        law.enter(point.state, before.place(point, start), dealii::Point<dim>(x + (x - before.place(point, start))));
    return true;
  }

  /// Moves the first guess of one of the body's unknowns, and its spring.
  template <int dim>
  void
  ContactSet<dim>::shift(Vector &u, const unsigned int component, const double way)
  {
    if (const auto dof = unknowns.unknown(rigid, component); u.in_local_range(dof))
      u(dof) += way;
    spring_place[component] += way;
  }

  template <int dim>
  double
  ContactSet<dim>::summed_force(const Vector &u) const
  {
    const double U       = coupling(u).frame().pose.translation.norm();
    double       squares = 0;
    for (const auto &point : points)
      if (point.state.active)
        squares += std::pow(point.area * (eps * (half_width + U) + point.state.multiplier.norm()), 2);
    return 4. * std::sqrt(dealii::Utilities::MPI::sum(squares, scene.comm));
  }

  template <int dim>
  void
  ContactSet<dim>::add_force(Vector &r, const Vector &u) const
  {
    const auto body = coupling(u);
    for (const auto &point : points)
      if (point.state.active)
        {
          const auto x = body.place(point, u);
          body.add_force(r, point, x, point.area * law.traction(point.state, x, eps));
        }
    if (has_spring)
      for (const unsigned int c : by_balance)
        if (const auto dof = unknowns.unknown(rigid, c); r.in_local_range(dof))
          r(dof) += -spring_stiffness * (u(dof) - spring_place[c]);
  }

  template <int dim>
  void
  ContactSet<dim>::add_tangent(Matrix &K, Vector &r, const Vector &u, const Solvers::Constraints &constraints) const
  {
    const auto body = coupling(u);
    for (const auto &point : points)
      if (point.state.active)
        {
          const auto x = body.place(point, u);
          body.add_tangent(K, r, constraints, point, x, point.area * law.traction(point.state, x, eps),
                           point.area * law.stiffness(point.state, x, eps));
        }
    if (has_spring)
      for (const unsigned int c : by_balance)
        if (const auto dof = unknowns.unknown(rigid, c); K.in_local_range(dof) && !constraints.is_constrained(dof))
          K.add(dof, dof, spring_stiffness);
  }

  template <int dim>
  void
  ContactSet<dim>::add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const
  {
    const Coupling<dim> body(scene, unknowns, rigid);
    for (const auto &point : points)
      body.add_pattern(pattern, constraints, point);
  }

  template <int dim>
  bool
  ContactSet<dim>::update(const Vector &u)
  {
    const auto before = coupling(start), now = coupling(u);
    double     motion = 0;
    for (const auto &point : points)
      motion = std::max(motion, now.place(point, u).distance(before.place(point, start)));
    motion              = dealii::Utilities::MPI::max(motion, scene.comm);
    const double inside = 1e-3 * std::min(tolerance, largest_part_missing * motion);
    Round        round;
    for (auto &point : points)
      update(point, before.place(point, start), now.place(point, u), inside, round);
    round.changed     = dealii::Utilities::MPI::max(int(round.changed), scene.comm) > 0;
    round.violation   = dealii::Utilities::MPI::max(round.violation, scene.comm);
    round.missing     = dealii::Utilities::MPI::sum(round.missing, scene.comm);
    round.total       = dealii::Utilities::MPI::sum(round.total, scene.comm);
    const bool pulled = release_spring(u, round);
    return round.changed || round.violation > tolerance || round.missing > largest_part_missing * round.total || pulled;
  }

  /// One point, which went @p from where it was at the start of the step to @p x. @param inside depth at which it enters [m]
  template <int dim>
  void
  ContactSet<dim>::update(ContactPoint<dim> &point, const dealii::Point<dim> &from, const dealii::Point<dim> &x,
                          const double inside, Round &round) const
  {
    auto &state = point.state;
    if (!state.active && shape.distance(x) >= -inside)
      return;
    const bool may_change = !state.active || state.changes < max_changes;
    const bool is_pulled  = state.active && law.leaves(state, x, eps);
    const Vec  T          = state.active ? law.traction(state, x, eps) : Vec();
    if (!state.active)
      law.enter(state, from, x);
    else if (may_change && is_pulled)
      state.active = false;
    else if ((!is_pulled || !state.slides) && law.change_slip(state, x, eps))
      {
        round.changed = true;
        return;
      }
    else if (!law.follow(state, x, eps) && may_change)
      state.active = false;
    else
      {
        const double left = law.violation(state, x);
        round.violation   = std::max(round.violation, left);
        round.missing += point.area * (eps * left + (is_pulled ? T.norm() : 0.));
        round.total += point.area * T.norm();
        return;
      }
    ++state.changes;
    round.changed = true;
  }

  /// Moves the springs to where the body is, and takes them away once the set is settled; whether they have carried it.
  template <int dim>
  bool
  ContactSet<dim>::release_spring(const Vector &u, const Round &round)
  {
    double square = 0.;
    for (const unsigned int c : by_balance)
      if (has_spring)
        square += std::pow(u(unknowns.unknown(rigid, c)) - spring_place[c], 2);
    for (unsigned int c = 0; c < n_components; ++c)
      spring_place[c] = u(unknowns.unknown(rigid, c));
    const double carried = std::sqrt(square);
    const bool   any     = touches();
    has_spring           = !by_balance.empty() && (round.changed || !any);
    unborne              = !any && carried > largest_move_untouched * tolerance;
    return any ? carried > tolerance || spring_stiffness * carried > largest_part_missing * round.total : unborne;
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  ContactSet<dim>::scalars(const Vector &u, const Vector &balanced) const
  {
    constexpr double    solved = 0.; // penalty: multipliers are the tractions of the solve, update()
    ContactResults<dim> told;
    double              sliding = 0.;
    const auto          body    = coupling(balanced);
    const auto         &pose    = body.frame().pose;
    for (const auto &point : points)
      if (point.state.active)
        {
          const auto x = body.place(point, balanced);
          told.force -= point.area * (body.frame().R * law.traction(point.state, x, solved));
          told.area += point.area;
          sliding += point.state.slides * point.area;
          told.profile.push_back(
            {{(body.frame().R * (x - pose.pivot))[0] + pose.pivot[0], law.pressure(point.state, x, solved)}});
        }
    auto result = told.named(body_name(), scene.comm);
    for (unsigned int c = 0; c < dim; ++c)
      result.emplace_back("displacement_" + body_name() + "_" + "xyz"[c] + "_m", u(unknowns.unknown(rigid, c)));
    if (contact.type == Contact::Type::coulomb)
      result.emplace_back("contact_sliding_area_" + body_name() + "_m2",
                          dealii::Utilities::MPI::sum(sliding, scene.comm));
    return result;
  }

  template <int dim>
  void
  ContactSet<dim>::save(Output::ArchiveWriter &archive) const
  {
    std::vector<std::uint64_t> names;
    std::vector<double>        values;
    for (const auto &point : points)
      if (point.state.active)
        {
          names.push_back(point.name);
          values.resize(values.size() + ContactState<dim>::n_values);
          point.state.save(&values[values.size() - ContactState<dim>::n_values]);
        }
    archive.write("contact_" + contact.name + "_nodes", dealii::make_array_view(names));
    archive.write("contact_" + contact.name, dealii::make_array_view(values));
  }

  template <int dim>
  void
  ContactSet<dim>::load(const Output::ArchiveReader &archive)
  {
    std::vector<std::uint64_t> wanted;
    for (const auto &point : points)
      wanted.push_back(point.name);
    const Output::NamedRows rows(archive, "contact_" + contact.name + "_nodes", wanted, scene.comm);
    const auto              values = rows.read("contact_" + contact.name, ContactState<dim>::n_values);
    const double           *next   = values.data();
    for (std::size_t i = 0; i < points.size(); ++i)
      if (rows.counts()[i] > 0)
        {
          points[i].state.load(next);
          next += ContactState<dim>::n_values * rows.counts()[i];
        }
  }

  template class ContactSet<2>;
  template class ContactSet<3>;
} // namespace Stroma::Rigid
