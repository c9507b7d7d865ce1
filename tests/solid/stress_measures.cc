#include <stroma/solid/stress_measures.h>

#include <gtest/gtest.h>

TEST(StressMeasures, AreThoseOfTextbooks)
{
  using namespace Stroma::Solid;
  dealii::SymmetricTensor<2, 3> tension, shear;
  tension[0][0] = -3.;
  shear[0][1]   = 2.;
  EXPECT_NEAR(von_mises(tension), 3., 1e-15);
  EXPECT_NEAR(pressure(tension), 1., 1e-15);
  EXPECT_NEAR(von_mises(shear), 2. * std::sqrt(3.), 1e-15);
  EXPECT_EQ(pressure(shear), 0.);
  const auto hydrostatic = -5. * dealii::unit_symmetric_tensor<3>();
  EXPECT_EQ(von_mises(hydrostatic), 0.);
  EXPECT_NEAR(pressure(hydrostatic), 5., 1e-15);
  EXPECT_NEAR(von_mises(shear + hydrostatic), von_mises(shear), 1e-14);
}
