#include <stroma/fem/solid/method.h>
#include <stroma/fem/stokes/method.h>
#include <stroma/methods/table.h>

namespace Stroma
{
  namespace
  {
    template <int dim>
    Fem::Settings<dim>
    read_settings(Parameters &p, const Scene<dim> &scene)
    {
      const auto         section = p.section("FEM", "finite elements");
      Fem::Settings<dim> settings;
      settings.add(p, scene);
      return settings;
    }

    /// For solids or for Stokes flow, as the materials are.
    template <int dim>
    std::unique_ptr<Method>
    make(Parameters &p, const Scene<dim> &scene, const Solvers::StepSettings &steps, Timers &timers)
    {
      const auto settings = read_settings(p, scene);
      if (scene.is_fluid())
        return std::make_unique<Fem::StokesMethod<dim>>(p, scene, settings, steps.end_time, timers);
      return std::make_unique<Fem::SolidMethod<dim>>(p, scene, settings, steps.end_time, timers);
    }
  } // namespace

  template <int dim>
  MethodEntry<dim>
  fem_entry()
  {
    return {"fem", "finite elements", "FEM", make<dim>,
            [](Parameters &p, const Scene<dim> &scene) { read_settings(p, scene); }};
  }

  template MethodEntry<2> fem_entry();
  template MethodEntry<3> fem_entry();
} // namespace Stroma
