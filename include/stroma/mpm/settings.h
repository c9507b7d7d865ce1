#pragma once

#include <stroma/base/parameters.h>
#include <stroma/grid/shape_functions.h>
#include <stroma/rigid/contact_settings.h>
#include <stroma/scene/scene.h>
#include <stroma/solvers/time_scheme.h>

namespace Stroma::Mpm
{
  /// When the grid goes back to its original shape.
  enum class ResetPolicy
  {
    always,        ///< after every step: standard MPM
    never,         ///< the modified algorithm of Guilkey 2006, total Lagrangian
    when_distorted ///< when the distortion since the last reset passes a limit
  };

  enum class InternalForce
  {
    consistent, ///< f = sum V0 tau F_D^{-T} grad_X S
    published   ///< the scheme behind the published tables: F_D^{-T} left out, F compounded step by step
  };

  /// The `MPM` section.
  template <int dim>
  class Settings
  {
  public:
    void add(Parameters &p, const Scene<dim> &scene);

    /// Throws UserError, or warns, where the scene's materials do not go with the settings.
    void check(const Scene<dim> &scene) const;

    /// The policy in force at time @p t.
    ResetPolicy policy_at(double t) const;

    /// Whether the grid may ever be reset in this scene.
    bool may_reset() const;

    /// Whether a step's deformation is ever moved from the grid to the points (F_p^r of design/mpm.md is not I).
    bool
    is_rebased() const
    {
      return may_reset() || internal_force == InternalForce::published;
    }

    /// Whether resets give the points weights in the sums over their cells, see set_weights().
    bool
    weighs_points() const
    {
      return may_reset() && internal_force == InternalForce::consistent;
    }

    /// Whether material points can be found in images whenever they are asked for, so that none is kept: few stand for many
    /// in the solve, all bodies are images, and neither a load nor a motion acts on single points.
    bool
    finds_points_in_images(const Scene<dim> &scene, const bool drives_points) const
    {
      return two_moments && can_find_points_in_images(scene, drives_points);
    }

    /// Two moments where 'Integration = automatic' leaves it open and no point is kept then; before finds_points_in_images().
    void choose_integration(const Scene<dim> &scene, bool drives_points);

    /// Cell side of @p box over the distance of an image's points, of the axis and the image where that is least; infinity
    /// without images.
    double points_of_images_in_cell(const Scene<dim> &scene, const GridBox<dim> &box) const;

    /// Whether these are so few that they do not integrate a cell as Gauss points do.
    bool
    is_as_fine_as_images(const Scene<dim> &scene, const GridBox<dim> &box) const
    {
      return points_of_images_in_cell(scene, box) < 2. * (1. - 1e-9);
    }

    /// The grid's box, from the entries and the bodies. Throws UserError if it does not cover the bodies.
    GridBox<dim> grid_box(const Scene<dim> &scene) const;

    const ShapeFunctionsEntry<dim> &
    shape_functions() const
    {
      return Stroma::shape_functions<dim>()[shape];
    }

    std::vector<unsigned int>                   cells;
    std::vector<double>                         lower_corner, upper_corner;
    std::vector<double>                         margin_below, margin_above;
    unsigned int                                shape = 0; ///< functions of the grid, by their place in the table
    std::vector<unsigned int>                   points_per_cell;
    std::vector<unsigned int>                   points_per_voxel;
    bool                                        gauss_points = false; ///< at the cells' Gauss points, of all bodies
    ResetPolicy                                 policy       = ResetPolicy::never;
    std::vector<std::pair<double, ResetPolicy>> schedule; ///< (time [s], policy from then on), in order
    double                                      distortion_limit = .5;
    InternalForce                               internal_force   = InternalForce::consistent;
    double                                      penalty          = 1e4;
    Rigid::ContactSettings                      contact;
    bool                                        projected = false; ///< dilatation, onto its mean over a cell
    bool                                        composite = false; ///< F jumps where materials meet inside a cell
    std::string                 about_interfaces;         ///< what 'Interface = automatic' has taken, for the log
    bool                        two_moments = false;      ///< few points stand for many in the solve
    std::string                 about_integration;        ///< what 'Integration = automatic' has taken, for the log
    bool                        shares_stiffness = false; ///< found by check_size(), no entry
    Solvers::Order              order            = Solvers::Order::statics; ///< from viscosity
    Solvers::TimeSchemeSettings scheme;
    std::string                 where_cells; ///< place of entry 'Cells'

  private:
    void add_grid(Parameters &p);
    void add_points(Parameters &p);
    void add_resets(Parameters &p);
    void add_quadrature(Parameters &p, const Scene<dim> &scene);
    void refuse_combinations(const Parameters &p, const Scene<dim> &scene) const;
    bool can_find_points_in_images(const Scene<dim> &scene, bool drives_points) const;

    bool        is_integration_open = false; ///< whether choose_integration() may choose
    std::string where_grid, where_dilatation;
  };
} // namespace Stroma::Mpm
