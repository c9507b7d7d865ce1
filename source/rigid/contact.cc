#include <stroma/rigid/contact.h>
#include <stroma/shapes/path.h>

#include <algorithm>

namespace Stroma::Rigid
{
  namespace
  {
    constexpr double       sharp_edge = .866; ///< cosine of the angle round which a point does not follow a surface
    constexpr unsigned int max_turns  = 20;   ///< of a point in a step: then it keeps its plane, and the solve an end
  }                                           // namespace

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
  }

  template <int dim>
  void
  ContactState<dim>::load(const double *values)
  {
    active = true;
    std::copy_n(values, dim, multiplier.begin_raw());
    std::copy_n(values + dim, dim, anchor.begin_raw());
    std::copy_n(values + 2 * dim, dim, normal.begin_raw());
  }

  template <int dim>
  ContactLaw<dim>::ContactLaw(const Shapes::Shape<dim> &shape, const Contact::Type type, const double resolution)
    : shape(shape)
    , type(type)
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
  void
  ContactLaw<dim>::enter(ContactState<dim> &point, const dealii::Point<dim> &from, const dealii::Point<dim> &to) const
  {
    point.active     = true;
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
    if (type == Contact::Type::stick)
      return point.multiplier - eps * (x - point.anchor);
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
    if (type == Contact::Type::stick)
      return eps * I;
    const auto [gap, n, curvature] = touch(point, x);
    const double p                 = std::max(0., point.multiplier.norm() - eps * gap);
    return eps * outer_product(n, n) - p * curvature * (I - outer_product(n, n));
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
    return type == Contact::Type::stick ? x.distance(point.anchor) : std::abs(touch(point, x).gap);
  }

  template <int dim>
  bool
  ContactLaw<dim>::follow(ContactState<dim> &point, const dealii::Point<dim> &x, const double eps) const
  {
    const auto now   = touch(point, x);
    const Vec  T     = traction(point, x, eps);
    point.multiplier = type == Contact::Type::frictionless && T * now.normal < 0. ? Vec() : T;
    const auto foot  = x - now.gap * now.normal; // on the tangent plane
    if (type == Contact::Type::stick || now.curvature != 0. || point.turns >= max_turns ||
        std::abs(shape.distance(foot)) <= resolution)
      return true;
    ++point.turns;
    const auto next = shape.nearest(x);
    if (next.normal * point.normal < sharp_edge)
      return false;
    point.anchor     = next.foot;
    point.normal     = next.normal;
    point.multiplier = point.multiplier.norm() * next.normal;
    return true;
  }

  template struct ContactState<2>;
  template struct ContactState<3>;
  template class ContactLaw<2>;
  template class ContactLaw<3>;
} // namespace Stroma::Rigid
