#include <stroma/grid/lattice_multigrid.h>

#include <algorithm>

namespace Stroma
{
  namespace
  {
    /// Unknowns that a dense factor is worth.
    constexpr unsigned int few_unknowns = 900;
    /// Sides of cells over the shortest one up to which they are joined.
    constexpr double short_side = 1.5;
    /// Polynomial of the smoother, and the part of the spectrum that it damps: the upper (1 - 1 / range).
    constexpr unsigned int smoother_degree = 3;
    constexpr double       smoothing_range = 15.;
    /// Of conjugate gradients that find the largest eigenvalue. With 8 it came out too small at a contrast of 100 on 256 x 256 cells, where
    /// solves took 15 to 20 iterations for 11 to 18.
    constexpr unsigned int eigenvalue_iterations = 12;
    /// How many times smaller than the finest grid the next one must be to have two cycles: else, joined along one axis only,
    /// they would cost as much as the finest.
    constexpr unsigned int times_smaller = 3;
    /// What is added to the coarsest diagonal, over it: what nothing holds stays regular.
    constexpr double regular = 1e-6;
  } // namespace

  template <int dim>
  LatticeMultigrid<dim>::LatticeMultigrid(LatticeLevel<dim> &finest, const GridBox<dim> &box, const MPI_Comm comm)
    : comm(comm)
  {
    levels.push_back(std::make_unique<Level>());
    levels.back()->grid  = &finest;
    GridBox<dim>  coarse = box;
    std::uint64_t n_box  = 1;
    for (const unsigned int n : box.n_cells)
      n_box *= n;
    is_full = finest.n_cells() == n_box;
    while (levels.back()->grid->m() > few_unknowns &&
           std::any_of(coarse.n_cells.begin(), coarse.n_cells.end(), [](const unsigned int n) { return n > 1; }))
      add_coarser(coarse);
    for (auto &level : levels)
      {
        level->x = level->grid->template new_vector<float>();
        level->b = level->x;
        level->r = level->x;
      }
  }

  /// @param box of a grid; becomes that of the next coarser one
  template <int dim>
  void
  LatticeMultigrid<dim>::join_cells(GridBox<dim> &box)
  {
    const auto n_cells  = box.n_cells;
    double     shortest = std::numeric_limits<double>::max();
    for (unsigned int d = 0; d < dim; ++d)
      if (n_cells[d] > 1)
        shortest = std::min(shortest, box.cell_size[d]);
    for (unsigned int d = 0; d < dim; ++d)
      if (n_cells[d] > 1 && box.cell_size[d] <= short_side * shortest)
        {
          box.n_cells[d] = (n_cells[d] + 1) / 2;
          box.cell_size[d] *= 2.;
        }
  }

  template <int dim>
  double
  LatticeMultigrid<dim>::n_coarser_cells(GridBox<dim> box)
  {
    double n = 0.;
    while (std::any_of(box.n_cells.begin(), box.n_cells.end(), [](const unsigned int cells) { return cells > 1; }))
      {
        join_cells(box);
        double product = 1.;
        for (const unsigned int cells : box.n_cells)
          product *= cells;
        n += product;
      }
    return n;
  }

  /// @param box of the coarsest grid so far; becomes that of the next
  template <int dim>
  void
  LatticeMultigrid<dim>::add_coarser(GridBox<dim> &box)
  {
    LatticeLevel<dim> &fine    = *levels.back()->grid;
    const auto         n_cells = box.n_cells;
    join_cells(box);
    const bool splits  = !is_full && std::any_of(box.n_cells.begin(), box.n_cells.end(), [](const unsigned int n) {
      return n > 2;
    }); // so that the coarsest is small
    auto       level   = std::make_unique<Level>();
    const auto parents = fine.place_in_parents(n_cells, box.n_cells, splits);
    level->shape       = shape_functions<dim>().front().make(box);
    level->nodes       = std::make_unique<NodeLattice<dim>>(*level->shape, comm);
    level->nodes->distribute(parents.cells, parents.copies);
    level->own_grid = std::make_unique<LatticeLevel<dim>>(*level->nodes, parents.cells, comm, parents.kinds);
    fine.follow(*level->own_grid);
    level->grid = level->own_grid.get();
    fine.hold_coarser(*level->grid);
    levels.push_back(std::move(level));
  }

  template <int dim>
  void
  LatticeMultigrid<dim>::set_up()
  {
    for (std::size_t l = 0; l + 1 < levels.size(); ++l)
      {
        levels[l]->grid->coarsen(*levels[l + 1]->grid);
        choose_smoother(*levels[l]);
      }
    set_up_coarsest();
  }

  template <int dim>
  void
  LatticeMultigrid<dim>::release()
  {
    for (auto &level : levels)
      {
        level->grid->release_weights();
        if (level->own_grid)
          level->own_grid->matrices.release();
      }
  }

