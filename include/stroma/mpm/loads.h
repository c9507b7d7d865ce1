#pragma once

#include <stroma/mpm/active_cells.h>
#include <stroma/mpm/points.h>
#include <stroma/scene/loads.h>

namespace Stroma::Mpm
{
  /// The points that loads act on: those of a load's region, or the one that was nearest to a place.
  template <int dim>
  class LoadedPoints
  {
  public:
    /// Collective.
    LoadedPoints(const Scene<dim> &scene, const Points<dim> &points);

    /// Whether load @p l acts on the point with this id, undeformed place and numbers: as marked where that is kept, else by the place.
    bool
    bears(const unsigned int l, const dealii::types::particle_index id, const dealii::Point<dim> &X,
          const double *numbers) const
    {
      return points.load.stored() ? points.is_marked(numbers, points.load, l) : is_chosen(l, id, X, numbers);
    }

    /// Keeps on which points loads act, so that their halves go on to bear them. For the start of a run.
    void mark(Points<dim> &all) const;

  private:
    bool is_chosen(unsigned int l, dealii::types::particle_index id, const dealii::Point<dim> &X,
                   const double *numbers) const;

    const Scene<dim>                          &scene;
    const Points<dim>                         &points;
    dealii::BoundingBox<dim>                   bodies;
    std::vector<dealii::types::particle_index> single; ///< the nearest point, or nobody
  };

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
    const Scene<dim>  &scene;
    const Points<dim> &points;
    ActiveCells<dim>  &cells;
    LoadDensities<dim> densities;
    LoadedPoints<dim>  loaded;
  };

  template <int dim>
  template <typename Visit>
  void
  Loads<dim>::for_each(const double t, const Visit &visit) const
  {
    for (const auto &active : cells)
      for (const auto &point : points.handler.particles_in_cell(active.cell))
        {
          const auto             numbers = point.get_properties();
          const auto             X       = points.initial_place(point.get_location(), numbers.data());
          const double           V0      = numbers[points.volume.first];
          dealii::Tensor<1, dim> force;
          for (std::size_t l = 0; l < scene.loads.size(); ++l)
            if (loaded.bears(l, point.get_id(), X, numbers.data()))
              force += V0 * densities.value(l, X, t);
          visit(active, point, force);
        }
  }
} // namespace Stroma::Mpm
