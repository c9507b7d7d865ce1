#include <stroma/grid/rigid_motions.h>

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
  /// A scene whose box is [0, 2]^dim m.
  template <int dim>
  struct Case
  {
    explicit Case(const std::string &more = "")
      : file(ParameterFile::parse(
          "subsection Materials\n subsection gel\n  set Shear modulus = 1\n  set Bulk modulus = 2\n end\nend\n"
          "subsection Bodies\n subsection block\n  set Upper corner = " +
            std::string(dim == 2 ? "2, 2" : "2, 2, 2") + "\n end\nend\n" + more,
          "test.prm"))
      , parameters(file)
      , scene(parameters, MPI_COMM_WORLD)
    {}

    ParameterFile file;
    Parameters    parameters;
    Scene<dim>    scene;
  };

  template <int dim>
  void
  hold(RigidMotions<dim> &motions, const unsigned int piece, const dealii::Point<dim> &X)
  {
    for (unsigned int c = 0; c < dim; ++c)
      motions.hold(piece, X, c);
  }

  /// Displacement at @p X of piece @p i of a free group, in its first motion.
  template <int dim>
  dealii::Tensor<1, dim>
  displacement(const RigidMotions<dim> &motions, const typename RigidMotions<dim>::FreeGroup &group,
               const unsigned int i, const dealii::Point<dim> &X)
  {
    constexpr unsigned int n = RigidMotions<dim>::n_modes;
    dealii::Tensor<1, dim> u;
    for (unsigned int c = 0; c < dim; ++c)
      u[c] = motions.row(X, c).dot(group.motions.col(0).segment(n * i, n));
    return u;
  }
} // namespace

TEST(RigidMotions, RowsAreTranslationsAndTurnsAboutTheCentre)
{
  const Case<3>               s;
  RigidMotions<3>             motions(s.scene, 1);
  const double                t[3] = {.1, -.2, .3}, w[3] = {.4, .5, -.6};
  Eigen::Matrix<double, 6, 1> modes;
  modes << t[0], t[1], t[2], 2. * w[0], 2. * w[1], 2. * w[2]; // w times the scene's size
  const dealii::Point<3> X(1.7, .2, 1.1);
  const auto u = dealii::cross_product_3d(dealii::Tensor<1, 3>({w[0], w[1], w[2]}), X - dealii::Point<3>(1., 1., 1.));
  for (unsigned int c = 0; c < 3; ++c)
    EXPECT_NEAR(motions.row(X, c).dot(modes), t[c] + u[c], 1e-14);
}

TEST(RigidMotions, APieceOnAHingeTurnsAboutIt)
{
  const Case<2>          s;
  const dealii::Point<2> hinge(1., 2.);
  RigidMotions<2>        motions(s.scene, 2);
  hold(motions, 0, {0., 0.});
  hold(motions, 0, {2., 0.});
  for (unsigned int c = 0; c < 2; ++c)
    motions.join(0, 1, hinge, c);
  motions.gather();
  const auto groups = motions.free_groups();
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_EQ(groups[0].pieces, (std::vector<unsigned int>{1}));
  EXPECT_TRUE(groups[0].is_held);
  ASSERT_EQ(groups[0].motions.cols(), 1);
  EXPECT_LT(displacement(motions, groups[0], 0, hinge).norm(), 1e-12);
  const auto aside = displacement(motions, groups[0], 0, {2., 2.});
  EXPECT_LT(std::abs(aside[0]), 1e-12);
  EXPECT_GT(std::abs(aside[1]), .1);
  EXPECT_NO_THROW(motions.check_whole());
}

TEST(RigidMotions, TwoHeldPlacesInSpaceLeaveATurnAboutTheirLine)
{
  const Case<3>   s;
  RigidMotions<3> motions(s.scene, 1);
  hold(motions, 0, {0., 0., 0.});
  hold(motions, 0, {2., 2., 2.});
  motions.gather();
  const auto groups = motions.free_groups();
  ASSERT_EQ(groups.size(), 1u);
  ASSERT_EQ(groups[0].motions.cols(), 1);
  EXPECT_LT(displacement(motions, groups[0], 0, {1.5, 1.5, 1.5}).norm(), 1e-12);
  const auto aside = displacement(motions, groups[0], 0, {2., 0., 1.});
  EXPECT_GT(aside.norm(), .1);
  EXPECT_LT(std::abs(aside[0] + aside[1] + aside[2]), 1e-12); // across the line
  EXPECT_THROW(motions.check_whole(), UserError);

  hold(motions, 0, {2., 0., 0.});
  motions.gather();
  EXPECT_TRUE(motions.free_groups().empty());
  EXPECT_NO_THROW(motions.check_whole());
}

TEST(RigidMotions, APeriodHoldsTurnsAndNoTranslations)
{
  const Case<2>   s("subsection Periodic\n set Directions = x\nend\n");
  RigidMotions<2> motions(s.scene, 1);
  motions.hold_turns_across_periods(0);
  motions.gather();
  ASSERT_EQ(motions.free_groups().size(), 1u);
  EXPECT_EQ(motions.free_groups()[0].motions.cols(), 2);
  hold(motions, 0, {1., 1.});
  motions.gather();
  EXPECT_TRUE(motions.free_groups().empty());
}
