// What all shape functions of the table have in common.

#include <stroma/grid/shape_functions.h>

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
  GridBox<3>
  box(const std::array<unsigned int, 3> &n_cells)
  {
    GridBox<3> box;
    box.lower     = dealii::Point<3>(1., -2., .5);
    box.cell_size = dealii::Tensor<1, 3>({.5, 2., 1.});
    box.n_cells   = n_cells;
    return box;
  }

  /// Calls visit(functions, cell, place in it, place) at some places of all cells of grids, some of which have one cell.
  template <typename Visit>
  void
  for_places(const Visit &visit)
  {
    for (const auto &entry : shape_functions<3>())
      for (const auto &grid : {box({{4, 3, 2}}), box({{1, 2, 5}})})
        {
          const auto functions = entry.make(grid);
          for (unsigned int c = 0; c < grid.n_cells[0] * grid.n_cells[1] * grid.n_cells[2]; ++c)
            for (const dealii::Point<3> &xi : {dealii::Point<3>(.2, .7, .4), dealii::Point<3>(0., 1., .9)})
              {
                const std::array<unsigned int, 3> cell{{c % grid.n_cells[0], c / grid.n_cells[0] % grid.n_cells[1],
                                                        c / (grid.n_cells[0] * grid.n_cells[1])}};
                dealii::Point<3>                  X = grid.lower;
                for (unsigned int d = 0; d < 3; ++d)
                  X[d] += (cell[d] + xi[d]) * grid.cell_size[d];
                visit(*functions, cell, xi, X);
              }
        }
  }

  TEST(ShapeFunctions, ReproduceLinearFieldsWithTheirValuesAtTheNodes)
  {
    for_places([](const auto &functions, const auto &cell, const auto &xi, const auto &X) {
      const auto       at  = functions.at(cell, xi);
      double           one = 0;
      dealii::Point<3> place;
      for (unsigned int a = 0; a < functions.n_nodes(); ++a)
        {
          one += at.value[a];
          place += at.value[a] * functions.place(functions.node_index(cell, a));
        }
      EXPECT_NEAR(one, 1., 1e-14);
      EXPECT_LT(place.distance(X), 1e-14);
    });
  }

  TEST(ShapeFunctions, TakeTheirCoefficientsFromSamples)
  {
    for_places([](const auto &functions, const auto &cell, const auto &xi, const auto &X) {
      const bool is_linear = functions.interpolates();
      const auto field = [&](const dealii::Point<3> &x) { return is_linear ? x[0] * x[2] : x[0] * x[0] * x[1] * x[1]; };
      const auto at    = functions.at(cell, xi);
      double     sum   = 0;
      for (unsigned int a = 0; a < functions.n_nodes(); ++a)
        for (const auto &sample : functions.samples(functions.node_index(cell, a)))
          sum += at.value[a] * sample.weight * field(sample.X);
      EXPECT_NEAR(sum, field(X), 1e-12);
    });
  }

  TEST(ShapeFunctions, HaveTheGradientsOfTheirValues)
  {
    for_places([](const auto &functions, const auto &cell, const auto &xi, const auto &X) {
      const auto at = functions.at(cell, xi);
      for (unsigned int d = 0; d < 3; ++d)
        {
          dealii::Point<3> before = xi, after = xi, next = X;
          before[d] -= 1e-6;
          after[d] += 1e-6;
          next[d] += 1.;
          const auto   low = functions.at(cell, before), high = functions.at(cell, after);
          const double h = box({{1, 1, 1}}).cell_size[d];
          for (unsigned int a = 0; a < functions.n_nodes(); ++a)
            EXPECT_NEAR(at.gradient[d][a], (high.value[a] - low.value[a]) / (2e-6 * h), 1e-8);
        }
    });
  }

  /// Values of all functions along x at the end of a cell, by their nodes.
  std::map<unsigned int, std::pair<double, double>>
  at_end(const ShapeFunctions<3> &functions, const unsigned int cell, const double xi)
  {
    std::map<unsigned int, std::pair<double, double>> result; // value and slope
    const auto                                        at = functions.at({{cell, 1, 1}}, dealii::Point<3>(xi, .3, .6));
    for (unsigned int a = 0; a < functions.n_nodes(); ++a)
      {
        auto &[value, slope] = result[functions.node_index({{cell, 1, 1}}, a)[0]];
        value += at.value[a];
        slope += at.gradient[0][a];
      }
    return result;
  }

  TEST(ShapeFunctions, OfBSplinesHaveContinuousGradientsAndEndFunctions)
  {
    const auto functions = shape_functions<3>()[1].make(box({{4, 3, 3}}));
    ASSERT_EQ(shape_functions<3>()[1].name, "quadratic B-spline");
    for (unsigned int cell = 0; cell < 3; ++cell)
      {
        auto low = at_end(*functions, cell, 1.), high = at_end(*functions, cell + 1, 0.);
        for (unsigned int node = 0; node < 6; ++node)
          {
            EXPECT_NEAR(low[node].first, high[node].first, 1e-15);
            EXPECT_NEAR(low[node].second, high[node].second, 1e-14);
          }
      }
    EXPECT_NEAR(at_end(*functions, 0, 0.)[0].first, 1., 1e-15);
    EXPECT_NEAR(at_end(*functions, 3, 1.)[5].first, 1., 1e-15);
    EXPECT_EQ(at_end(*functions, 0, 0.)[1].first, 0.);
  }
} // namespace
