#include <stroma/methods/table.h>
#include <stroma/sph/nsph_method.h>
#include <stroma/sph/sph_method.h>

namespace Stroma
{
  namespace
  {
    template <bool inertial>
    void
    check_settings(Parameters &p)
    {
      const auto section = p.section(inertial ? "SPH" : "NSPH", "smoothed particle hydrodynamics");
      Sph::Settings().add(p, inertial);
    }
  } // namespace

  template <int dim>
  MethodEntry<dim>
  nsph_entry()
  {
    return {"nsph", "particles without inertia", "NSPH",
            [](Parameters &p, const Scene<dim> &scene, const Solvers::StepSettings &steps, Timers &timers)
              -> std::unique_ptr<Method> { return std::make_unique<Sph::NsphMethod<dim>>(p, scene, steps, timers); },
            [](Parameters &p, const Scene<dim> &) { check_settings<false>(p); }};
  }

  template <int dim>
  MethodEntry<dim>
  sph_entry()
  {
    return {"sph", "particles with inertia", "SPH",
            [](Parameters &p, const Scene<dim> &scene, const Solvers::StepSettings &steps,
               Timers &timers) -> std::unique_ptr<Method> {
              return std::make_unique<Sph::SphMethod<dim>>(p, scene, steps.end_time, timers);
            },
            [](Parameters &p, const Scene<dim> &) { check_settings<true>(p); }};
  }

  template MethodEntry<2> nsph_entry();
  template MethodEntry<3> nsph_entry();
  template MethodEntry<2> sph_entry();
  template MethodEntry<3> sph_entry();
} // namespace Stroma
