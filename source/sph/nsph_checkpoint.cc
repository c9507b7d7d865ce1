// Saving and continuing NsphMethod.

#include <stroma/sph/nsph_method.h>

namespace Stroma::Sph
{
  template <int dim>
  void
  NsphMethod<dim>::save(Output::ArchiveWriter &archive) const
  {
    ParticleMethod<dim>::save(archive);
    archive.attribute("islands", most_islands);
    const auto order = this->system->neighbours->n_orders;
    history.save(archive, this->system->particles.n_owned, order);

    const auto memory      = linear_solver->memory();
    const bool knows_order = order_of_solver == order;
    const bool knows_modes = knows_order && memory.n_modes > 0, is_set_up = knows_order && memory.is_set_up;
    archive.attribute("solver_modes", std::uint64_t(knows_modes ? memory.n_modes : 0));
    if (knows_modes)
      archive.write("solver/modes", dealii::make_array_view(memory.near_null_space));
    archive.attribute("solver_is_set_up", std::uint64_t(is_set_up));
    if (!is_set_up)
      return;
    archive.attribute("solver_iterations_per_decade", memory.iterations_per_decade);
    archive.attribute("solver_iterations_lost", memory.iterations_lost);
    const auto rows = A->matrix_rows();
    archive.write("solver/lengths of rows", dealii::make_array_view(rows.length));
    archive.write("solver/columns", dealii::make_array_view(rows.column));
    archive.write("solver/values", dealii::make_array_view(rows.value));
  }

  /// On the same ranks, with the particles in the same order.
  template <int dim>
  void
  NsphMethod<dim>::restore_solver(const Output::ArchiveReader &archive)
  {
    const auto order = this->system->neighbours->n_orders;
    history.restore(archive, order);
    most_islands = archive.attribute_uint64("islands");
    Solvers::LinearSolver::Memory memory;
    memory.n_modes = archive.attribute_uint64("solver_modes");
    if (memory.n_modes > 0)
      memory.near_null_space = archive.read_double("solver/modes");
    memory.is_set_up = archive.attribute_uint64("solver_is_set_up") == 1;
    if (memory.n_modes == 0 && !memory.is_set_up)
      return;
    order_of_solver = order;
    Solvers::SparseRows rows;
    if (memory.is_set_up)
      {
        memory.iterations_per_decade = archive.attribute_double("solver_iterations_per_decade");
        memory.iterations_lost       = archive.attribute_double("solver_iterations_lost");
        rows.length                  = archive.read_uint64("solver/lengths of rows");
        rows.column                  = archive.read_uint64("solver/columns");
        rows.value                   = archive.read_double("solver/values");
      }
    if (linear_settings.preconditioner == Solvers::Preconditioner::cholesky)
      linear_solver->resume(memory, *A, A->restore_own_block(std::move(rows)));
    else
      linear_solver->resume(memory, *A, A->restore_approximation(rows));
  }

  template class NsphMethod<2>;
  template class NsphMethod<3>;
} // namespace Stroma::Sph
