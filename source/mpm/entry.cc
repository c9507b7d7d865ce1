#include <stroma/methods/table.h>
#include <stroma/mpm/method.h>

namespace Stroma
{
  template <int dim>
  MethodEntry<dim>
  mpm_entry()
  {
    return {"mpm", "material points", "MPM",
            [](Parameters &p, const Scene<dim> &scene, const Solvers::StepSettings &steps,
               Timers &timers) -> std::unique_ptr<Method> {
              return std::make_unique<Mpm::MpmMethod<dim>>(p, scene, steps.end_time, timers);
            },
            [](Parameters &p, const Scene<dim> &scene) {
              const auto section = p.section("MPM", "the material point method");
              Mpm::Settings<dim>().add(p, scene);
            }};
  }

  template MethodEntry<2> mpm_entry();
  template MethodEntry<3> mpm_entry();
} // namespace Stroma
