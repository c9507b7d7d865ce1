#pragma once

#include <stroma/grid/background_grid.h>
#include <stroma/grid/connected_parts.h>
#include <stroma/grid/rigid_motions.h>
#include <stroma/mpm/points.h>
#include <stroma/mpm/settings.h>
#include <stroma/rigid/unknowns.h>
#include <stroma/scene/scene.h>

#include <deal.II/lac/affine_constraints.h>

#include <vector>

namespace Stroma::Mpm
{
  /**
   * The scene's supports on the background grid. A support on a side holds grid nodes; a support on a set of material drives
   * material points. So does one on 'nearest' with B-splines and, on a grid that is reset, one on 'nearest', on a side that leaves
   * its plane, and on a side whose motion depends on a coordinate along which it is free: a node there cannot know where its material came from.
   */
  template <int dim>
  class PrescribedMotion
  {
  public:
    struct HeldUnknown
    {
      dealii::types::global_dof_index                   dof;
      unsigned int                                      support, component;
      dealii::Point<dim>                                X;       ///< place of the node on the grid
      std::vector<typename ShapeFunctions<dim>::Sample> samples; ///< places whose motion makes that of the node
    };

    PrescribedMotion(const Scene<dim> &scene, const Settings<dim> &settings, double end_time);

    /// Whether support @p s acts on material points (on grid nodes otherwise).
    bool
    drives_points(const unsigned int s) const
    {
      return on_points[s];
    }
    bool any_drives_points() const;

    /// Marks the driven points. Throws UserError for a support that selects nothing and for supports that contradict each
    /// other. Collective.
    void mark_points(Points<dim> &points, const GridBox<dim> &box) const;

    /// The marks that the upper or lower half of a point along @p axis loses: those of the side that only the other half touches.
    std::uint64_t marks_of_inner_half(unsigned int axis, bool upper) const;

    /// Finds the held nodes of the grid's present unknowns; the constraints, over all @p relevant unknowns, are those of these
    /// and of what is prescribed to @p rigid bodies. Collective.
    void find_nodes(const BackgroundGrid<dim> &grid, const Rigid::Unknowns<dim> &rigid,
                    const dealii::IndexSet &relevant);

    /// Throws UserError if, on the nodes found, a support holds none or two contradict each other. For the start of a run.
    /// Collective.
    void check_nodes(const BackgroundGrid<dim> &grid) const;

    /// Whether every support on nodes holds some.
    bool
    holds_nodes() const
    {
      return without_nodes.empty();
    }

    /// Component @p c of a held node's motion [m] since the time @p t_reset of the last reset (0: none) at time @p t.
    double motion_of(const HeldUnknown &unknown, double t, double t_reset) const;

    /// Rate of that motion at time @p t [m/s], from values over 2 @p h [s] before.
    double rate_of(const HeldUnknown &unknown, double t, double t_reset, double h) const;

    /// Tells @p motions which places of the pieces are held, by nodes or as driven points.
    void hold(RigidMotions<dim> &motions, const ConnectedParts<dim> &parts, const BackgroundGrid<dim> &grid,
              const Points<dim> &points) const;

    const std::vector<HeldUnknown> &
    held() const
    {
      return held_unknowns;
    }
    const dealii::AffineConstraints<double> &
    constraints() const
    {
      return homogeneous;
    }

    const Scene<dim> &scene;

  private:
    void               check_shared_points(const Points<dim> &points) const;
    bool               nodes_can_follow(unsigned int s) const;
    dealii::Point<dim> origin(unsigned int s, const dealii::Point<dim> &x, double t) const;
    dealii::Point<dim> undeformed_place(unsigned int s, const dealii::Point<dim> &X, double t_reset) const;

    const Settings<dim>      &settings;
    double                    end_time;
    std::vector<bool>         on_points;
    std::vector<HeldUnknown>  held_unknowns; ///< on locally relevant nodes
    std::vector<unsigned int> without_nodes; ///< supports on nodes that hold none
    std::string               contradiction; ///< of supports that share a node, in words; empty if there is none
    dealii::AffineConstraints<double> homogeneous;
  };
} // namespace Stroma::Mpm
