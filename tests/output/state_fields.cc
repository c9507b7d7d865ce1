#include <stroma/output/state_fields.h>

#include <gtest/gtest.h>

#include <cmath>

using namespace Stroma::Output;

namespace
{
  /// Stretched by 2, 1 and .5 along axes that then turn by 30 degrees about z, under 6 Pa along the first.
  PointState
  stretched_and_turned()
  {
    const double         c = std::cos(dealii::numbers::PI / 6.), s = .5;
    PointState           state;
    dealii::Tensor<2, 3> F;
    F[0][0] = 2. * c, F[0][1] = -s, F[1][0] = 2. * s, F[1][1] = c, F[2][2] = .5;
    state.u_gradient = F;
    state.u_gradient[0][0] -= 1., state.u_gradient[1][1] -= 1., state.u_gradient[2][2] -= 1.;
    state.cauchy[0][0] = 6. * c * c, state.cauchy[0][1] = 6. * c * s, state.cauchy[1][1] = 6. * s * s;
    return state;
  }

  std::vector<double>
  values_of(const std::string &field, const PointState &state, const unsigned int dim)
  {
    const StateFields   fields(dim, {field});
    std::vector<double> values(fields.width());
    fields.fill(state, values.data());
    return values;
  }

  void
  expect_near(const std::vector<double> &a, const std::vector<double> &b)
  {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
      EXPECT_NEAR(a[i], b[i], 1e-12) << i;
  }
} // namespace

TEST(StateFields, StrainsAreThoseOfTheDeformationGradient)
{
  const auto state = stretched_and_turned();
  expect_near(values_of("principal_stretch", state, 3), {2., 1., .5});
  expect_near(values_of("green_lagrange_strain", state, 3), {1.5, 0., -.375, 0., 0., 0.}); // blind to the turn
  const double c = std::cos(dealii::numbers::PI / 6.), s = .5;
  expect_near(values_of("almansi_strain", state, 3), {.375 * c * c, .375 * s * s, -1.5, .375 * c * s, 0., 0.});
}

TEST(StateFields, NominalStressIsForceOverTheAreaAtRest)
{
  const double c = std::cos(dealii::numbers::PI / 6.), s = .5;
  // The area across the first axis has become half as large: 3 Pa along what is now that axis.
  expect_near(values_of("first_piola_stress", stretched_and_turned(), 3), {3. * c, 0., 0., 3. * s, 0., 0., 0., 0., 0.});
  expect_near(values_of("principal_stress", stretched_and_turned(), 3), {6., 0., 0.});
}

TEST(StateFields, PlaneScenesKnowTheirStretchAcross)
{
  auto state             = stretched_and_turned();
  state.u_gradient[2][2] = 0.;
  expect_near(values_of("principal_stretch", state, 2), {2., 1., 1.}); // plane strain
  state.stretch_z = .5;
  expect_near(values_of("principal_stretch", state, 2), {2., 1., .5}); // plane stress
}

TEST(StateFields, EachNumberHasAName)
{
  const StateFields fields(2, {"displacement", "first_piola_stress", "principal_stretch", "von_mises"});
  const auto        numbers = fields.numbers();
  ASSERT_EQ(numbers.size(), fields.width());
  EXPECT_EQ(numbers[1].name(), "displacement_y_m");
  EXPECT_EQ(numbers[3].name(), "first_piola_stress_xy_Pa");
  EXPECT_EQ(numbers[11].name("mean_vessel"), "principal_stretch_1_mean_vessel");
  EXPECT_EQ(numbers[14].name("p50_vessel"), "von_mises_p50_vessel_Pa");
}
