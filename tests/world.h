#pragma once

#include <deal.II/base/mpi.h>

/// All ranks of a test.
inline const MPI_Comm world = MPI_COMM_WORLD;

inline unsigned int
my_rank()
{
  return dealii::Utilities::MPI::this_mpi_process(world);
}

inline unsigned int
n_ranks()
{
  return dealii::Utilities::MPI::n_mpi_processes(world);
}
