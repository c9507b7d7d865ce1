#include <stroma/fem/stokes/solver.h>
#include <stroma/solvers/on_all_ranks.h>

#include <deal.II/base/mpi.h>
#include <deal.II/lac/solver_minres.h>
#include <deal.II/lac/trilinos_parallel_block_vector.h>
#include <deal.II/lac/trilinos_precondition.h>

#include <Teuchos_ParameterList.hpp>
#include <ml_MultiLevelPreconditioner.h>
#include <ml_utils.h>

#include <cmath>

namespace Stroma::Fem
{
  namespace
  {
    using BlockVector = dealii::TrilinosWrappers::MPI::BlockVector;
    using dealii::TrilinosWrappers::PreconditionAMG;
    using dealii::TrilinosWrappers::PreconditionBase;

    /// Smoothed aggregation with the given near null space (ML's layout), @p n_components unknowns a node.
    std::unique_ptr<PreconditionAMG>
    multigrid(const Matrix &matrix, const unsigned int n_components, std::vector<double> &modes,
              const unsigned int n_modes)
    {
      Teuchos::ParameterList list;
      ML_Epetra::SetDefaults("SA", list);
      list.set("read XML", false); // ML would obey a file of that kind in the working directory
      list.set("ML output", 0);
      list.set("PDE equations", static_cast<int>(n_components));
      list.set("null space: type", "pre-computed");
      list.set("null space: dimension", static_cast<int>(n_modes));
      list.set("null space: vectors", modes.data());
      list.set("null space: add default vectors", false);
      list.set("aggregation: type", "Uncoupled");
      list.set("aggregation: threshold", 0.);
      list.set("smoother: type", "Chebyshev");
      list.set("smoother: sweeps", 2);
      list.set("smoother: pre or post", "both");
      list.set("coarse: type", "Amesos-KLU");
      list.set("coarse: max size", 2000);
      list.set("repartition: enable", 0);
      // The eigenvalues for Chebyshev are estimated from random vectors: see Solvers::LinearSolver.
      ML_set_random_seed(1 + static_cast<int>(dealii::Utilities::MPI::this_mpi_process(matrix.get_mpi_communicator())));
      auto amg = std::make_unique<PreconditionAMG>();
      amg->initialize(matrix, list);
      return amg;
    }
  } // namespace

  struct StokesSolver::Operator
  {
    const StokesMatrices &m;

    void
    vmult(BlockVector &y, const BlockVector &x) const
    {
      m.A.vmult(y.block(0), x.block(0));
      m.B.Tvmult_add(y.block(0), x.block(1));
      m.B.vmult(y.block(1), x.block(0));
      if (m.C.m() > 0)
        {
          Vector compressed(y.block(1));
          m.C.vmult(compressed, x.block(1));
          y.block(1) -= compressed;
        }
    }
  };

  struct StokesSolver::BlockDiagonal
  {
    std::unique_ptr<PreconditionBase> A, S, L; // L only with inertia

    void
    vmult(BlockVector &y, const BlockVector &x) const
    {
      A->vmult(y.block(0), x.block(0));
      S->vmult(y.block(1), x.block(1));
      if (L)
        {
          Vector inertial(y.block(1));
          L->vmult(inertial, x.block(1));
          y.block(1) += inertial;
        }
    }
  };

  StokesSolver::StokesSolver(const Solvers::LinearSolverSettings &settings, const StokesMatrices &m)
    : settings(settings)
    , m(m)
  {}

  StokesSolver::~StokesSolver() = default;

  bool
  StokesSolver::set_up(const std::vector<Vector> &modes)
  {
    preconditioner.reset();
    if (!std::isfinite(m.A.frobenius_norm()) || !std::isfinite(m.S.frobenius_norm()))
      return false;
    auto       made = std::make_unique<BlockDiagonal>();
    const auto make = [&] {
      if (settings.preconditioner == Solvers::Preconditioner::amg)
        {
          std::vector<double> values;
          for (const Vector &mode : modes)
            values.insert(values.end(), mode.begin(), mode.end());
          values.resize(std::max<std::size_t>(values.size(), 1)); // ML wants an address on every rank
          made->A = multigrid(m.A, modes.size() > 3 ? 3 : 2, values, modes.size());
        }
      else
        {
          auto jacobi = std::make_unique<dealii::TrilinosWrappers::PreconditionJacobi>();
          jacobi->initialize(m.A);
          made->A = std::move(jacobi);
        }
      auto gauss_seidel = std::make_unique<dealii::TrilinosWrappers::PreconditionSSOR>();
      gauss_seidel->initialize(m.S);
      made->S = std::move(gauss_seidel);
      if (m.L.m() > 0)
        {
          std::vector<double> one(std::max<std::size_t>(m.L.local_size(), 1), 1.);
          made->L = multigrid(m.L, 1, one, 1);
        }
    };
    if (!Solvers::on_all_ranks(make, m.A.get_mpi_communicator()))
      return false;
    preconditioner = std::move(made);
    return true;
  }

  Solvers::LinearResult
  StokesSolver::solve(StokesFlow &x, const StokesFlow &r) const
  {
    const auto  comm = r.v.get_mpi_communicator();
    BlockVector b(std::vector<dealii::IndexSet>{r.v.locally_owned_elements(), r.p.locally_owned_elements()}, comm);
    b.block(0) = r.v;
    b.block(1) = r.p;
    BlockVector solution(b), preconditioned(b);
    solution = 0.;

    preconditioner->vmult(preconditioned, b);
    const double scale = std::sqrt(preconditioned * b);
    if (!std::isfinite(scale))
      return {false, 0};
    dealii::SolverControl control(settings.max_iterations, settings.tolerance * scale, false, false);
    try
      {
        dealii::SolverMinRes<BlockVector>(control).solve(Operator{m}, solution, b, *preconditioner);
      }
    catch (const dealii::SolverControl::NoConvergence &)
      {}
    x.v                  = solution.block(0);
    x.p                  = solution.block(1);
    const bool converged = control.last_check() == dealii::SolverControl::success && std::isfinite(solution.l2_norm());
    return {converged, control.last_step()};
  }
} // namespace Stroma::Fem
