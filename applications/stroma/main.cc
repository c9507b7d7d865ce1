#include <stroma/base/signals.h>

#include <deal.II/base/mpi.h>

#include <cstdlib>
#include <iostream>
#include <malloc.h>

#include "command_line.h"

// Signals are caught before the constructors of the libraries run, which take most of the time until main().
__attribute__((section(".preinit_array"), used)) void (*catch_stop_signals_early)() = &Stroma::catch_stop_signals;

namespace
{
  /// Whether no launcher (mpirun, srun) made this process a rank of several.
  bool
  is_alone()
  {
    for (const char *of_launcher : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"})
      if (std::getenv(of_launcher) != nullptr)
        return false;
    return true;
  }

  /// SuperLU, which Trilinos loads, makes malloc() keep all that is freed: so vectors of large grids go back to the system again.
  void
  give_back_large_blocks()
  {
    constexpr int large = 32 << 20; // [bytes]; smaller ones are sooner used again than got anew
    mallopt(M_MMAP_MAX, 1 << 16);
    mallopt(M_MMAP_THRESHOLD, large);
    mallopt(M_TRIM_THRESHOLD, 2 * large);
  }
} // namespace

int
main(int argc, char **argv)
{
  // Of a process alone, Open MPI would start a daemon that only MPI_Comm_spawn needs, and look for networks: .2 s of a start each.
  if (is_alone())
    {
      setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
      setenv("OMPI_MCA_pml", "ob1", 0);
    }
  give_back_large_blocks();
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  Stroma::catch_stop_signals(); // again: PETSc's initialisation takes and gives back some of them
  try
    {
      return Stroma::run_command_line(argc, argv);
    }
  catch (const std::exception &error)
    {
      std::cerr << "stroma: internal error: " << error.what() << std::endl;
      MPI_Abort(MPI_COMM_WORLD, 4);
    }
}
