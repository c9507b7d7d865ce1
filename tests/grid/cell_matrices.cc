// Matrices of cells in single precision against dense ones.

#include "../base/keep_largest.h"

#include <stroma/grid/cell_matrices.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace
{
  using namespace Stroma;

  /// A symmetric matrix of random numbers whose rows add up to zero over the nodes.
  template <int dim>
  dealii::FullMatrix<double>
  random_matrix(std::mt19937 &random)
  {
    constexpr unsigned int     n = CellMatrices<dim>::n_nodes, rows = CellMatrices<dim>::n_rows;
    dealii::FullMatrix<double> K(rows, rows);
    for (unsigned int term = 0; term < rows; ++term)
      {
        std::vector<double> v(rows);
        for (double &value : v)
          value = random() / 4294967295. - .5;
        for (unsigned int i = 0; i < dim; ++i)
          {
            double sum = 0.;
            for (unsigned int a = 0; a < n; ++a)
              sum += v[a * dim + i];
            for (unsigned int a = 0; a < n; ++a)
              v[a * dim + i] -= sum / n;
          }
        for (unsigned int i = 0; i < rows; ++i)
          for (unsigned int j = 0; j < rows; ++j)
            K(i, j) += v[i] * v[j] / rows;
      }
    return K;
  }

  template <int dim>
  double
  difference(const dealii::FullMatrix<double> &A, const dealii::FullMatrix<double> &B)
  {
    double worst = 0.;
    for (unsigned int i = 0; i < A.m(); ++i)
      for (unsigned int j = 0; j < A.n(); ++j)
        keep_largest(worst, std::abs(A(i, j) - B(i, j)));
    return worst;
  }

  /// 11 cells, each with nodes of its own: one batch and a part of one.
  template <int dim>
  void
  check_products()
  {
    constexpr unsigned int n = CellMatrices<dim>::n_rows, n_cells = 11;
    std::mt19937           random(3);
    CellMatrices<dim>      matrices;
    std::vector<int>       first;
    for (unsigned int k = 0; k < n_cells * CellMatrices<dim>::n_nodes; ++k)
      first.push_back(k * dim);
    matrices.reinit(first);
    matrices.allocate();
    std::vector<double>                     x(n_cells * n), y(x.size(), 1.), d(x.size());
    std::vector<dealii::FullMatrix<double>> all;
    for (auto &value : x)
      value = random() / 4294967295.;
    for (unsigned int k = 0; k < n_cells; ++k)
      {
        all.push_back(random_matrix<dim>(random));
        matrices.set(k, all.back());
        dealii::FullMatrix<double> back;
        matrices.get(k, back);
        EXPECT_LT(difference<dim>(all.back(), back), 1e-6);
      }
    matrices.add_product(x.data(), y.data());
    matrices.add_diagonal(d.data());
    for (unsigned int k = 0; k < n_cells; ++k)
      for (unsigned int i = 0; i < n; ++i)
        {
          double sum = 1.;
          for (unsigned int j = 0; j < n; ++j)
            sum += all[k](i, j) * x[k * n + j];
          EXPECT_NEAR(y[k * n + i], sum, 2e-6);
          EXPECT_NEAR(d[k * n + i], all[k](i, i), 1e-6);
        }
  }

  TEST(CellMatrices, ActAsDenseOnes)
  {
    check_products<2>();
    check_products<3>();
  }

  /// A parent whose first child is its lower half along x and whole along the others, the second the upper half.
  template <int dim>
  void
  check_coarsening()
  {
    using Place              = PlaceInParent<dim>;
    constexpr unsigned int n = CellMatrices<dim>::n_nodes, rows = CellMatrices<dim>::n_rows;
    std::mt19937           random(5);
    CellMatrices<dim>      fine, coarse;
    std::vector<int>       first(n, 0);
    coarse.reinit(first);
    coarse.allocate();
    first.resize(2 * n, 0);
    fine.reinit(first);
    fine.allocate();
    std::vector<Place>         places(2);
    dealii::FullMatrix<double> expected(rows, rows), found;
    for (unsigned int k = 0; k < 2; ++k)
      {
        places[k].parent = 0;
        places[k].part.fill(Place::whole);
        places[k].part[0] = k == 0 ? Place::lower_half : Place::upper_half;
        if (dim == 3)
          places[k].part[1] = Place::upper_half;
        const auto K = random_matrix<dim>(random);
        fine.set(k, K);
        for (unsigned int i = 0; i < rows; ++i)
          for (unsigned int j = 0; j < rows; ++j)
            for (unsigned int p = 0; p < n; ++p)
              for (unsigned int q = 0; q < n; ++q)
                expected(p * dim + i % dim, q * dim + j % dim) += places[k].weight(i / dim, p) * K(i, j) *
                                                                  places[k].weight(j / dim, q);
      }
    coarse.add_coarsened(fine, places, std::vector<bool>(fine.n_cells(), false));
    coarse.get(0, found);
    EXPECT_LT(difference<dim>(expected, found), 4e-6);
    EXPECT_EQ(places[0].weight(1, 0), dim == 3 ? .25f : .5f);
  }

  TEST(CellMatrices, CoarsenAsLinearFunctionsSay)
  {
    check_coarsening<2>();
    check_coarsening<3>();
  }

  /// Of 19 cells the first eight share the second matrix, the next eight the first one.
  TEST(CellMatrices, AreSharedByEights)
  {
    constexpr unsigned int n = CellMatrices<2>::n_rows, n_cells = 19;
    std::mt19937           random(11);
    CellMatrices<2>        sharing, own, coarse_of_sharing, coarse_of_own;
    std::vector<int>       first;
    for (unsigned int k = 0; k < n_cells * CellMatrices<2>::n_nodes; ++k)
      first.push_back(2 * k);
    sharing.reinit(first, {1, 0});
    own.reinit(first);
    coarse_of_sharing.reinit({0, 2, 4, 6});
    coarse_of_own.reinit({0, 2, 4, 6});
    for (auto *matrices : {&sharing, &own, &coarse_of_sharing, &coarse_of_own})
      matrices->allocate();
    EXPECT_EQ(sharing.n_sharing(), 16u);
    const auto zero = random_matrix<2>(random), one = random_matrix<2>(random);
    sharing.set_shared(0, zero);
    sharing.set_shared(1, one);
    std::vector<PlaceInParent<2>> places(n_cells);
    for (unsigned int k = 0; k < n_cells; ++k)
      {
        const auto K = k < 8 ? one : k < 16 ? zero : random_matrix<2>(random);
        own.set(k, K);
        if (k >= 16)
          sharing.set(k, K);
        dealii::FullMatrix<double> back;
        sharing.get(k, back);
        EXPECT_LT(difference<2>(K, back), 1e-6);
        places[k].parent = 0;
        places[k].part   = {
            {k % 2 == 0 ? PlaceInParent<2>::lower_half : PlaceInParent<2>::upper_half, PlaceInParent<2>::whole}};
      }
    std::vector<double> x(n_cells * n), y_sharing(x.size()), y_own(x.size()), d_sharing(x.size()), d_own(x.size());
    for (auto &value : x)
      value = random() / 4294967295.;
    sharing.add_product(x.data(), y_sharing.data());
    own.add_product(x.data(), y_own.data());
    sharing.add_diagonal(d_sharing.data());
    own.add_diagonal(d_own.data());
    EXPECT_EQ(y_sharing, y_own);
    EXPECT_EQ(d_sharing, d_own);
    coarse_of_sharing.add_coarsened(sharing, places, std::vector<bool>(sharing.n_cells(), false));
    coarse_of_own.add_coarsened(own, places, std::vector<bool>(own.n_cells(), false));
    dealii::FullMatrix<double> a, b;
    coarse_of_sharing.get(0, a);
    coarse_of_own.get(0, b);
    EXPECT_EQ(difference<2>(a, b), 0.);
  }

  TEST(CellMatrices, NoTranslationMakesAForceWhateverIsRounded)
  {
    std::mt19937    random(9);
    CellMatrices<3> matrices;
    matrices.reinit(std::vector<int>({0, 3, 6, 9, 12, 15, 18, 21}));
    matrices.allocate();
    matrices.set(0, random_matrix<3>(random));
    std::vector<double> x(24), y(24);
    for (unsigned int i = 0; i < 24; ++i)
      x[i] = i % 3 + .1;
    matrices.add_product(x.data(), y.data());
    for (const double force : y)
      EXPECT_EQ(force, 0.);
  }
} // namespace
