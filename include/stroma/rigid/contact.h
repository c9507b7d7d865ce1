#pragma once

#include <stroma/scene/scene.h>

namespace Stroma::Rigid
{
  /// Whether body @p b of the scene, a rigid one, touches the material by contact; else it is bonded to it.
  template <int dim>
  bool
  has_contact(const Scene<dim> &scene, const unsigned int b)
  {
    for (const auto &contact : scene.contacts)
      if (contact.body == b)
        return true;
    return false;
  }

  /// What a point of a material's surface remembers of its contact with a rigid body. Places and directions are in the
  /// body's frame: as it lies at the start.
  template <int dim>
  struct ContactState
  {
    bool                   active = false;
    bool                   slides = false; ///< with Coulomb's friction: the force along the surface is at its limit
    dealii::Tensor<1, dim> multiplier;     ///< Lambda, traction on the material [Pa]; frictionless: along the normal
    dealii::Point<dim>     anchor; ///< a, where the point's path met the body; where it slides from, in this step [m]
    dealii::Tensor<1, dim> normal; ///< n_a of the tangent plane at a that stands for a flat piece of surface; with
                                   ///< friction that of the multiplier
    unsigned int changes = 0;      ///< of activity, in this step
    unsigned int slips   = 0;      ///< changes between sticking and sliding, in this step
    unsigned int turns   = 0;      ///< from one tangent plane to another, in this step

    static constexpr unsigned int n_values = 3 * dim + 1;

    /// Writes what an active point must keep from step to step to @p values, n_values numbers, or reads it back.
    void save(double *values) const;
    void load(const double *values);
  };

  /**
   * Laws of contact between a rigid body and points of a material's surface, of which x is the place in the body's frame:
   * tractions on the material with augmented multipliers (Simo & Laursen 1992),
   *   frictionless  T = (|Lambda| - eps g) n,   g the distance from the surface, n its normal,
   *   stick         T = Lambda - eps (x - a),   a where the point's path met the body,
   *   Coulomb       as stick while the part along the surface is at most mu p, with p = T.n; beyond, where it slides,
   *                 T = p n + mu p t,   p = Lambda.n - eps g,   t along Lambda_t - eps s with s = (I - n n)(x - a), the slip
   *                 since the step began, of which the part along Lambda_t counts backward only: t is against s in the end.
   * Whether a point sticks or slides is fixed during a solve, and found anew by follow(). On flat pieces of surface (of boxes, polygons, triangles) n and g are those of the tangent plane at a, so that a linear
   * solve sees no edge; follow() moves the plane on between solves.
   *
   * A point enters when it lies inside the body, and leaves when it would be pulled. What is to come (a tension that it
   * bears, repulsion) is a condition in leaves() and a part of traction() and stiffness().
   */
  template <int dim>
  class ContactLaw
  {
  public:
    using Vec = dealii::Tensor<1, dim>;

    /// @param resolution length up to which the gap must be closed [m]
    ContactLaw(const Shapes::Shape<dim> &shape, const Contact &contact, double resolution);

    /// What a point at @p x keeps when a step begins: where it slides from.
    void start_step(ContactState<dim> &point, const dealii::Point<dim> &x) const;

    /// Makes a point active that went from @p from to @p to: where its path met the body it is in touch, without a force.
    void enter(ContactState<dim> &point, const dealii::Point<dim> &from, const dealii::Point<dim> &to) const;

    /// Whether an active point at @p x would be pulled, with the penalty @p eps [Pa/m].
    bool leaves(const ContactState<dim> &point, const dealii::Point<dim> &x, double eps) const;

    /// Traction on an active point [Pa], and its negative derivative by x [Pa/m].
    Vec                    traction(const ContactState<dim> &point, const dealii::Point<dim> &x, double eps) const;
    dealii::Tensor<2, dim> stiffness(const ContactState<dim> &point, const dealii::Point<dim> &x, double eps) const;

    /// Compression across the surface that the traction means [Pa].
    double pressure(const ContactState<dim> &point, const dealii::Point<dim> &x, double eps) const;

    /// What the multipliers have still to close [m].
    double violation(const ContactState<dim> &point, const dealii::Point<dim> &x) const;

    /// Takes the traction at @p x over into the multiplier, and the tangent plane to where the point has slid; false if it has
    /// slid round a sharp edge, and is off the surface.
    bool follow(ContactState<dim> &point, const dealii::Point<dim> &x, double eps) const;

    /// Whether an active point that sticks must slide, or the other way round, after a solve that has brought it to @p x; then
    /// it does. Before follow().
    bool change_slip(ContactState<dim> &point, const dealii::Point<dim> &x, double eps) const;

  private:
    /// g, n and dn/dx = k (I - n n).
    struct Touch
    {
      double gap = 0.;
      Vec    normal;
      double curvature = 0.;
    };
    Touch touch(const ContactState<dim> &point, const dealii::Point<dim> &x) const;
    bool  sticks(const ContactState<dim> &point) const;

    /// Of a point that slides.
    struct Sliding
    {
      Touch  touch;
      double pressure = 0.; ///< p [Pa]
      Vec    slip;          ///< s [m]
      Vec    friction;      ///< Lambda_t [Pa]
      double forward = 0.;  ///< s along Lambda_t, against which it should be [m]
      Vec    tau;           ///< along t [Pa]
    };
    Sliding                sliding(const ContactState<dim> &point, const dealii::Point<dim> &x, double eps) const;
    dealii::Tensor<2, dim> sliding_stiffness(const ContactState<dim> &point, const Sliding &now,
                                             const dealii::Point<dim> &x, double eps) const;

    const Shapes::Shape<dim> &shape;
    const Contact::Type       type;
    const double              friction; ///< mu
    const double              resolution;
  };
} // namespace Stroma::Rigid
