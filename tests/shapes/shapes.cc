// Shapes: distance, foot and normal against brute force and each other, moments against closed forms, facets.

#include "stl_files.h"

#include <stroma/shapes/ball.h>
#include <stroma/shapes/box.h>
#include <stroma/shapes/path.h>
#include <stroma/shapes/ring.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace
{
  using namespace Stroma;
  using namespace Stroma::Shapes;
  constexpr double pi = dealii::numbers::PI;

  using Shape2 = std::shared_ptr<const Shape<2>>;
  using Shape3 = std::shared_ptr<const Shape<3>>;

  /// An L, whose corner at (1, 1) points inwards.
  std::shared_ptr<const Polygon>
  bracket()
  {
    return make_polygon({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}});
  }

  std::shared_ptr<const Polygon>
  regular_polygon(const unsigned int n, const double radius)
  {
    std::vector<dealii::Point<2>> corners;
    for (unsigned int i = 0; i < n; ++i)
      corners.emplace_back(radius * std::cos(2 * pi * i / n), radius * std::sin(2 * pi * i / n));
    return make_polygon(corners);
  }

  /// The surface of a shape as a mesh of its own.
  std::shared_ptr<const Surface>
  meshed(const Shape<3> &shape, const double size)
  {
    return make_surface(read_stl(StlFiles::binary(shape.facets(size))));
  }

  std::map<std::string, Shape2>
  plane_shapes()
  {
    return {{"disk", std::make_shared<Ball<2>>(dealii::Point<2>(.3, -.2), .8)},
            {"box", std::make_shared<Box<2>>(dealii::Point<2>(-1, -.5), dealii::Point<2>(.5, 1.25))},
            {"quarter ring", std::make_shared<Ring>(dealii::Point<2>(.1, .2), .5, 1.5, 0, 90)},
            {"long ring", std::make_shared<Ring>(dealii::Point<2>(.1, .2), .5, 1.5, -100, 200)},
            {"whole ring", std::make_shared<Ring>(dealii::Point<2>(.1, .2), .5, 1.5, 0, 360)},
            {"bracket", bracket()},
            {"polygon", regular_polygon(17, 1.2)}};
  }

  std::map<std::string, Shape3>
  space_shapes()
  {
    const Ball<3> ball({.3, -.2, .1}, .8);
    const Box<3>  box({-1, -.5, 0}, {.5, 1.25, .75});
    return {{"ball", std::make_shared<Ball<3>>(ball)},
            {"box", std::make_shared<Box<3>>(box)},
            {"meshed ball", meshed(ball, .3)},
            {"meshed box", meshed(box, 5.)}};
  }

  /// Places in and around a shape.
  template <int dim>
  std::vector<dealii::Point<dim>>
  places_around(const Shape<dim> &shape, const unsigned int n)
  {
    std::mt19937                     random(1);
    std::uniform_real_distribution<> uniform(-.3, 1.3);
    std::vector<dealii::Point<dim>>  places(n);
    for (auto &place : places)
      {
        for (unsigned int d = 0; d < dim; ++d)
          place[d] = uniform(random);
        place = shape.bounding_box().unit_to_real(place);
      }
    return places;
  }

  /// Distance from facets, by trying all places of all.
  template <int dim>
  double
  distance_from(const std::vector<Facet<dim>> &facets, const dealii::Point<dim> &X)
  {
    double least = std::numeric_limits<double>::max();
    for (const auto &facet : facets)
      for (const auto &corner : facet.corners)
        least = std::min(least, X.distance(corner));
    return least;
  }

  template <int dim>
  void
  check_distance(const Shape<dim> &shape, const double size, const std::string &name)
  {
    const auto   facets = shape.facets(size);
    const double h      = 1e-6;
    unsigned int inside = 0;
    for (const auto &X : places_around(shape, 200))
      {
        const auto found = shape.nearest(X);
        // A corner of a facet lies on the surface, at most `size` from the foot and on a curve of little sagitta.
        const double tried = distance_from(facets, X);
        EXPECT_LE(std::abs(found.distance), tried + 1e-12) << name << " at " << X;
        EXPECT_GE(std::abs(found.distance), tried - size) << name << " at " << X;
        EXPECT_NEAR(X.distance(found.foot), std::abs(found.distance), 1e-12) << name << " at " << X;
        EXPECT_NEAR(shape.distance(found.foot), 0., 1e-12) << name << " at " << X;
        EXPECT_EQ(found.distance <= 0, shape.contains(X)) << name << " at " << X;
        EXPECT_NEAR(found.normal.norm(), 1., 1e-12) << name << " at " << X;
        inside += found.distance < 0;
        // The normal is the gradient of the distance, its derivative k (I - n n), but on ridges.
        dealii::Tensor<1, dim> gradient;
        bool                   is_smooth = true;
        for (unsigned int d = 0; d < dim; ++d)
          {
            const dealii::Tensor<1, dim> step = h * dealii::Point<dim>::unit_vector(d);
            const auto                   up = shape.nearest(X + step), down = shape.nearest(X - step);
            gradient[d] = (up.distance - down.distance) / (2 * h);
            is_smooth &= (up.normal - down.normal).norm() < 1e-3;
          }
        if (is_smooth)
          {
            EXPECT_LT((gradient - found.normal).norm(), 1e-5) << name << " at " << X;
          }
      }
    EXPECT_GT(inside, 10u) << name;
    EXPECT_LT(inside, 180u) << name;
  }

  TEST(Shapes, DistanceFootAndNormal)
  {
    for (const auto &[name, shape] : plane_shapes())
      check_distance<2>(*shape, .02, name);
    for (const auto &[name, shape] : space_shapes())
      check_distance<3>(*shape, .1, name);
  }

  TEST(Shapes, CurvatureIsTheDerivativeOfTheNormal)
  {
    const Ring                 ring({0, 0}, .5, 1.5, 0, 90);
    const Ball<3>              ball({0, 0, 0}, 1);
    const double               h = 1e-5;
    dealii::Point<2>           outer(1., 1.), inner(.4, .4);
    const dealii::Tensor<1, 2> step({-h, h});
    for (const auto &X : {outer, inner})
      {
        const auto change = ring.nearest(X + step).normal - ring.nearest(X - step).normal;
        EXPECT_NEAR(change * step / (2. * h * h), 2. * ring.nearest(X).curvature, 1e-6);
      }
    const dealii::Point<3>     X(.6, 0, 0);
    const dealii::Tensor<1, 3> along({0, 0, h});
    EXPECT_NEAR((ball.nearest(X + along).normal - ball.nearest(X).normal)[2] / h, ball.nearest(X).curvature, 1e-6);
  }

  TEST(Shapes, SignAtSharpEdges)
  {
    // A blade: places beside its edge whose nearest facet faces away from them.
    const Facet<3>         base{{{{0, 0, 0}, {0, 1, 0}, {10, .5, -.05}}}};
    const dealii::Point<3> top(0, .5, .1);
    std::vector<Facet<3>>  facets{base};
    for (unsigned int i = 0; i < 3; ++i)
      facets.push_back({{{base.corners[(i + 1) % 3], base.corners[i], top}}});
    if (facets[0].area_vector()[2] > 0)
      for (auto &facet : facets)
        std::swap(facet.corners[1], facet.corners[2]);
    const auto blade = make_surface(read_stl(StlFiles::binary(facets)));
    for (const auto &X :
         {dealii::Point<3>(10.1, .5, .3), dealii::Point<3>(10.1, .5, -.3), dealii::Point<3>(10.01, .5, 0)})
      EXPECT_GT(blade->distance(X), 0.) << X;
    const auto thorn = make_polygon({{0, 0}, {10, .01}, {0, .02}});
    for (const double y : {-.3, 0., .01, .3})
      EXPECT_GT(thorn->distance({10.05, y}), 0.) << y;
    EXPECT_LT(thorn->distance({9., .01}), 0.);
  }

  /// Moments by sampling.
  template <int dim>
  void
  check_moments(const Shape<dim> &shape, const unsigned int n, const double tolerance, const std::string &name)
  {
    const auto             box = shape.bounding_box();
    unsigned int           all = 1;
    Moments<dim>           sampled;
    dealii::Tensor<1, dim> first;
    for (unsigned int d = 0; d < dim; ++d)
      all *= n;
    const auto   known = shape.moments();
    const double dV    = box.volume() / all;
    for (unsigned int i = 0; i < all; ++i)
      {
        dealii::Point<dim> X;
        for (unsigned int d = 0, rest = i; d < dim; ++d, rest /= n)
          X[d] = (rest % n + .5) / n;
        X = box.unit_to_real(X);
        if (!shape.contains(X))
          continue;
        sampled.volume += dV;
        first += dV * (X - known.centroid);
        sampled.second += dV * symmetrize(outer_product(X - known.centroid, X - known.centroid));
      }
    EXPECT_NEAR(sampled.volume, known.volume, tolerance * known.volume) << name;
    EXPECT_LT(first.norm(), tolerance * known.volume) << name;
    EXPECT_LT((sampled.second - known.second).norm(), tolerance * known.second.norm()) << name;
  }

  TEST(Shapes, MomentsAgainstSamples)
  {
    for (const auto &[name, shape] : plane_shapes())
      check_moments<2>(*shape, 400, 5e-3, name);
    for (const auto &[name, shape] : space_shapes())
      check_moments<3>(*shape, 24, 4e-2, name);
  }

  TEST(Shapes, MomentsInClosedForm)
  {
    const auto ball = Ball<3>({1, 2, 3}, 2.).moments();
    EXPECT_NEAR(ball.volume, 32. / 3. * pi, 1e-12);
    EXPECT_NEAR(ball.second[2][2], 8. / 15. * pi * 16., 1e-12);              // 4/15 pi R^5
    EXPECT_NEAR(Ball<2>({1, 2}, 2.).moments().second[0][0], 4. * pi, 1e-12); // pi R^4/4
    const auto box = Box<3>({0, 0, 0}, {1, 2, 3}).moments();
    EXPECT_NEAR(box.second[1][1], 6. * 4. / 12., 1e-14);
    const auto whole = meshed(Box<3>({5, 5, 5}, {6, 7, 8}), 9.)->moments();
    EXPECT_NEAR(whole.volume, 6., 1e-13);
    EXPECT_LT(whole.centroid.distance({5.5, 6, 6.5}), 1e-13);
    EXPECT_LT((whole.second - box.second).norm(), 1e-12);
    const auto ell = bracket()->moments(); // 3 x 1 and 1 x 1
    EXPECT_NEAR(ell.volume, 4., 1e-14);
    EXPECT_LT(ell.centroid.distance({(3 * 1.5 + .5) / 4, (3 * .5 + 1.5) / 4}), 1e-14);
    EXPECT_NEAR(ell.second[0][0], 3 * 9. / 12 + 3 * .25 * .25 + 1. / 12 + .75 * .75, 1e-13);
    EXPECT_NEAR(ell.second[0][1], 3 * .25 * -.25 + -.75 * .75, 1e-13);
  }

  TEST(Shapes, FacetsCloseAndConverge)
  {
    const auto volume_within = [](const auto &facets) {
      constexpr int dim    = std::tuple_size<decltype(facets[0].corners)>::value;
      double        volume = 0.;
      for (const auto &facet : facets)
        volume += facet.centre() * facet.area_vector() / dim;
      return volume;
    };
    const auto check = [&](const auto &shape, const auto &name, const std::vector<double> &sizes) {
      double error = 0.;
      for (const double size : sizes)
        {
          const auto facets = shape.facets(size);
          auto       closed = facets[0].area_vector();
          closed            = 0;
          double longest    = 0.;
          for (const auto &facet : facets)
            {
              closed += facet.area_vector();
              longest           = std::max(longest, facet.corners[0].distance(facet.corners[1]));
              const auto middle = shape.nearest(facet.centre());
              EXPECT_GT(middle.normal * facet.area_vector() / facet.area_vector().norm(), 1. - size * size / .25)
                << name;
            }
          EXPECT_LT(closed.norm(), 1e-12) << name;
          EXPECT_LE(longest, size * (1 + 1e-12)) << name;
          EXPECT_GE(longest, .3 * size) << name;
          const double before = error;
          error               = std::abs(volume_within(facets) / shape.volume() - 1.);
          if (before > 0.) // not the first; of second order, or exact
            {
              EXPECT_LT(error, std::max(.3 * before, 1e-5)) << name;
            }
        }
      EXPECT_LT(error, 1e-2) << name;
    };
    for (const auto &[name, shape] : plane_shapes())
      check(*shape, name, {.1, .05, .025});
    for (const auto &[name, shape] : space_shapes())
      check(*shape, name, {.2, .1});
  }

  TEST(Shapes, GrazingPathsMeetTheSurface)
  {
    const auto square = make_polygon({{0, 0}, {4, 0}, {4, 1}, {0, 1}});
    for (const double slope : {1., 1e-3, 1e-6, 1e-9})
      {
        const dealii::Point<2> from(.5, 1. + slope), to(3.5, 1. - 2. * slope); // in at a third of the path
        const auto             s = first_meeting<2>(*square, from, to);
        ASSERT_TRUE(s.has_value()) << slope;
        EXPECT_NEAR(*s, 1. / 3., 1e-12 / slope + 1e-9) << slope;
        EXPECT_FALSE(first_meeting<2>(*square, from, {3.5, 1. + slope}).has_value()) << slope;
      }
    EXPECT_NEAR(*first_meeting<2>(*square, {1., 2.}, {1., 0.}), .5, 1e-12);
  }

  TEST(Shapes, PolygonsThatAreNone)
  {
    const auto message = [](const std::vector<dealii::Point<2>> &corners) {
      try
        {
          make_polygon(corners);
        }
      catch (const UserError &error)
        {
          return std::string(error.what());
        }
      return std::string();
    };
    EXPECT_EQ(message({{0, 0}, {1, 0}, {1, 1}}), "");
    EXPECT_EQ(message({{0, 0}, {1, 1}, {1, 0}}), "the corners must go round anticlockwise");
    EXPECT_EQ(message({{0, 0}, {1, 1}, {1, 0}, {0, 1}}),
              "edges 1-2 and 3-4 cross; a polygon's edges may meet at its corners only");
    EXPECT_EQ(message({{0, 0}, {1, 0}, {1, 0}, {0, 1}}), "corners 2-3 are at the same place; give one of them");
    EXPECT_EQ(message({{0, 0}, {2, 0}, {1, 0}, {0, 1}}),
              "edge 2-3 goes back along edge 1-2; a polygon's edges may meet at its corners only");
  }
} // namespace
