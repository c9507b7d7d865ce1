#include <stroma/base/parameters.h>
#include <stroma/solvers/linear_solver.h>
#include <stroma/solvers/on_all_ranks.h>

#include <deal.II/lac/diagonal_matrix.h>
#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/solver_gmres.h>

#include <Epetra_Vector.h>
#include <Teuchos_ParameterList.hpp>
#include <ml_MultiLevelPreconditioner.h>
#include <ml_utils.h>

#include <algorithm>
#include <cmath>

using namespace dealii;

namespace Stroma::Solvers
{
  namespace
  {
    /// Whether prolongations are smoothed. Measured: that pays in the plane; in space it would take three times the set-up and
    /// memory, and a W-cycle makes up for leaving it out. With one mode the space is not known: smoothing saves a third in the
    /// plane and costs a sixth in space.
    bool
    is_smoothed(const unsigned int n_modes)
    {
      return n_modes < 6;
    }

    /// What the factors of the coarsest grid add to the diagonal against pivots of 0, over the largest entry of the diagonal of K.
    constexpr double against_no_pivot = 1e-15;

    double
    largest_of_diagonal(const Matrix &K)
    {
      Epetra_Vector diagonal(K.trilinos_matrix().RowMap(), false);
      K.trilinos_matrix().ExtractDiagonalCopy(diagonal);
      double largest = 0.;
      diagonal.NormInf(&largest);
      return largest;
    }

    /// Vectors that GMRES may keep before it starts again; they are allocated as they are needed.
    constexpr unsigned int gmres_vectors = 200;

    /// Ends a solve, as not converged, that has lost more iterations than it may to the age of its preconditioner. Conjugate gradients are
    /// not even: an eighth of the iterations that a fresh one would still take may be made up for later.
    class AgeControl : public SolverControl
    {
    public:
      /// @param per_decade iterations by which a fresh one makes the residual a tenth @param may_lose more than these
      AgeControl(const unsigned int max_iterations, const double tolerance, const double per_decade,
                 const double may_lose)
        : SolverControl(max_iterations, tolerance, false, false)
        , per_decade(per_decade)
        , may_lose(may_lose)
      {}

      State
      check(const unsigned int step, const double residual) override
      {
        SolverControl::check(step, residual);
        const double done = per_decade * std::log10(initial_value() / residual),
                     left = per_decade * std::log10(residual / tolerance());
        if (lcheck == iterate && step > done + may_lose + left / 8.)
          lcheck = failure;
        return lcheck;
      }

    private:
      double per_decade, may_lose;
    };

    /// Solves the rows of K that hold only their diagonal, into x, and takes them out of b.
    void
    solve_decoupled_rows(const Matrix &K, Vector &x, Vector &b)
    {
      const Epetra_CrsMatrix &matrix = K.trilinos_matrix();
      Epetra_Vector           diagonal(matrix.RowMap(), false), inverse_sum(matrix.RowMap(), false);
      matrix.ExtractDiagonalCopy(diagonal);
      matrix.InvRowSums(inverse_sum); // 1 / sum_j |K_ij|
      double *const x_values = x.begin(), *const b_values = b.begin();
      for (int i = 0; i < diagonal.MyLength(); ++i)
        if (std::abs(diagonal[i]) * inverse_sum[i] > 1. - 1e-14)
          {
            x_values[i] = b_values[i] / diagonal[i];
            b_values[i] = 0.;
          }
        else
          x_values[i] = 0.;
    }

    /// A matrix as an operator.
    class MatrixOperator : public Operator
    {
    public:
      explicit MatrixOperator(const Matrix &K)
        : K(K)
      {}

      void
      vmult(Vector &y, const Vector &x) const override
      {
        K.vmult(y, x);
      }
      const Matrix &
      approximation() override
      {
        return K;
      }
      const void *
      identity() const override
      {
        return &K.trilinos_matrix();
      }

      void
      diagonal(Vector &d) const override
      {
        for (const auto i : d.locally_owned_elements())
          d[i] = K.diag_element(i);
        d.compress(VectorOperation::insert);
      }

      void
      solve_decoupled(Vector &x, Vector &b) const override
      {
        solve_decoupled_rows(K, x, b);
      }

    private:
      const Matrix &K;
    };

