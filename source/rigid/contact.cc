#include <stroma/rigid/contact.h>
#include <stroma/shapes/path.h>

#include <algorithm>

namespace Stroma::Rigid
{
  namespace
  {
    constexpr double       sharp_edge = .866; ///< cosine of the angle round which a point does not follow a surface
    constexpr unsigned int max_turns  = 20;   ///< of a point in a step: then it keeps its plane, and the solve an end
    constexpr unsigned int max_slips  = 10;   ///< of a point in a step: then it goes on sticking or sliding
    /// What is let go before a point changes between sticking and sliding: of the friction, and over the resolution of lengths.
    constexpr double friction_let_go = 1e-6, slip_let_go = 1e-3;

    /// Lambda_t, where the multiplier was found.
    template <int dim>
    dealii::Tensor<1, dim>
    along_surface(const ContactState<dim> &point)
    {
      return point.multiplier - (point.multiplier * point.normal) * point.normal;
    }

    template <int dim>
    dealii::Tensor<1, dim>
    direction(const dealii::Tensor<1, dim> &v)
    {
      const double length = v.norm();
      return length > 0. ? v / length : v;
    }

    /// The derivative of direction(v) by what v depends on by @p dv.
    template <int dim>
    dealii::Tensor<2, dim>
    turning_of(const dealii::Tensor<1, dim> &v, const dealii::Tensor<2, dim> &dv)
    {
      const double length = v.norm();
      const auto   d      = direction(v);
      return length > 0. ? (dv - outer_product(d, d * dv)) / length : dealii::Tensor<2, dim>();
    }
  } // namespace

  template <int dim>
  void
  ContactState<dim>::save(double *values) const
  {
    for (unsigned int d = 0; d < dim; ++d)
      {
        values[d]           = multiplier[d];
        values[dim + d]     = anchor[d];
        values[2 * dim + d] = normal[d];
      }
    values[3 * dim] = slides;
  }

  template <int dim>
  void
  ContactState<dim>::load(const double *values)
  {
    active = true;
    std::copy_n(values, dim, multiplier.begin_raw());
    std::copy_n(values + dim, dim, anchor.begin_raw());
    std::copy_n(values + 2 * dim, dim, normal.begin_raw());
    slides = values[3 * dim] > 0.;
  }

  template <int dim>
  ContactLaw<dim>::ContactLaw(const Shapes::Shape<dim> &shape, const Contact &contact, const double resolution)
    : shape(shape)
    , type(contact.type)
    , friction(contact.friction)
    , resolution(resolution)
  {}

  template <int dim>
  typename ContactLaw<dim>::Touch
  ContactLaw<dim>::touch(const ContactState<dim> &point, const dealii::Point<dim> &x) const
  {
    const auto nearest = shape.nearest(x);
    if (nearest.curvature != 0. || type == Contact::Type::stick)
      return {nearest.distance, nearest.normal, nearest.curvature};
    return {(x - point.anchor) * point.normal, point.normal, 0.};
  }

  template <int dim>
  bool
  ContactLaw<dim>::sticks(const ContactState<dim> &point) const
  {
    return type == Contact::Type::stick || (type == Contact::Type::coulomb && !point.slides);
  }

  template <int dim>
  void
  ContactLaw<dim>::start_step(ContactState<dim> &point, const dealii::Point<dim> &x) const
  {
    point.changes = point.slips = point.turns = 0;
    if (!point.active || !point.slides)
      return;
    const auto now = touch(point, x);
    point.anchor   = x - now.gap * now.normal;
  }

  template <int dim>
  void
  ContactLaw<dim>::enter(ContactState<dim> &point, const dealii::Point<dim> &from, const dealii::Point<dim> &to) const
  {
    point.active     = true;
    point.slides     = false;
    point.multiplier = Vec();
    const double s   = Shapes::first_meeting(shape, from, to).value_or(0.);
    const auto   met = shape.nearest(from + s * (to - from));
    point.anchor     = met.foot;
    // At an edge the normals of both sides meet: seen from a little before, it is the one that faces the path.
    point.normal = shape.nearest(met.foot - resolution / std::max(resolution, from.distance(to)) * (to - from)).normal;
  }

  template <int dim>
  typename ContactLaw<dim>::Vec
  ContactLaw<dim>::traction(const ContactState<dim> &point, const dealii::Point<dim> &x, const double eps) const
  {
    if (sticks(point))
      return point.multiplier - eps * (x - point.anchor);
    if (type == Contact::Type::coulomb)
      {
        const auto now = sliding(point, x, eps);
        return now.pressure * (now.touch.normal + friction * direction(now.tau));
      }
    const auto [gap, normal, curvature] = touch(point, x);
    return (point.multiplier.norm() - eps * gap) * normal;
  }

  template <int dim>
  double
  ContactLaw<dim>::pressure(const ContactState<dim> &point, const dealii::Point<dim> &x, const double eps) const
  {
    return traction(point, x, eps) * touch(point, x).normal;
  }

