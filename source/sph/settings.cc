#include <stroma/base/log.h>
#include <stroma/sph/settings.h>

namespace Stroma::Sph
{
  namespace
  {
    void
    add_of_inertia(Settings &s, Parameters &p)
    {
      s.stress_update = StressUpdate::explicit_;
      p.add("Courant number", s.courant, "largest step over h/c, c the speed of longitudinal waves", "",
            Range::open(0., 1.));
      p.add("Energy balance", s.energy_flow,
            "whether work and dissipated energy of solids are summed up and told, work_J and dissipated_energy_J");
    }

    /// Entries of the consistent formulation. A scene that has them may be run with the published one, which tells that it leaves them out.
    void
    add_of_consistent(Settings &s, Parameters &p)
    {
      const auto in_use = [&](const std::string &name, const std::string &lacking) {
        if (!s.published() || p.get_mode() == Parameters::Mode::document)
          return true;
        if (p.given(name))
          Log::warning(p.where(name) + ": '" + name + "' has no part in 'Formulation = published', which has no " +
                       lacking);
        return p.given(name);
      };
      if (in_use("Stabilisation", "hourglass control"))
        p.add(
          "Stabilisation", s.stabilisation,
          "stiffness of hourglass control (of modes of the grid's scale, which the smoothed gradient does not see); 1 "
          "cancels the leading error in shear",
          "", Range::closed(.05, 10.));
      if (in_use("Closing tolerance", "area vectors that close"))
        p.add(
          "Closing tolerance", s.closing_tolerance,
          "residual of the area vectors that close, over 2 V, root mean square; 0: 1e-4 of solids, 1e-9 of fluids, whose "
          "results on other numbers of ranks then agree to 1e-7 (with 1e-13: to 1e-10)",
          "", Range::closed(0., 1e-4));
    }

    void
    add_without_inertia(Settings &s, Parameters &p)
    {
      p.add_choice<StressUpdate>(
        "Stress update", s.stress_update,
        "implicit: stable at any step; explicit: the paper's, stable up to the least of 2 mu_P/(K + 4G/3), "
        "2 mu/G and, with 'Viscous operator = morris', 1.5 mu/(Stabilisation G); mu_P is the "
        "viscosity, or three times it with 'central'; half of that beside the facets of the published scheme",
        {{"implicit", StressUpdate::implicit_}, {"explicit", StressUpdate::explicit_}});
      if (s.stress_update == StressUpdate::implicit_)
        p.add_choice<Solvers::SchemeName>("Scheme", s.scheme,
                                          "of the implicit stresses: order 1; order 2 with two solves a step",
                                          {{"backward Euler", Solvers::SchemeName::backward_euler},
                                           {"SDIRK 2", Solvers::SchemeName::sdirk2}});
      p.add("Largest move", s.largest_move, "of a particle in a step, over the spacing; longer steps are cut", "",
            Range::closed(.001, 1.));
    }
  } // namespace

  void
  Settings::add(Parameters &p, const bool inertial)
  {
    arrangement.add(p);
    p.add_choice<Formulation>("Formulation", formulation,
                              "consistent, or the published scheme of Heck et al. 2017, only to reproduce the paper",
                              {{"consistent", Formulation::consistent}, {"published", Formulation::published}});
    if (published())
      {
        stress_update = StressUpdate::explicit_;
        kernel        = KernelName::cubic_spline;
      }
    p.add_choice<KernelName>("Kernel", kernel, "smoothing kernel W; supports of 2 h, 3 h and 2 h",
                             {{"cubic spline", KernelName::cubic_spline},
                              {"quintic spline", KernelName::quintic_spline},
                              {"Wendland C2", KernelName::wendland_c2}});
    p.add("Smoothing length", h_over_dp, "smoothing length over spacing, h/dp", "", Range::closed(1., 3.));
    if (!(published() && inertial) || p.get_mode() == Parameters::Mode::document)
      p.add_choice<Walls>(
        "Walls", walls,
        "what stands behind the particles at held sides and rigid bodies: layers of fixed particles, or "
        "the surfaces themselves; of the published scheme those of rigid bodies, in the plane and without inertia",
        {{"layers", Walls::layers}, {"facets", Walls::facets}});
    add_of_consistent(*this, p);
    if (inertial)
      add_of_inertia(*this, p);
    else
      add_without_inertia(*this, p);
    where_walls         = p.where("Walls");
    where_stress_update = p.where("Stress update");
    if (has_segments() && stress_update == StressUpdate::implicit_)
      throw UserError(where_stress_update, "the published scheme with 'Walls = facets' takes stresses at boundary "
                                           "particles as they are; set 'Stress update = explicit'");
  }
} // namespace Stroma::Sph