    /// An operator's own multigrid as a preconditioner.
    struct OwnMultigrid
    {
      void
      vmult(Vector &y, const Vector &x) const
      {
        A.apply_multigrid(y, x);
      }
      const Operator &A;
    };

    /// Multigrid of an operator's approximation, and the inverse of the block of the unknowns that it leaves out.
    class BorderedMultigrid
    {
    public:
      BorderedMultigrid(const TrilinosWrappers::PreconditionBase &multigrid, FullMatrix<double> &&block)
        : multigrid(multigrid.trilinos_operator())
        , inverse(std::move(block))
      {
        if (!inverse.empty())
          inverse.gauss_jordan();
      }

      void
      vmult(Vector &y, const Vector &x) const
      {
        const auto         &map = multigrid.OperatorDomainMap();
        const unsigned int  n   = map.NumMyElements();
        Epetra_Vector       y_first(View, map, y.begin());
        const Epetra_Vector x_first(View, map, const_cast<double *>(x.begin()));
        multigrid.ApplyInverse(x_first, y_first);
        for (unsigned int i = 0; i < inverse.m(); ++i)
          {
            double sum = 0.;
            for (unsigned int j = 0; j < inverse.n(); ++j)
              sum += inverse(i, j) * x.begin()[n + j];
            y.begin()[n + i] = sum;
          }
      }

    private:
      Epetra_Operator   &multigrid;
      FullMatrix<double> inverse;
    };

    /// Nodes have as many unknowns as space has dimensions; d (d + 1) / 2 rigid-body motions tell d.
    unsigned int
    unknowns_per_node(const unsigned int n_rigid_body_modes)
    {
      return n_rigid_body_modes == 6 ? 3 : n_rigid_body_modes == 3 ? 2 : 1;
    }
  } // namespace

  void
  LinearSolverSettings::add(Parameters &p, const MorePreconditioners more)
  {
    std::string                                         meaning;
    std::vector<std::pair<std::string, Preconditioner>> choices = {{"jacobi", Preconditioner::jacobi},
                                                                   {"amg", Preconditioner::amg}};
    if (more == MorePreconditioners::cholesky)
      {
        choices.emplace_back("cholesky", Preconditioner::cholesky);
        meaning = "; cholesky: an incomplete factor of each rank's own unknowns, for the plane";
      }
    if (more == MorePreconditioners::geometric)
      {
        choices.emplace_back("geometric", Preconditioner::geometric);
        choices.emplace_back("automatic", Preconditioner::automatic);
        meaning =
          "; geometric: multigrid on the grid itself, of matrices of cells that are never put together; "
          "automatic: that on grids of more than 5,000 unknowns where nothing but cells acts and nothing is free, as long "
          "as it converges, else amg";
      }
    p.add_choice("Preconditioner", preconditioner, "preconditioner of the linear solves" + meaning, choices);
    p.add("Tolerance", tolerance, "residual over right-hand side of an exact solve", "", Range::open(0., 1.));
    p.add("Maximum iterations", max_iterations, "iterations after which a solve has failed", Range::at_least(1.));
  }

  LinearSolver::LinearSolver(const LinearSolverSettings &settings)
    : settings(settings)
  {}

  void
  LinearSolver::set_near_null_space(const std::vector<Vector> &modes)
  {
    Assert(modes.size() == 1 || modes.size() == 3 || modes.size() == 6, ExcInternalError());
    forget();
    n_modes = modes.size();
    near_null_space.clear();
    for (const Vector &mode : modes)
      near_null_space.insert(near_null_space.end(), mode.begin(), mode.end());
    near_null_space.resize(std::max<std::size_t>(near_null_space.size(), 1)); // ML wants an address on every rank
  }

  void
  LinearSolver::forget()
  {
    multigrid.reset();
    factor.reset();
    has_own_multigrid     = false;
    set_up_for            = nullptr;
    iterations_per_decade = 0.;
    iterations_lost       = 0.;
  }

  LinearSolver::Memory
  LinearSolver::memory() const
  {
    return {is_set_up(), near_null_space, n_modes, iterations_per_decade, iterations_lost};
  }

  void
  LinearSolver::resume(const Memory &memory, const Operator &A, const Matrix &K)
  {
    remember(memory, A);
    if (memory.is_set_up)
      set_up_multigrid(K);
  }

