#include <stroma/base/parameters.h>
#include <stroma/materials/medium.h>

#include <cmath>

namespace Stroma::Materials
{
  void
  Medium::add(Parameters &p)
  {
    const bool documenting = p.get_mode() == Parameters::Mode::document;
    if (p.given("Density") || documenting)
      p.add("Density", density, "mass density before deformation, rho; only for motion with inertia", "kg/m^3",
            Range::positive());
    if (is_fluid)
      viscosity = std::nan(""); // must be given
    p.add("Viscosity", viscosity, "shear viscosity, mu", "Pa*s", is_fluid ? Range::positive() : Range::non_negative());
    if (p.given("Viscosity") || documenting)
      p.add_choice<ViscousOperator>(
        "Viscous operator", viscous_operator,
        "stress of the rate of deformation D: central: 2 mu dev D + 5/3 mu tr D I (Appendix A of "
        "Heck et al. 2017); morris: mu grad v; deviatoric: 2 mu dev D",
        {{"central", ViscousOperator::central},
         {"morris", ViscousOperator::morris},
         {"deviatoric", ViscousOperator::deviatoric}});
  }
} // namespace Stroma::Materials
