// A grid of unassembled stiffness and the next coarser one, with cells missing and stiffness that differs from cell to cell.

#include <stroma/grid/lattice_level.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace Stroma;

namespace
{
  /// Of springs between all nodes, along random directions.
  template <int dim>
  dealii::FullMatrix<double>
  springs(const double k, unsigned int seed)
  {
    constexpr unsigned int     n = CellMatrices<dim>::n_nodes;
    dealii::FullMatrix<double> K(dim * n, dim * n);
    for (unsigned int a = 0; a < n; ++a)
      for (unsigned int b = a + 1; b < n; ++b)
        {
          dealii::Tensor<1, dim> along;
          for (unsigned int i = 0; i < dim; ++i)
            along[i] = std::sin(++seed);
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int j = 0; j < dim; ++j)
              {
                const double k_ij = k * (along[i] * along[j] + (i == j ? .1 : 0.));
                for (const unsigned int c : {a, b})
                  {
                    K(c * dim + i, c * dim + j) += k_ij;
                    K(c * dim + i, (a + b - c) * dim + j) -= k_ij;
                  }
              }
        }
    return K;
  }

  /// Stiffness from .01 to 1; every fifth cell or so is missing. Or, of two kinds of cells, none. Cells are dealt out to ranks in
  /// turns of three.
  template <int dim>
  struct TwoGrids
  {
    using Index  = typename LatticeLevel<dim>::Index;
    using Values = typename LatticeLevel<dim>::template Values<float>;

    static GridBox<dim>
    box(const unsigned int n)
    {
      GridBox<dim> box;
      for (unsigned int d = 0; d < dim; ++d)
        {
          box.n_cells[d]   = n;
          box.cell_size[d] = 12. / n;
        }
      return box;
    }

    explicit TwoGrids(const bool has_kinds = false)
      : shape(shape_functions<dim>().front().make(box(12)))
      , shape_coarse(shape_functions<dim>().front().make(box(6)))
      , nodes(*shape, MPI_COMM_WORLD)
      , nodes_coarse(*shape_coarse, MPI_COMM_WORLD)
    {
      std::vector<Index>        cells;
      std::vector<unsigned int> number, kinds;
      const unsigned int        all = static_cast<unsigned int>(std::pow(12, dim) + .5),
                         ranks      = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD),
                         me         = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
      for (unsigned int i = 0; i < all; ++i)
        if ((has_kinds || std::sin(3. * i * i) < .6) && i / 3 % ranks == me)
          {
            Index index;
            for (unsigned int d = 0, rest = i; d < dim; ++d, rest /= 12)
              index[d] = rest % 12;
            cells.push_back(index);
            number.push_back(i);
            if (has_kinds)
              kinds.push_back(index[0] < 5 ? 0 : 1);
          }
      nodes.distribute(cells);
      fine = std::make_unique<LatticeLevel<dim>>(nodes, cells, MPI_COMM_WORLD, kinds);
      fine->matrices.allocate();
      for (const unsigned int kind : {0u, 1u})
        if (std::count(kinds.begin(), kinds.end(), kind) > 0) // else this rank has none of it
          fine->set_kind(kind, springs<dim>(1. + kind, kind));
      for (std::size_t k = 0; k < cells.size() && !has_kinds; ++k)
        fine->set(k, springs<dim>(std::pow(10., -1. - std::sin(7. * number[k])), number[k]));
      const auto parents = fine->place_in_parents(box(12).n_cells, box(6).n_cells, true);
      nodes_coarse.distribute(parents.cells, parents.copies);
      coarse = std::make_unique<LatticeLevel<dim>>(nodes_coarse, parents.cells, MPI_COMM_WORLD, parents.kinds);
      fine->follow(*coarse);
      fine->coarsen(*coarse);
    }

    std::unique_ptr<ShapeFunctions<dim>> shape, shape_coarse;
    NodeLattice<dim>                     nodes, nodes_coarse;
    std::unique_ptr<LatticeLevel<dim>>   fine, coarse;
  };

  /// That of the coarse grid is P^T K P, with the P that moves residuals and corrections.
  template <int dim>
  void
  check_coarse_matrices(const bool has_kinds = false)
  {
    TwoGrids<dim> grids(has_kinds);
    auto          x = grids.coarse->template new_vector<float>(), y = x, PKP = x;
    auto          Px = grids.fine->template new_vector<float>(), KPx = Px;
    for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
      x.local_element(i) = std::sin(5. * (i + x.locally_owned_elements().nth_index_in_set(0)));
    grids.fine->add_prolonged(*grids.coarse, Px, x);
    grids.fine->vmult(KPx, Px);
    grids.fine->restrict_to(*grids.coarse, PKP, KPx);
    grids.coarse->vmult(y, x);
    const double size = y.linfty_norm();
    y -= PKP;
    EXPECT_GT(size, .1);
    EXPECT_LT(y.linfty_norm(), 2e-6 * size);
  }

  TEST(MpiLatticeLevel, CoarseMatricesAreThoseOfItsFunctions)
  {
    check_coarse_matrices<2>();
    check_coarse_matrices<3>();
  }

  TEST(MpiLatticeLevel, CoarseCellsShareWhereTheirChildrenDo)
  {
    check_coarse_matrices<2>(true);
    check_coarse_matrices<3>(true);
    if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1)
      {
        EXPECT_EQ(TwoGrids<2>(true).coarse->matrices.n_sharing(), 8u + 16u); // of 12 and 18, and 6 that hold both kinds
        EXPECT_EQ(TwoGrids<3>(true).coarse->matrices.n_sharing(), 72u + 104u);
      }
  }

  /// Translations of the coarse grid are translations; and there are more nodes than those of the lattice.
  TEST(MpiLatticeLevel, CoarseFunctionsAddUpToOne)
  {
    TwoGrids<3> grids;
    auto        x  = grids.coarse->new_vector<float>();
    auto        Px = grids.fine->new_vector<float>();
    x              = 1.f;
    grids.fine->add_prolonged(*grids.coarse, Px, x);
    for (const float value : Px)
      EXPECT_NEAR(value, 1., 1e-6);
    TwoGrids<2> plane;
    EXPECT_GT(plane.coarse->m(), 2u * 7 * 7);
  }

  /// What is split does not depend on how cells are dealt out.
  TEST(MpiLatticeLevel, AnyRanksFindTheSameCopies)
  {
    EXPECT_EQ(TwoGrids<2>().coarse->m(), 110u);
    EXPECT_EQ(TwoGrids<3>().coarse->m(), 1029u);
  }
} // namespace
