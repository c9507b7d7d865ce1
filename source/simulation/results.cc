#include <stroma/base/text.h>
#include <stroma/output/collective.h>
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

  void
  save_scalars(const Scalars &scalars, Output::ArchiveWriter &archive, const MPI_Comm comm)
  {
    std::vector<std::string> names;
    std::vector<double>      values; // of rank 0
    for (const auto &[name, value] : scalars)
      names.push_back(name);
    if (dealii::Utilities::MPI::this_mpi_process(comm) == 0)
      for (const auto &[name, value] : scalars)
        values.push_back(value);
    archive.attribute("scalar_names", join(names, "\n"));
    archive.write("scalars", dealii::make_array_view(values));
  }

  Scalars
  load_scalars(const Output::ArchiveReader &archive, const MPI_Comm comm)
  {
    const auto names  = split(archive.attribute_string("scalar_names"), '\n');
    const auto values = Output::gather_all(archive.read_double("scalars"), comm);
    Scalars    scalars;
    for (std::size_t i = 0; i < std::min(names.size(), values.size()); ++i)
      scalars.emplace_back(names[i], values[i]);
    return scalars;
  }

  template void add_results(Method &, const Scene<2> &, double, std::map<std::string, double> &);
  template void add_results(Method &, const Scene<3> &, double, std::map<std::string, double> &);
} // namespace Stroma