  template <int dim>
  dealii::Tensor<2, dim>
  ContactLaw<dim>::stiffness(const ContactState<dim> &point, const dealii::Point<dim> &x, const double eps) const
  {
    const dealii::Tensor<2, dim> I = dealii::unit_symmetric_tensor<dim>();
    if (sticks(point))
      return eps * I;
    if (type == Contact::Type::coulomb)
      return sliding_stiffness(point, sliding(point, x, eps), x, eps);
    const auto [gap, n, curvature] = touch(point, x);
    const double p                 = std::max(0., point.multiplier.norm() - eps * gap);
    return eps * outer_product(n, n) - p * curvature * (I - outer_product(n, n));
  }

  template <int dim>
  typename ContactLaw<dim>::Sliding
  ContactLaw<dim>::sliding(const ContactState<dim> &point, const dealii::Point<dim> &x, const double eps) const
  {
    Sliding      now;
    const double multiplier = point.multiplier.norm() / std::hypot(1., friction); // its part along n
    now.touch               = touch(point, x);
    now.pressure            = multiplier - eps * now.touch.gap;
    const auto along        = [&](const Vec &v) { return v - (v * now.touch.normal) * now.touch.normal; };
    now.friction            = along(along_surface(point));
    now.slip                = along(x - point.anchor);
    const Vec t             = direction(now.friction);
    now.forward             = now.slip * t;
    now.tau                 = friction * multiplier * t - eps * (now.slip - std::max(0., now.forward) * t);
    return now;
  }

  /// -dT/dx of a point that slides, with dt/dx by the chain n, Lambda_t and s, tau.
  template <int dim>
  dealii::Tensor<2, dim>
  ContactLaw<dim>::sliding_stiffness(const ContactState<dim> &point, const Sliding &now, const dealii::Point<dim> &x,
                                     const double eps) const
  {
    const auto                  &n = now.touch.normal;
    const Vec                    t = direction(now.tau), t_0 = direction(now.friction);
    const dealii::Tensor<2, dim> I = dealii::unit_symmetric_tensor<dim>(), P = I - outer_product(n, n);
    const double                 k = now.touch.curvature, p = std::max(0., now.pressure);
    const auto                   turned = [&](const Vec &v, const Vec &v_along) { // d(P v)/dx with v fixed
      return -k * ((n * v) * P + outer_product(n, v_along));
    };
    const auto             dt_0 = turning_of(now.friction, turned(along_surface(point), now.friction));
    const auto             ds   = P + turned(x - point.anchor, now.slip);
    dealii::Tensor<2, dim> dtau = friction * point.multiplier.norm() / std::hypot(1., friction) * dt_0 - eps * ds;
    if (now.forward > 0.)
      dtau += eps * (outer_product(t_0, t_0 * ds + now.slip * dt_0) + now.forward * dt_0);
    return eps * outer_product(n + friction * t, n) - p * k * P - friction * p * turning_of(now.tau, dtau);
  }

  template <int dim>
  bool
  ContactLaw<dim>::change_slip(ContactState<dim> &point, const dealii::Point<dim> &x, const double eps) const
  {
    if (type != Contact::Type::coulomb || point.slips >= max_slips)
      return false;
    const Vec T = traction(point, x, eps), n = touch(point, x).normal;
    const Vec along = T - (T * n) * n;
    if (point.slides ? sliding(point, x, eps).forward <= slip_let_go * resolution :
                       along.norm() <= (1. + friction_let_go) * friction * (T * n))
      return false;
    ++point.slips;
    point.multiplier = point.slides ? T : std::max(0., T * n) * (n + friction * direction(along));
    point.normal     = n;
    point.slides     = !point.slides;
    return true;
  }

  template <int dim>
  bool
  ContactLaw<dim>::leaves(const ContactState<dim> &point, const dealii::Point<dim> &x, const double eps) const
  {
    return pressure(point, x, eps) < 0.;
  }

  template <int dim>
  double
  ContactLaw<dim>::violation(const ContactState<dim> &point, const dealii::Point<dim> &x) const
  {
    if (type == Contact::Type::frictionless)
      return std::abs(touch(point, x).gap);
    if (sticks(point))
      return x.distance(point.anchor);
    const auto now = sliding(point, x, 0.);
    return std::abs(now.touch.gap) + (now.slip - std::min(0., now.forward) * direction(now.friction)).norm();
  }

  template <int dim>
  bool
  ContactLaw<dim>::follow(ContactState<dim> &point, const dealii::Point<dim> &x, const double eps) const
  {
    const auto now   = touch(point, x);
    const Vec  T     = traction(point, x, eps);
    point.multiplier = !sticks(point) && T * now.normal < 0. ? Vec() : T;
    if (type == Contact::Type::coulomb)
      point.normal = now.normal;
    const auto foot = x - now.gap * now.normal; // on the tangent plane
    if (sticks(point) || now.curvature != 0. || point.turns >= max_turns ||
        std::abs(shape.distance(foot)) <= resolution)
      return true;
    ++point.turns;
    const auto next = shape.nearest(x);
    if (next.normal * point.normal < sharp_edge)
      return false;
    point.anchor     = next.foot;
    point.normal     = next.normal;
    const Vec along  = point.multiplier - (point.multiplier * next.normal) * next.normal;
    point.multiplier = point.multiplier.norm() *
                       (point.slides ? direction(next.normal + friction * direction(along)) : next.normal);
    return true;
  }

  template struct ContactState<2>;
  template struct ContactState<3>;
  template class ContactLaw<2>;
  template class ContactLaw<3>;
} // namespace Stroma::Rigid
