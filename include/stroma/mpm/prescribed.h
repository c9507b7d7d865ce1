#pragma once

#include <stroma/grid/background_grid.h>
#include <stroma/grid/connected_parts.h>
#include <stroma/grid/rigid_motions.h>
#include <stroma/mpm/points.h>
#include <stroma/mpm/settings.h>
#include <stroma/scene/scene.h>

#include <deal.II/lac/affine_constraints.h>

#include <vector>

namespace Stroma::Mpm
{
  /**
   * The scene's supports on the background grid. A support on a side holds grid nodes; a support on a set of material,
   * or on a side that moves while the grid is reset, drives material points.
   */
  template <int dim>
  class PrescribedMotion
  {
  public:
    PrescribedMotion(const Scene<dim> &scene, const Settings<dim> &settings, double end_time);

    /// Whether support @p s acts on material points (on grid nodes otherwise).
    bool drives_points(const unsigned int s) const { return on_points[s]; }
    bool any_drives_points() const;

    /// Marks the driven points. Throws UserError for a support that selects nothing. Collective.
    void mark_points(Points<dim> &points, const GridBox<dim> &box) const;

    /// Finds the held nodes of the grid's present unknowns. Throws UserError for a support without nodes and for
    /// supports that contradict each other. Collective.
    void find_nodes(const BackgroundGrid<dim> &grid);

    /// Tells @p motions which places of the pieces are held, by nodes or as driven points.
    void hold(RigidMotions<dim> &motions, const ConnectedParts<dim> &parts, const BackgroundGrid<dim> &grid,
              const Points<dim> &points) const;

    struct HeldUnknown
    {
      dealii::types::global_dof_index dof;
      unsigned int                    support, component;
      dealii::Point<dim>              X; ///< place of the node
    };

    const std::vector<HeldUnknown>          &held() const { return held_unknowns; }
    const dealii::AffineConstraints<double> &constraints() const { return homogeneous; }

    const Scene<dim> &scene;

  private:
    bool moves_normally(unsigned int s) const;

    const Settings<dim>              &settings;
    double                            end_time;
    std::vector<bool>                 on_points;
    std::vector<HeldUnknown>          held_unknowns; ///< on locally relevant nodes
    dealii::AffineConstraints<double> homogeneous;
  };
} // namespace Stroma::Mpm
