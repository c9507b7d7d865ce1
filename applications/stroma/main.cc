#include <stroma/base/signals.h>

#include <deal.II/base/mpi.h>

#include <iostream>

#include "command_line.h"

int
main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  try
    {
      Stroma::catch_stop_signals();
      return Stroma::run_command_line(argc, argv);
    }
  catch (const std::exception &error)
    {
      std::cerr << "stroma: internal error: " << error.what() << std::endl;
      MPI_Abort(MPI_COMM_WORLD, 4);
    }
}
