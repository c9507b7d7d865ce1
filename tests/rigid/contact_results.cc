// What is told of a contact: sums, the peak, and the half width from the fall of the pressure to its edges.

#include <stroma/rigid/contact_results.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace
{
  using namespace Stroma;

  /// Of the pressure sqrt(1 - (x - 3)^2) (Hertz), at places .1 apart, of which each rank has its share.
  std::map<std::string, double>
  hertz()
  {
    const int                rank = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
    const int                n    = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
    Rigid::ContactResults<2> told;
    for (int i = 0; i < 20; ++i)
      if (i % n == rank)
        {
          const double x = -.96 + .1 * i, p = std::sqrt(1. - x * x);
          told.force[1] += .1 * p;
          told.area += .1;
          told.profile.push_back({{3. + x, p}});
        }
    std::map<std::string, double> named;
    for (const auto &[name, value] : told.named("block", MPI_COMM_WORLD))
      named[name] = value;
    return named;
  }
} // namespace

TEST(ContactResults, MpiTheEdgesAreWhereThePressureIsZero)
{
  const auto told = hertz();
  EXPECT_EQ(told.size(), 5u);
  EXPECT_EQ(told.at("contact_force_block_x_N"), 0.);
  EXPECT_NEAR(told.at("contact_force_block_y_N"), dealii::numbers::PI / 2., 1e-2);
  EXPECT_NEAR(told.at("contact_pressure_max_block_Pa"), 1., 1e-2);
  EXPECT_NEAR(told.at("contact_area_block_m2"), 2., 1e-12);
  EXPECT_NEAR(told.at("contact_half_width_block_m"), 1., 1e-2); // the outermost places are .95 from the middle
}

TEST(ContactResults, MpiOnePlaceHasNoWidth)
{
  Rigid::ContactResults<2> told;
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    told.profile.push_back({{0., 2.}});
  for (const auto &[name, value] : told.named("block", MPI_COMM_WORLD))
    EXPECT_EQ(value, name == "contact_pressure_max_block_Pa" ? 2. : 0.) << name;
}
