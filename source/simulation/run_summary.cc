#include <stroma/scene/image_report.h>
#include <stroma/scene/reactions.h>
#include <stroma/simulation/results.h>
#include <stroma/simulation/run_summary.h>

#include <deal.II/base/mpi.h>

namespace Stroma
{
  template <int dim>
  std::vector<Output::Histogram>
  complete(Output::Summary &summary, const Problem<dim> &problem, const RunState &so_far, const ParameterFile &file,
           const Output::PointResults *const collected, Timers &timers, const ResourceUse &use, const MPI_Comm comm)
  {
    auto       &method = *problem.method;
    const auto &scene  = *problem.scene;
    summary.used.clear();
    summary.left_out.clear();
    method.describe(summary);
    for (const auto &scalars : {method.scalars, problem.probes.scalars(method)})
      for (const auto &[name, value] : scalars)
        if (!is_modulus_at_rest(name, value))
          summary.results[name] = value;
    std::vector<Output::Histogram> histograms;
    {
      const auto scope = timers.scope("results");
      histograms       = add_results(method, scene, problem.output, method.time, collected, summary.results);
    }
    so_far.describe(summary);
    summary.ending                = method.ending;
    summary.title                 = scene.title;
    summary.parameter_file        = file.path();
    summary.n_ranks               = dealii::Utilities::MPI::n_mpi_processes(comm);
    summary.results["end_time_s"] = method.time;
    summary.results.merge(report_images(scene).results);
    summary.results.merge(specimen_results(scene));
    summary.materials = scene.material_names;
    for (const auto &[name, seconds] : timers.phases())
      summary.phases.emplace_back(name, seconds);
    const auto peak           = use.peak_memory();
    const bool is_peak_known  = dealii::Utilities::MPI::min(peak ? 1 : 0, comm) == 1;
    summary.peak_memory_bytes = dealii::Utilities::MPI::sum(is_peak_known ? *peak : std::uint64_t(0), comm);
    summary.wall_time_s       = timers.total();
    return histograms;
  }

  template std::vector<Output::Histogram> complete(Output::Summary &, const Problem<2> &, const RunState &,
                                                   const ParameterFile &, const Output::PointResults *, Timers &,
                                                   const ResourceUse &, MPI_Comm);
  template std::vector<Output::Histogram> complete(Output::Summary &, const Problem<3> &, const RunState &,
                                                   const ParameterFile &, const Output::PointResults *, Timers &,
                                                   const ResourceUse &, MPI_Comm);
} // namespace Stroma