  void
  LinearSolver::resume(const Memory &memory, const Operator &A, const SparseRows &own_block)
  {
    remember(memory, A);
    if (memory.is_set_up)
      factor.emplace(own_block);
  }

  void
  LinearSolver::remember(const Memory &memory, const Operator &A)
  {
    forget();
    near_null_space       = memory.near_null_space;
    n_modes               = memory.n_modes;
    set_up_for            = A.identity();
    iterations_per_decade = memory.iterations_per_decade;
    iterations_lost       = memory.iterations_lost;
  }

  void
  LinearSolver::set_symmetric(const bool symmetric)
  {
    if (symmetric != is_symmetric)
      forget(); // iterations of one method say nothing of the other's
    is_symmetric = symmetric;
  }

  LinearResult
  LinearSolver::solve(const Matrix &K, Vector &x, const Vector &b, const double relative_tolerance)
  {
    MatrixOperator A(K);
    return solve_lifted(A, x, b, relative_tolerance);
  }

  LinearResult
  LinearSolver::solve_lifted(Operator &A, Vector &x, const Vector &b, const double relative_tolerance)
  {
    Vector coupled_b(b);
    A.solve_decoupled(x, coupled_b);
    const double norm = coupled_b.l2_norm();
    if (!std::isfinite(norm))
      return {false, 0};
    if (norm == 0.)
      return {true, 0};
    Vector             coupled_x(b.locally_owned_elements(), b.get_mpi_communicator());
    const LinearResult result = solve_coupled(A, coupled_x, coupled_b, relative_tolerance * norm);
    x += coupled_x;
    return result;
  }

  LinearResult
  LinearSolver::solve(Operator &A, Vector &x, const Vector &b, const double tolerance)
  {
    x                 = 0.;
    const double norm = b.l2_norm();
    if (!std::isfinite(norm))
      return {false, 0};
    if (norm <= tolerance)
      return {true, 0};
    return solve_coupled(A, x, b, tolerance);
  }

  LinearResult
  LinearSolver::solve_coupled(Operator &A, Vector &x, const Vector &b, const double tolerance)
  {
    unsigned int iterations = 0;
    if (usable_for(A))
      {
        AgeControl control(settings.max_iterations, tolerance, iterations_per_decade, setup_cost() - iterations_lost);
        const Attempt aged = iterate(control, A, x, b);
        iterations_lost += std::max(0., aged.result.iterations - iterations_per_decade * aged.decades);
        if (aged.result.converged)
          return aged.result;
        if (!std::isfinite(x.l2_norm()))
          x = 0.;
        iterations = aged.result.iterations;
      }
    if (!set_up(A, x))
      return {false, iterations};
    SolverControl control(settings.max_iterations, tolerance, false, false);
    const Attempt fresh   = iterate(control, A, x, b);
    iterations_per_decade = fresh.result.iterations / std::max(1., fresh.decades);
    return {fresh.result.converged, iterations + fresh.result.iterations};
  }

  bool
  LinearSolver::usable_for(const Operator &A) const
  {
    return is_set_up() && set_up_for == A.identity() && iterations_lost < setup_cost();
  }

  /// Of the preconditioner, in iterations of a solve with it. Measured: 70; of a hierarchy 20 to 30 and 12, of geometric ones 3.
  double
  LinearSolver::setup_cost() const
  {
    if (has_own_multigrid)
      return 3.;
    if (settings.preconditioner == Preconditioner::cholesky)
      return 70.;
    return is_smoothed(n_modes) ? 25. : 10.;
  }

  LinearSolver::Attempt
  LinearSolver::iterate(SolverControl &control, const Operator &A, Vector &x, const Vector &b)
  {
    try
      {
        run_krylov(control, A, x, b);
      }
    catch (const SolverControl::NoConvergence &)
      {}
    n_iterations += control.last_step();
    const double decades = std::log10(control.initial_value() / control.last_value());
    return {{control.last_check() == SolverControl::success, control.last_step()},
            std::isfinite(decades) ? std::max(0., decades) : 0.};
  }

