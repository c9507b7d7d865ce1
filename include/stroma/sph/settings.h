#pragma once

#include <stroma/particles/arrangement.h>
#include <stroma/particles/kernel.h>
#include <stroma/solvers/time_scheme.h>
#include <stroma/sph/contact_settings.h>

namespace Stroma::Sph
{
  using namespace Particles; // the operators and methods of this room are written in their terms

  /// Which discrete equations.
  enum class Formulation
  {
    consistent, ///< area vectors that close, walls where the scene has them, hourglass control
    published   ///< Heck 2017: (9), (11), (16), only to reproduce the paper
  };

  /// What stands behind the particles at held sides and rigid bodies.
  enum class Walls
  {
    layers, ///< fixed particles, a pair with which ends at the wall
    facets  ///< the surface itself; published: of rigid bodies, with particles on it (Heck 2017, 2.5)
  };

  /// How NSPH takes the stress in a step.
  enum class StressUpdate
  {
    implicit_, ///< with the velocity that is solved for: stable at any step
    explicit_  ///< from the step's start, as the paper: stable up to 2 mu_P/M
  };

  /// The section `NSPH` or `SPH`.
  struct Settings
  {
    ArrangementSettings arrangement;
    KernelName          kernel      = KernelName::wendland_c2;
    double              h_over_dp   = 1.3; ///< smoothing length over spacing
    Formulation         formulation = Formulation::consistent;
    Walls               walls       = Walls::layers;
    double       stabilisation = 1.; ///< of hourglass control; 1 cancels the leading error of shear, see AreaVectors
    double       closing_tolerance   = 0.; ///< of area vectors, over 2 V; 0: 1e-4 of solids, 1e-9 of fluids
    StressUpdate stress_update       = StressUpdate::implicit_;     ///< SPH: always explicit
    Solvers::SchemeName scheme       = Solvers::SchemeName::sdirk2; ///< NSPH with implicit stresses
    double              largest_move = .2;                          ///< in a step, over the spacing
    double              courant      = .25;                         ///< SPH: step over h/c
    bool                energy_flow  = false;                       ///< SPH: whether work and dissipation are summed up
    ContactSettings     contact;

    /// Declares and reads the entries of the current section. @param inertial whether it is `SPH`
    void add(Parameters &p, bool inertial);

    double
    h() const
    {
      return h_over_dp * arrangement.spacing;
    } ///< [m]
    bool
    published() const
    {
      return formulation == Formulation::published;
    }

    /// Whether rigid bodies are rows of boundary particles and segments, (17) to (32) of Heck 2017.
    bool
    has_segments() const
    {
      return published() && walls == Walls::facets;
    }
    /// Whether layers of fixed particles stand behind the particles at held sides.
    bool
    has_layers() const
    {
      return walls == Walls::layers || published();
    }

    std::string where_walls, where_stress_update;
  };
} // namespace Stroma::Sph
