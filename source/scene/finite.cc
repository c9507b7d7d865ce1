#include <stroma/base/text.h>
#include <stroma/scene/scene.h>

#include <cmath>

namespace Stroma
{
  namespace
  {
    /// Places inside the bodies: a few along each axis of each body's box, off planes where expressions may be singular.
    template <int dim>
    std::vector<dealii::Point<dim>>
    places_in(const Scene<dim> &scene)
    {
      constexpr unsigned int          n = 5;
      std::vector<dealii::Point<dim>> places;
      for (const auto &body : scene.bodies)
        {
          if (body.rigid)
            continue;
          const auto corners = body.bounding_box().get_boundary_points();
          for (unsigned int i = 0; i < (dim == 2 ? n * n : n * n * n); ++i)
            {
              dealii::Point<dim> X;
              for (unsigned int d = 0, rest = i; d < dim; ++d, rest /= n)
                X[d] = corners.first[d] + (rest % n + .3719) / n * (corners.second[d] - corners.first[d]);
              if (scene.material_at(X))
                places.push_back(X);
            }
        }
      return places;
    }

    /// Those of @p places that @p region holds; for a side their projections on it.
    template <int dim>
    std::vector<dealii::Point<dim>>
    places_of(const Region<dim> &region, const Scene<dim> &scene, const std::vector<dealii::Point<dim>> &places)
    {
      const auto box = scene.bounding_box();
      if (region.kind == Region<dim>::Kind::nearest)
        return {region.first};
      if (region.kind == Region<dim>::Kind::body)
        return {scene.bodies[region.body].bounding_box().center()};
      std::vector<dealii::Point<dim>> inside;
      for (auto X : places)
        if (region.kind == Region<dim>::Kind::side)
          {
            X[region.axis] = region.side_coordinate(box);
            inside.push_back(X);
          }
        else if (region.contains(X, *scene.material_at(X), box))
          inside.push_back(X);
      return inside;
    }

    template <int dim, int n_components>
    void
    evaluate(const SpaceTimeVector<dim, n_components> &expression, const std::vector<dealii::Point<dim>> &places,
             const double t)
    {
      if (expression.given())
        for (const auto &X : places)
          expression.value(X, t);
    }
  } // namespace

  template <int dim>
  void
  Scene<dim>::check_finite(const double end_time) const
  {
    forget_not_finite();
    const auto places = places_in(*this);
    for (const auto &support : supports)
      for (const auto *motion : {&support.displacement, &support.velocity})
        evaluate(*motion, places_of(support.region, *this, places), 0.);
    for (const auto &rigid : rigid_bodies)
      {
        for (const auto *motion : {&rigid.drive.angle, &rigid.drive.spin})
          evaluate(*motion, {rigid.pivot}, 0.);
        rigid.drive.torque(0.);
      }
    for (const auto &load : loads)
      for (const auto *force : {&load.density, &load.traction, &load.total})
        evaluate(*force, places_of(load.region, *this, places), 0.);
    for (const auto *vector : {&exact_displacement, &exact_velocity})
      evaluate(*vector, places, end_time);
    for (const auto *scalar : {&exact_pressure, &exact_von_mises})
      evaluate(*scalar, places, end_time);
    for (const auto &body : bodies)
      evaluate(body.initial_velocity, places, 0.);
    if (const auto message = first_not_finite(comm); !message.empty())
      throw UserError(message);
  }

  template <int dim>
  void
  Scene<dim>::check_rest_at_start() const
  {
    const std::string why =
      " at t = 0, when all is at rest, and here forces follow from rates or from the past: the jump "
      "would be spread over the first step, however long that is; let it begin at 0, as a ramp of "
      "some steps";
    const auto   places = places_in(*this);
    const auto   box    = bounding_box();
    const double none   = 1e-12 * box.get_boundary_points().first.distance(box.get_boundary_points().second);
    for (const auto &support : supports)
      if (support.displacement.given())
        for (const auto &X : places_of(support.region, *this, places))
          for (unsigned int c = 0; c < dim; ++c)
            if (!support.displacement.is_free(c))
              if (const double u = support.displacement.value(X, 0., c); std::abs(u) > none)
                throw UserError(support.where, "support '" + support.name + "' is displaced by " + brief(u) +
                                                 " m along " + "xyz"[c] + why);
    for (const auto &rigid : rigid_bodies)
      if (rigid.drive.angle.given())
        if (const double angle = rigid.pose(0.).rotation.norm(); angle > 1e-12)
          {
            const auto &support = supports[rigid.drive.support];
            throw UserError(support.where,
                            "support '" + support.name + "' is turned by " + brief(angle) + " rad" + why);
          }
  }

  template void Scene<2>::check_finite(double) const;
  template void Scene<3>::check_finite(double) const;
  template void Scene<2>::check_rest_at_start() const;
  template void Scene<3>::check_rest_at_start() const;
} // namespace Stroma
