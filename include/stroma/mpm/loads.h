#pragma once

#include <stroma/mpm/active_cells.h>
#include <stroma/mpm/points.h>
#include <stroma/scene/loads.h>

namespace Stroma::Mpm
{
  /// The scene's dead loads, as forces on material points.
  template <int dim>
  class Loads
  {
  public:
    /// Measures the regions of loads. Throws UserError for a load that selects nothing. Collective.
    Loads(const Scene<dim> &scene, const Points<dim> &points, ActiveCells<dim> &cells);

    /// External forces at time @p t [N]: F_ext,g = sum_p S_gp F_ext,p (1). Collective.
    void assemble(double t, Vector &force);

    /// Calls visit(active cell, point, force on it) for the points of this rank at time @p t.
    template <typename Visit>
    void for_each(double t, const Visit &visit) const;

  private:
    const Scene<dim>      &scene;
    const Points<dim>     &points;
    ActiveCells<dim>      &cells;
    LoadDensities<dim>     densities;
    std::vector<long long> single; ///< id of the nearest point, or -1
  };

  template <int dim>
  template <typename Visit>
  void
  Loads<dim>::for_each(const double t, const Visit &visit) const
  {
    const auto bodies = scene.bounding_box();
    for (const auto &active : cells)
      for (const auto &point : points.handler.particles_in_cell(active.cell))
        {
          const auto             numbers = point.get_properties();
          const auto             X       = points.initial_place(point.get_location(), numbers.data());
          const double           V0      = numbers[points.volume.first];
          dealii::Tensor<1, dim> force;
          for (std::size_t l = 0; l < scene.loads.size(); ++l)
            {
              const auto &load = scene.loads[l];
              if (single[l] == static_cast<long long>(point.get_id()))
                force += load.total.value(X, t);
              else if (load.region.contains(X, points.material_of(numbers.data()), bodies))
                force += V0 * densities.value(l, X, t);
            }
          visit(active, point, force);
        }
  }
} // namespace Stroma::Mpm
