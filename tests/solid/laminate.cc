// Composite cells: equal tractions on both sides at any angle and contrast, the least energy, and the normal that is found.

#include <stroma/materials/neo_hookean.h>
#include <stroma/solid/laminate.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace
{
  using namespace Stroma;
  using Solid::Interface;
  using Solid::Laminate;
  using Solid::Moments;

  /// Points of two materials in a cell, 4 of each, with random volumes and the same deformation gradient.
  template <int dim>
  struct TwoSides
  {
    explicit TwoSides(const double contrast)
      : soft(Materials::ElasticConstants{1., 2.})
      , stiff(Materials::ElasticConstants{contrast, 2. * contrast})
      , block({&soft, &stiff})
    {
      block.resize(8);
      block.runs = {{0, 0, 4}, {1, 4, 8}};
      double side[2]{};
      for (unsigned int p = 0; p < 8; ++p)
        {
          V.push_back(.1 + uniform());
          side[p / 4] += V.back();
        }
      for (unsigned int d = 0; d < dim; ++d)
        interface.normal[d] = uniform() - .5;
      interface.normal /= interface.normal.norm();
      const double theta = side[1] / (side[0] + side[1]);
      interface.side     = {theta, theta - 1.};
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int k = 0; k < 3; ++k)
          mean[i][k] = (i == k) + (i < dim && k < dim ? .6 * (uniform() - .5) : 0.);
      set(mean);
    }

    void
    set(const dealii::Tensor<2, 3> &F)
    {
      for (auto &of_point : block.F)
        of_point = F;
    }

    double
    uniform()
    {
      return random() / 4294967296.;
    }

    /// P N of point @p p, in the directions of the scene.
    dealii::Tensor<1, dim>
    traction(const unsigned int p) const
    {
      const dealii::Tensor<2, 3> P = dealii::Tensor<2, 3>(block.tau[p]) * transpose(invert(block.F[p]));
      dealii::Tensor<1, dim>     t;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int k = 0; k < dim; ++k)
          t[i] += P[i][k] * interface.normal[k];
      return t;
    }

    double
    energy(const dealii::Tensor<1, dim> &a)
    {
      double sum = 0;
      set(mean);
      for (const auto &run : block.runs)
        for (unsigned int p = run.begin; p < run.end; ++p)
          Laminate<dim>::add_jump(block.F[p], interface.side[run.material], a, interface.normal);
      block.evaluate(Materials::energy);
      for (unsigned int p = 0; p < 8; ++p)
        sum += V[p] * block.psi[p];
      return sum;
    }

    std::mt19937             random{11};
    Materials::NeoHookean    soft, stiff;
    Materials::MaterialBlock block;
    std::vector<double>      V;
    Interface<dim>           interface;
    dealii::Tensor<2, 3>     mean;
  };

  template <int dim>
  void
  check_tractions(const double contrast)
  {
    TwoSides<dim> sides(contrast);
    Laminate<dim> laminate;
    ASSERT_EQ(laminate.solve(sides.interface, sides.V, sides.block), StepStatus::ok) << contrast;
    EXPECT_LT((sides.traction(0) - sides.traction(4)).norm(), 1e-12 * sides.traction(0).norm() * std::sqrt(contrast));
    dealii::Tensor<2, 3> sum;
    double               volume = 0;
    for (unsigned int p = 0; p < 8; ++p)
      {
        sum += sides.V[p] * sides.block.F[p];
        volume += sides.V[p];
      }
    EXPECT_LT((sum / volume - sides.mean).norm(), 1e-14);

    const auto   a     = laminate.jump();
    const double least = sides.energy(a);
    for (unsigned int d = 0; d < dim; ++d)
      for (const double sign : {-1., 1.})
        {
          auto other = a;
          other[d] += sign * 1e-3;
          EXPECT_GT(sides.energy(other), least);
        }
  }

  TEST(Laminate, TractionsOfBothSidesAgreeAtAnyContrast)
  {
    for (const double contrast : {1., 10., 1e3, 1e6})
      {
        check_tractions<2>(contrast);
        check_tractions<3>(contrast);
      }
  }

  TEST(Laminate, HasNoJumpWhereMaterialsAreTheSame)
  {
    TwoSides<3> sides(1.);
    Laminate<3> laminate;
    ASSERT_EQ(laminate.solve(sides.interface, sides.V, sides.block), StepStatus::ok);
    EXPECT_LT(laminate.jump().norm(), 1e-14);
  }

  /// Moments of the points of a fine lattice in a cell of 2 x 1 m about its centre, by the material that @p at tells.
  template <typename At>
  std::vector<Moments<2>>
  moments_of(const At &at)
  {
    std::vector<Moments<2>> moments(3);
    for (unsigned int i = 0; i < 40; ++i)
      for (unsigned int k = 0; k < 40; ++k)
        {
          const dealii::Point<2> x(2. * ((i + .5) / 40 - .5), (k + .5) / 40 - .5);
          moments[at(x)].add(1., x);
        }
    return moments;
  }

  TEST(FindInterface, TakesTheDirectionBetweenCentroidsOrOfSpread)
  {
    const Materials::NeoHookean soft(Materials::ElasticConstants{1., 2.}), stiff(Materials::ElasticConstants{10., 20.});
    const std::vector<const Materials::Material *> laws = {&soft, &stiff, &stiff};
    const dealii::Tensor<1, 2>                     size({2., 1.});

    const auto upright = Solid::find_interface<2>(moments_of([](const auto &x) { return x[0] > .5; }), laws, size);
    ASSERT_TRUE(upright);
    EXPECT_NEAR(upright->normal[0], 1., 1e-12);
    EXPECT_NEAR(upright->side[0], .25, 1e-12);
    EXPECT_NEAR(upright->side[1], -.75, 1e-12);

    const auto layer = Solid::find_interface<2>(moments_of([](const auto &x) { return std::abs(x[1]) < .1; }), laws,
                                                size);
    EXPECT_NEAR(std::abs(layer->normal[1]), 1., 1e-12);

    // The third material has the stiffness of the second, and is on its side.
    const auto three = Solid::find_interface<2>(moments_of([](const auto &x) {
                                                  return x[0] > .8 ? 2 : x[0] > .5 ? 1 : 0;
                                                }),
                                                laws, size);
    EXPECT_DOUBLE_EQ(three->side[1], three->side[2]);
    EXPECT_FALSE(Solid::find_interface<2>(moments_of([](const auto &) { return 1; }), laws, size));
  }
} // namespace