  void
  LinearSolver::run_krylov(SolverControl &control, const Operator &A, Vector &x, const Vector &b) const
  {
    PrimitiveVectorMemory<Vector> memory; // that which is shared keeps vectors that nothing needs between solves
    const auto                    solve_with = [&](const auto &preconditioner) {
      const SolverGMRES<Vector>::AdditionalData from_the_right(gmres_vectors, true);
      if (is_symmetric)
        SolverCG<Vector>(control, memory).solve(A, x, b, preconditioner);
      else
        SolverGMRES<Vector>(control, memory, from_the_right).solve(A, x, b, preconditioner);
    };
    if (factor)
      solve_with(*factor);
    else if (has_own_multigrid)
      solve_with(OwnMultigrid{A});
    else if (multigrid && A.has_border())
      solve_with(BorderedMultigrid(*multigrid, A.border()));
    else if (multigrid)
      solve_with(*multigrid);
    else
      solve_with(DiagonalMatrix<Vector>(inverse_diagonal));
  }

  bool
  LinearSolver::set_up(Operator &A, const Vector &layout)
  {
    forget();
    ++n_setups;
    if (settings.preconditioner == Preconditioner::jacobi)
      return set_up_jacobi(A, layout);
    if (A.has_multigrid())
      {
        has_own_multigrid = on_all_ranks([&] { A.set_up_multigrid(); }, layout.get_mpi_communicator());
        set_up_for        = A.identity();
        return has_own_multigrid;
      }
    if (settings.preconditioner == Preconditioner::cholesky)
      {
        const SparseRows &own_block = A.own_block();
        set_up_for                  = A.identity();
        return on_all_ranks([&] { factor.emplace(own_block); }, layout.get_mpi_communicator()) || (forget(), false);
      }
    const Matrix &K = A.approximation();
    if (!std::isfinite(K.frobenius_norm()))
      return false;
    const bool made = on_all_ranks([&] { set_up_multigrid(K); }, K.get_mpi_communicator());
    if (made)
      set_up_for = A.identity();
    else
      multigrid.reset();
    return made;
  }

  bool
  LinearSolver::set_up_jacobi(const Operator &A, const Vector &layout)
  {
    inverse_diagonal.reinit(layout, true);
    A.diagonal(inverse_diagonal);
    for (double &d : inverse_diagonal)
      d = 1. / d;
    return std::isfinite(inverse_diagonal.l2_norm());
  }

  void
  LinearSolver::set_up_multigrid(const Matrix &K)
  {
    Assert(n_modes > 0, ExcMessage("Call set_near_null_space() before solving with multigrid."));
    Teuchos::ParameterList list;
    ML_Epetra::SetDefaults("SA", list);
    list.set("read XML", false); // ML would obey a file of that kind in the working directory
    list.set("ML output", 0);
    list.set("ML validate parameter list", false); // ML does not know its own 'add to diag' there
    const bool smoothed = is_smoothed(n_modes);
    list.set("prec type", smoothed ? "MGV" : "MGW");
    list.set("aggregation: damping factor", smoothed ? 4. / 3. : 0.);
    list.set("PDE equations", static_cast<int>(unknowns_per_node(n_modes)));
    list.set("null space: type", "pre-computed");
    list.set("null space: dimension", static_cast<int>(n_modes));
    list.set("null space: vectors", near_null_space.data());
    list.set("null space: add default vectors", false);
    list.set("aggregation: type", "Uncoupled");
    list.set("aggregation: threshold", 0.);
    list.set("smoother: type", "Chebyshev");
    list.set("smoother: sweeps", 1);
    list.set("smoother: pre or post", "both");
    list.set("coarse: type", "Amesos-KLU");
    list.set("coarse: max size", 2000);
    list.set("coarse: add to diag", against_no_pivot * largest_of_diagonal(K)); // else 1e-12, whatever the units are
    list.set("repartition: enable", 0);
    // The eigenvalues for Chebyshev are estimated from random vectors, which would depend on the set-ups before this.
    ML_set_random_seed(1 + static_cast<int>(Utilities::MPI::this_mpi_process(K.get_mpi_communicator())));
    auto amg = std::make_unique<TrilinosWrappers::PreconditionAMG>();
    amg->initialize(K, list);
    multigrid = std::move(amg);
  }
} // namespace Stroma::Solvers
