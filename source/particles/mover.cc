#include <stroma/particles/mover.h>

#include <algorithm>

namespace Stroma::Particles
{
  namespace
  {
    constexpr double least_stretch =
      .5; ///< of what stands for material beyond a side, across it; the most is its inverse

    template <int dim>
    void
    require_all_components(const Support<dim> &support)
    {
      for (unsigned int c = 0; c < dim; ++c)
        if (!support.holds(c))
          throw UserError(support.where, "support '" + support.name + "' on '" + support.region.text +
                                           "' leaves component " + "xyz"[c] +
                                           " free, but particles hold sides only in all; " +
                                           "use 'Type = clamp' or give all " + std::to_string(dim) + " components");
    }

    template <int dim>
    Mover<dim>
    held_side(const Scene<dim> &scene, const unsigned int s, const double end_time)
    {
      const auto &support = scene.supports[s];
      if (scene.periodic[support.region.axis])
        throw UserError(support.where, "support '" + support.name + "' holds " + support.region.text +
                                         ", where the scene repeats; take that direction out of 'Periodic/Directions'");
      require_all_components(support);
      Mover<dim> mover;
      mover.name               = support.name;
      mover.support            = s;
      mover.gives_displacement = !support.velocity.given();
      mover.moves              = support.velocity.given() || support.displacement.depends_on_time();
      mover.varies_in_space    = mover.moves &&
                              (support.velocity.given() ? support.velocity : support.displacement).depends_on_place();
      mover.time_difference = 1e-6 * end_time;
      mover.axis            = support.region.axis;
      mover.upper           = support.region.upper;
      mover.coordinate      = support.region.side_coordinate(scene.bounding_box());
      return mover;
    }

    /// The unit normal of what the columns of @p F but one span, on the side of the axis.
    template <int dim>
    dealii::Tensor<1, dim>
    turned_normal(const dealii::Tensor<2, dim> &F, const unsigned int axis)
    {
      const auto column = [&](const unsigned int d) {
        dealii::Tensor<1, dim> a;
        for (unsigned int c = 0; c < dim; ++c)
          a[c] = F[c][(axis + d) % dim];
        return a;
      };
      dealii::Tensor<1, dim> normal;
      if constexpr (dim == 2)
        normal = (axis == 0 ? 1. : -1.) * dealii::cross_product_2d(column(1));
      else
        normal = dealii::cross_product_3d(column(1), column(2));
      return normal / normal.norm();
    }

    /// @p F with a normal column that goes on at least by @p least and at most by its inverse along the turned normal.
    template <int dim>
    dealii::Tensor<2, dim>
    with_sound_normal(dealii::Tensor<2, dim> F, const unsigned int axis, const double least)
    {
      const auto normal  = turned_normal(F, axis);
      double     stretch = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        stretch += F[c][axis] * normal[c];
      const double sound = std::isfinite(stretch) ? std::clamp(stretch, least, 1. / least) : 1.;
      for (unsigned int c = 0; c < dim; ++c)
        F[c][axis] = (std::isfinite(stretch) ? F[c][axis] - stretch * normal[c] : 0.) + sound * normal[c];
      return F;
    }

    template <int dim>
    Mover<dim>
    rigid_body(const Rigid::Body<dim> &rigid, const double end_time)
    {
      Mover<dim> mover;
      mover.name            = rigid.name;
      mover.support         = rigid.drive.support;
      mover.rigid           = &rigid;
      mover.moves           = rigid.drive.moves();
      mover.varies_in_space = rigid.drive.turns();
      mover.time_difference = 1e-6 * end_time;
      return mover;
    }
  } // namespace

  template <int dim>
  Shapes::Nearest<dim>
  Mover<dim>::nearest(const Scene<dim> &scene, const dealii::Point<dim> &X) const
  {
    if (rigid)
      return scene.bodies[rigid->body].shape->nearest(X);
    Shapes::Nearest<dim> surface;
    surface.foot         = foot(X);
    surface.normal[axis] = upper ? -1. : 1.;
    surface.distance     = upper ? coordinate - X[axis] : X[axis] - coordinate;
    return surface;
  }

  template <int dim>
  dealii::Point<dim>
  Mover<dim>::foot(dealii::Point<dim> X) const
  {
    if (!rigid)
      X[axis] = coordinate;
    return X;
  }

