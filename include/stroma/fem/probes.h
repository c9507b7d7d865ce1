#pragma once

#include <stroma/fem/unknowns.h>
#include <stroma/scene/probe.h>

#include <utility>

namespace Stroma::Fem
{
  /// Displacements of the nodes nearest to the scene's probes.
  template <int dim>
  class Probes
  {
  public:
    /// Finds the nodes; of nodes equally near the one with the smallest coordinates. Collective.
    /// @param grain differences of distance that do not count [m]
    Probes(const std::vector<Probe<dim>> &probes, const Unknowns<dim> &unknowns, double grain, MPI_Comm comm);

    /// displacement_NAME_x_m, ... of the displacement @p u of owned unknowns [m]. Collective.
    std::vector<std::pair<std::string, double>> scalars(const Vector &u) const;

  private:
    struct Watched
    {
      std::string                     name;
      dealii::types::global_dof_index dof; ///< invalid on ranks that do not own it
    };

    MPI_Comm             comm;
    std::vector<Watched> watched;
  };
} // namespace Stroma::Fem
