#pragma once

#include <stroma/scene/probe.h>
#include <stroma/simulation/method.h>

namespace Stroma
{
  /// The scene's probes, for any method: displacements at fixed undeformed places, or velocities where a method has no
  /// displacement.
  template <int dim>
  class Probes
  {
  public:
    Probes() = default;
    Probes(std::vector<Probe<dim>> probes, MPI_Comm comm);

    /// Their numbers in the committed state, "displacement_<probe>_x_m" and so on, the same on all ranks. Throws UserError
    /// for a probe where the method has no material. Collective.
    Scalars scalars(Method &method) const;

  private:
    std::vector<Probe<dim>> probes;
    MPI_Comm                comm = MPI_COMM_NULL;
  };
} // namespace Stroma