  template <int dim>
  void
  LatticeMultigrid<dim>::choose_smoother(Level &level)
  {
    const auto blocks = std::make_shared<BlockDiagonal<dim>>(*level.grid);
    if (dealii::Utilities::MPI::logical_or(blocks->has_blocks(), level.b.get_mpi_communicator()))
      set_up_smoother(level, blocks);
    else
      set_up_smoother(level, std::make_shared<dealii::DiagonalMatrix<Values>>(blocks->without_blocks()));
  }

  template <int dim>
  template <typename Diagonal>
  void
  LatticeMultigrid<dim>::set_up_smoother(Level &level, const std::shared_ptr<Diagonal> &inverse)
  {
    auto                                        &smoother = level.smoother.template emplace<Chebyshev<Diagonal>>();
    typename Chebyshev<Diagonal>::AdditionalData data(smoother_degree, smoothing_range, eigenvalue_iterations);
    data.preconditioner = inverse;
    smoother.initialize(*level.grid, data);
    smoother.estimate_eigenvalues(level.b);
  }

  /// Summed up on all ranks, which factor it alike.
  template <int dim>
  void
  LatticeMultigrid<dim>::set_up_coarsest()
  {
    const LatticeLevel<dim>   &grid     = *levels.back()->grid;
    const auto                &matrices = grid.matrices;
    const unsigned int         n        = grid.m();
    std::vector<double>        values(std::size_t(n) * n), held(n);
    dealii::FullMatrix<double> K_cell;
    const auto                 row = [&](const unsigned int local) { return grid.partition->local_to_global(local); };
    for (std::size_t k = 0; k < matrices.n_cells(); ++k)
      {
        matrices.get(k, K_cell);
        for (unsigned int i = 0; i < matrices.n_rows; ++i)
          for (unsigned int j = 0; j < matrices.n_rows; ++j)
            values[row(matrices.first(k, i / dim) + i % dim) * n + row(matrices.first(k, j / dim) + j % dim)] += K_cell(
              i, j);
      }
    for (const auto &[place, k] : grid.springs)
      values[row(place) * std::size_t(n + 1)] += k;
    for (const unsigned int place : grid.held)
      held[row(place)] = 1.;
    dealii::Utilities::MPI::sum(values, comm, values);
    dealii::Utilities::MPI::sum(held, comm, held);
    coarsest.reinit(n, n);
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j)
        coarsest(i, j) = held[i] + held[j] > 0. ? (i == j ? 1. : 0.) : (i == j ? 1. + regular : 1.) * values[i * n + j];
    coarsest.compute_lu_factorization(); // that of a body that buckles is not definite
  }

  template <int dim>
  void
  LatticeMultigrid<dim>::solve_coarsest() const
  {
    const Level           &level = *levels.back();
    const auto             first = level.grid->partition->local_range().first;
    dealii::Vector<double> all(level.grid->m());
    for (unsigned int i = 0; i < level.b.locally_owned_size(); ++i)
      all[first + i] = level.b.local_element(i);
    dealii::Utilities::MPI::sum(all, comm, all);
    coarsest.solve(all);
    for (unsigned int i = 0; i < level.b.locally_owned_size(); ++i)
      level.x.local_element(i) = static_cast<float>(all[first + i]);
  }

  /// Brings x nearer to K^-1 b on grid @p l, from what it is or @p from_zero.
  template <int dim>
  void
  LatticeMultigrid<dim>::cycle(const unsigned int l, const bool from_zero) const
  {
    if (l + 1 == levels.size())
      {
        solve_coarsest();
        return;
      }
    const Level &level = *levels[l], &coarse = *levels[l + 1];
    const auto   smooth = [&](const bool zero) {
      std::visit([&](
                   const auto &smoother) { zero ? smoother.vmult(level.x, level.b) : smoother.step(level.x, level.b); },
                 level.smoother);
    };
    smooth(from_zero);
    level.grid->vmult(level.r, level.x);
    level.r.sadd(-1.f, 1.f, level.b);
    level.grid->restrict_to(*coarse.grid, coarse.b, level.r);
    cycle(l + 1, true);
    const bool is_exact = l + 2 == levels.size(), is_small = coarse.grid->m() * times_smaller < level.grid->m();
    if (!is_exact && (l > 0 || is_small))
      cycle(l + 1, false);
    level.grid->add_prolonged(*coarse.grid, level.x, coarse.x);
    smooth(false);
  }

  template <int dim>
  void
  LatticeMultigrid<dim>::apply()
  {
    levels.front()->grid->set_held_to_zero(right_side());
    cycle(0, true);
  }

  template class LatticeMultigrid<2>;
  template class LatticeMultigrid<3>;
} // namespace Stroma
