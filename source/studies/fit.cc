#include <stroma/base/log.h>
#include <stroma/base/on_root.h>
#include <stroma/base/signals.h>
#include <stroma/base/text.h>
#include <stroma/output/folder.h>
#include <stroma/studies/fit.h>
#include <stroma/studies/fit_report.h>
#include <stroma/studies/kept_run.h>
#include <stroma/studies/picture.h>
#include <stroma/studies/side_by_side.h>

#include <deal.II/base/utilities.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace Stroma::Studies
{
  namespace
  {
    /// The search ends here; thrown on all ranks.
    struct Ended
    {
      RunStatus status;
    };

    /// Values of the constants, and what the folders of their runs are called.
    struct Trial
    {
      std::vector<double> values;
      std::string         name;
    };

    /// The scene as a model of the data.
    class SceneModel
    {
    public:
      SceneModel(const ParameterFile &scene, const FitPlan &plan, const FitOptions &options, const std::string &folder,
                 const MPI_Comm comm)
        : scene(scene)
        , plan(plan)
        , options(options)
        , folder(folder)
        , comm(comm)
      {
        for (const auto &data : plan.data)
          {
            double largest = 0.;
            for (const double y : data.measured.y)
              largest = std::max(largest, std::abs(y));
            sizes.push_back(largest > 0. ? largest : 1.);
          }
      }

      /// Empty if the run failed.
      Eigen::VectorXd
      residuals(const std::vector<double> &values)
      {
        if (const auto known = trials_done.find(values); known != trials_done.end())
          return residuals_of(known->second);
        const Trial trial{values, numbered()};
        const auto  status = run({trial});
        if (status == RunStatus::stopped)
          throw Ended{status};
        if (status == RunStatus::failed)
          return {};
        const auto curves = curves_of(trial);
        if (trials_done.empty())
          {
            check_reach(curves);
            at_start = curves;
          }
        trials_done[values] = curves;
        const auto result   = residuals_of(curves);
        Log::line("fit: " + text_of(values) + "; differences of " +
                  brief(std::sqrt(result.squaredNorm() / result.size())) + " (root mean square)");
        return result;
      }

      Eigen::MatrixXd
      derivatives(const std::vector<double> &values)
      {
        if (values == values_of_derivatives)
          return known_derivatives;
        const Eigen::VectorXd here = residuals(values);
        const auto            name = numbered();
        std::vector<Trial>    trials;
        for (unsigned int i = 0; i < values.size(); ++i)
          {
            trials.push_back({values, name + "," + plan.unknowns[i].name});
            trials.back().values[i] = nearby(values[i], plan.unknowns[i]);
          }
        if (const auto status = run(trials); status != RunStatus::finished)
          throw Ended{status};
        known_derivatives.resize(here.size(), values.size());
        for (unsigned int i = 0; i < values.size(); ++i)
          {
            const auto  &unknown     = plan.unknowns[i];
            const double change      = unknown.on_scale(trials[i].values[i]) - unknown.on_scale(values[i]);
            known_derivatives.col(i) = (residuals_of(curves_of(trials[i])) - here) / change;
            check_dependence(i);
          }
        values_of_derivatives = values;
        return known_derivatives;
      }

      /// By how much straight lines between steps differ from what stands for the curve, as residuals.
      double
      error_between_steps(const std::vector<Curve> &curves) const
      {
        double largest = 0.;
        for (unsigned int d = 0; d < plan.data.size(); ++d)
          for (std::size_t i = 0; i < plan.data[d].measured.x.size(); ++i)
            {
              const auto value = curves[d].value(plan.data[d].measured.x[i]);
              largest          = std::max(largest, std::abs(value.y - value.by_line) / deviation(d, i));
            }
        return largest;
      }

      /// Of each data set, with values whose residuals are known.
      const std::vector<Curve> &
      curves_with(const std::vector<double> &values) const
      {
        return trials_done.at(values);
      }

      std::vector<Curve> at_start; ///< of each data set
      unsigned int       n_runs = 0;

    private:
      /// "001", "002", ...
      std::string
      numbered()
      {
        return dealii::Utilities::int_to_string(++n_trials, 3);
      }

      std::string
      path_of(const Trial &trial, const unsigned int s) const
      {
        return Output::path_inside(folder, trial.name + (plan.scenes.size() > 1 ? "," + plan.scenes[s].name : ""),
                                   "section Fit");
      }

      /// Runs need no field files here.
      ParameterFile
      file_of(const Trial &trial, const unsigned int s) const
      {
        ParameterFile one = scene;
        for (const auto &assignment : plan.scenes[s].set)
          one.set(assignment);
        for (unsigned int i = 0; i < plan.unknowns.size(); ++i)
          one.set("Constants/" + plan.unknowns[i].name + "=" + shortest(trial.values[i]));
        for (const std::string entry :
             {"Point fields=none", "Grid fields=false", "Fields every=0", "Keep states=false"})
          one.set("Output/" + entry);
        return one;
      }

      /// All scenes with the values of all trials.
      RunStatus
      run(const std::vector<Trial> &trials)
      {
        const unsigned int n_scenes = plan.scenes.size();
        const unsigned int ranks    = dealii::Utilities::MPI::n_mpi_processes(comm);
        const std::size_t  n        = trials.size() * n_scenes;
        const unsigned int most     = options.at_once > 0 ? options.at_once : ranks;
        n_runs += n;
        return side_by_side(n, std::min<std::size_t>(most, n), comm, [&](const std::size_t i, const Group &group) {
          const auto &trial = trials[i / n_scenes];
          const auto  path  = path_of(trial, i % n_scenes);
          RunRecord   record;
          Log::line("Run " + path);
          const auto status = run_or_keep(file_of(trial, i % n_scenes), path, {options.overwrite, options.resume},
                                          record, group.comm);
          return stop_requested(group.comm) ? RunStatus::stopped : status;
        });
      }

      std::vector<Curve>
      curves_of(const Trial &trial) const
      {
        std::vector<Curve> found;
        for (const auto &data : plan.data)
          found.push_back(read_curve(path_of(trial, data.scene), data.columns.x, data.columns.y, data.where, comm));
        return found;
      }

      double
      deviation(const unsigned int d, const std::size_t i) const
      {
        const auto &measured = plan.data[d].measured;
        return measured.deviation.empty() ? sizes[d] : measured.deviation[i];
      }

      Eigen::VectorXd
      residuals_of(const std::vector<Curve> &of_data) const
      {
        Eigen::VectorXd result(plan.n_data());
        unsigned int    k = 0;
        for (unsigned int d = 0; d < plan.data.size(); ++d)
          for (std::size_t i = 0; i < plan.data[d].measured.x.size(); ++i)
            result[k++] = (of_data[d].value(plan.data[d].measured.x[i]).y - plan.data[d].measured.y[i]) /
                          deviation(d, i);
        return result;
      }

      /// What was measured beyond the end of the run says nothing.
      void
      check_reach(const std::vector<Curve> &curves) const
      {
        for (unsigned int d = 0; d < plan.data.size(); ++d)
          for (std::size_t i = 0; i < plan.data[d].measured.x.size(); ++i)
            if (const double x = plan.data[d].measured.x[i]; !curves[d].reaches(x))
              throw UserError(plan.data[d].file + ":" + std::to_string(plan.data[d].measured.line[i]),
                              "'" + plan.data[d].columns.x + "' is " + brief(x) + " here, but goes from " +
                                brief(curves[d].x.front()) + " to " + brief(curves[d].x.back()) +
                                " in the run; let the scene go farther, or leave the line out");
      }

      /// A value near by, within the bounds.
      double
      nearby(const double value, const Unknown &unknown) const
      {
        const double step = unknown.logarithmic ?
                              plan.difference * value :
                              plan.difference * std::max(std::abs(value), .01 * (unknown.upper - unknown.lower));
        return value + step <= unknown.upper ? value + step : value - step;
      }

      /// Of the constant at the start: one that changes no measured value by 1e-4 of it, when it doubles, is not found.
      void
      check_dependence(const unsigned int i) const
      {
        if (values_of_derivatives.empty() && known_derivatives.col(i).cwiseAbs().maxCoeff() < 1e-4)
          throw UserError("section Fit", "none of the measured values depends on '" + plan.unknowns[i].name +
                                           "' at the start; do not fit it, or measure something else");
      }

      std::string
      text_of(const std::vector<double> &values) const
      {
        std::vector<std::string> words;
        for (unsigned int i = 0; i < values.size(); ++i)
          words.push_back(plan.unknowns[i].name + " = " + brief(values[i]));
        return join(words, ", ");
      }

      const ParameterFile &scene;
      const FitPlan       &plan;
      const FitOptions    &options;
      const std::string   &folder;
      MPI_Comm             comm;
      std::vector<double>  sizes; ///< of each data set: its largest value
      unsigned int         n_trials = 0;
      std::vector<double>  values_of_derivatives;
      Eigen::MatrixXd      known_derivatives;

      std::map<std::vector<double>, std::vector<Curve>> trials_done;
    };

    /// Reads each scene once before the first run.
    void
    check_scenes(const ParameterFile &scene, const FitPlan &plan, const MPI_Comm comm)
    {
      for (const auto &one : plan.scenes)
        {
          ParameterFile file = scene;
          for (const auto &assignment : one.set)
            file.set(assignment);
          read_only(file, comm);
        }
    }

    std::vector<double>
    values_of(const LeastSquares &found)
    {
      std::vector<double> values;
      for (const auto &estimate : found.estimates)
        values.push_back(estimate.value);
      return values;
    }

    void
    add_warnings(const SceneModel &model, FitReport &report)
    {
      report.warnings = report.found.warnings;
      if (!report.found.converged)
        report.warnings.push_back("the search did not end; give more 'Most steps', a better 'Start', or closer bounds");
      if (const double error = model.error_between_steps(report.at_end); error > report.found.noise && error > 1e-6)
        report.warnings.push_back("the steps of the run are too long for its curve: between them it is uncertain by " +
                                  brief(error) + ", more than the noise; let 'Time/Largest step' be smaller");
      for (const auto &warning : report.warnings)
        Log::warning(warning);
    }
  } // namespace

  RunStatus
  run_fit(const ParameterFile &file, const FitOptions &options, const MPI_Comm comm)
  {
    const FitPlan       plan  = read_fit_plan(file, comm);
    const ParameterFile scene = file.without("Fit").without("Study");
    if (options.at_once > 0)
      check_groups(options.at_once, comm);
    Output::RunFolder folder({options.output, file.path(), options.overwrite, options.resume}, comm);
    check_scenes(scene, plan, comm);
    folder.open();
    SceneModel model(scene, plan, options, folder.path(), comm);
    try
      {
        FitReport report;
        report.found = least_squares(plan.unknowns,
                                     {plan.n_data(), [&](const auto &values) { return model.residuals(values); },
                                      [&](const auto &values) { return model.derivatives(values); }},
                                     plan.most);
        if (model.at_start.empty())
          throw Ended{RunStatus::failed};
        report.at_start = model.at_start;
        report.at_end   = model.curves_with(values_of(report.found));
        report.n_runs   = model.n_runs;
        add_warnings(model, report);
        on_root(comm, [&] { write_fit(plan, report, folder.path()); });
        draw_picture("plot_fit.py", folder.path(), comm);
        Log::line("\n" + fit_table(plan, report) + "Results in " + folder.path());
        return report.found.converged ? RunStatus::finished : RunStatus::failed;
      }
    catch (const Ended &ended)
      {
        Log::warning(ended.status == RunStatus::stopped ?
                       "the fit was stopped; continue with --resume" :
                       "a run of the fit failed, so the search cannot go on; give closer "
                       "bounds or another start");
        return ended.status;
      }
  }
} // namespace Stroma::Studies
