#include <stroma/simulation/exact_solution.h>
#include <stroma/simulation/results.h>

namespace Stroma
{
  template <int dim>
  void
  add_results(Method &method, const Scene<dim> &scene, const double time, std::map<std::string, double> &results)
  {
    const ExactSolution<dim> exact(scene);
    const auto               state = method.state(exact.given());
    Output::add_von_mises(*state, scene.comm, results);
    exact.add_errors(*state, method.facts.sampled_fields, time, results);
  }

  template void add_results(Method &, const Scene<2> &, double, std::map<std::string, double> &);
  template void add_results(Method &, const Scene<3> &, double, std::map<std::string, double> &);
} // namespace Stroma