  template <int dim>
  dealii::Tensor<1, dim>
  Mover<dim>::velocity(const Scene<dim> &scene, const dealii::Point<dim> &X, const double t, const double t_next) const
  {
    if (!moves)
      return {};
    return gives_displacement ? (displacement(scene, X, t_next) - displacement(scene, X, t)) / (t_next - t) :
                                velocity(scene, X, t_next);
  }

  template <int dim>
  dealii::Tensor<1, dim>
  Mover<dim>::displacement(const Scene<dim> &scene, const dealii::Point<dim> &X, const double t) const
  {
    Assert(!rigid && gives_displacement, dealii::ExcMessage("integrate the velocity"));
    return moves ? scene.supports[support].displacement.value(X, t) : dealii::Tensor<1, dim>();
  }

  template <int dim>
  dealii::Tensor<2, dim>
  Mover<dim>::gradient_of_motion(const Scene<dim> &scene, const dealii::Point<dim> &X, const double t) const
  {
    const auto             box = scene.bounding_box();
    const auto             at  = foot(X);
    dealii::Tensor<2, dim> F   = dealii::unit_symmetric_tensor<dim>();
    for (unsigned int d = 0; d < dim; ++d)
      {
        auto before = at, after = at;
        before[d] -= place_difference;
        after[d] += place_difference;
        if (at[d] >= box.lower_bound(d) && at[d] <= box.upper_bound(d)) // where the expression must have a meaning
          {
            before[d] = std::max(before[d], box.lower_bound(d));
            after[d]  = std::min(after[d], box.upper_bound(d));
          }
        const auto du = (displacement(scene, after, t) - displacement(scene, before, t)) / (after[d] - before[d]);
        for (unsigned int c = 0; c < dim; ++c)
          F[c][d] += du[c];
      }
    return with_sound_normal(F, axis, least_stretch);
  }

  template <int dim>
  dealii::Tensor<1, dim>
  Mover<dim>::displacement_beyond(const Scene<dim> &scene, const dealii::Point<dim> &X, const double t) const
  {
    const auto at = foot(X);
    if (!deforms())
      return displacement(scene, at, t);
    return displacement(scene, at, t) + gradient_of_motion(scene, X, t) * (X - at) - (X - at);
  }

  template <int dim>
  dealii::Tensor<1, dim>
  Mover<dim>::velocity_beyond(const Scene<dim> &scene, const dealii::Point<dim> &X, const double t,
                              const double t_next) const
  {
    if (!deforms())
      return velocity(scene, foot(X), t, t_next);
    return (displacement_beyond(scene, X, t_next) - displacement_beyond(scene, X, t)) / (t_next - t);
  }

  template <int dim>
  dealii::Tensor<1, dim>
  Mover<dim>::velocity(const Scene<dim> &scene, const dealii::Point<dim> &X, const double t) const
  {
    if (!moves)
      return {};
    if (!gives_displacement)
      return scene.supports[support].velocity.value(X, t);
    const double h = time_difference;
    const auto   u = [&](const double at) { return scene.supports[support].displacement.value(X, at); };
    return t < h ? (4. * u(t + h) - 3. * u(t) - u(t + 2. * h)) / (2. * h) : (u(t + h) - u(t - h)) / (2. * h);
  }

  template <int dim>
  std::vector<Mover<dim>>
  movers_of(const Scene<dim> &scene, const double end_time, const double spacing)
  {
    using Kind = typename Region<dim>::Kind;
    std::vector<Mover<dim>> movers;
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      {
        const auto &support = scene.supports[s];
        if (support.region.kind == Kind::rim)
          throw UserError(support.where, "support '" + support.name +
                                           "' holds a rim, which particles do not have; hold a " +
                                           "'side', or the material near it by 'layer', 'box' or 'ball'");
        if (support.region.kind != Kind::side)
          continue;
        const auto mover = held_side(scene, s, end_time);
        for (const auto &other : movers)
          if (other.axis == mover.axis && other.upper == mover.upper)
            throw UserError(support.where,
                            "supports '" + other.name + "' and '" + mover.name + "' hold the same side; keep one");
        movers.push_back(mover);
      }
    for (const auto &rigid : scene.rigid_bodies)
      movers.push_back(rigid_body(rigid, end_time));
    for (auto &mover : movers)
      mover.place_difference = spacing / 2.;
    return movers;
  }

  template struct Mover<2>;
  template struct Mover<3>;
  template std::vector<Mover<2>> movers_of(const Scene<2> &, double, double);
  template std::vector<Mover<3>> movers_of(const Scene<3> &, double, double);
} // namespace Stroma::Particles
