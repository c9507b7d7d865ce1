#include <stroma/base/constants_in_use.h>
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
#include <filesystem>
#include <map>
#include <numeric>
#include <regex>

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
        const auto curves = curves_of({{values, numbered()}})[0];
        if (curves.empty())
          return {};
        if (trials_done.empty())
          at_start = curves;
        trials_done[values] = curves;
        const auto result   = residuals_of(curves);
        Log::line("fit: " + text_of(values) + "; differences of " +
                  brief(std::sqrt(result.squaredNorm() / result.size())) + " (root mean square)");
        return result;
      }

      /// Empty if runs failed on both sides of a value.
      Eigen::MatrixXd
      derivatives(const std::vector<double> &values)
      {
        if (values == values_of_derivatives)
          return known_derivatives;
        Eigen::MatrixXd           found(plan.n_data(), values.size());
        std::vector<unsigned int> missing(values.size());
        std::iota(missing.begin(), missing.end(), 0u);
        for (const bool other_side : {false, true})
          if (!missing.empty())
            missing = add_differences(values, missing, other_side, found);
        if (!missing.empty())
          {
            failed_derivatives = "runs with '" + plan.unknowns[missing[0]].name + "' changed a little from " +
                                 text_of(values) +
                                 " failed, or ended before the data, so that there are no derivatives "
                                 "and no intervals; give closer bounds, another start, or another 'Difference'";
            return Eigen::MatrixXd();
          }
        if (values_of_derivatives.empty())
          check_dependence(values, found);
        values_of_derivatives = values;
        known_derivatives     = found;
        return found;
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
      unsigned int       n_runs  = 0;
      unsigned int       n_short = 0; ///< trials that did not reach the data
      std::string        first_short, failed_derivatives;

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
        for (const std::string entry : {"Image fields=", "Point fields=none", "Grid fields=false", "Fields every=0",
                                        "Keep states=false", "Results by material=none", "Results by body=none"})
          one.set("Output/" + entry);
        return one;
      }

      /// All scenes with the values of all trials; which of them failed.
      std::vector<unsigned int>
      run(const std::vector<Trial> &trials)
      {
        const unsigned int        n_scenes = plan.scenes.size();
        const unsigned int        ranks    = dealii::Utilities::MPI::n_mpi_processes(comm);
        const std::size_t         n        = trials.size() * n_scenes;
        const unsigned int        most     = options.at_once > 0 ? options.at_once : ranks;
        std::vector<unsigned int> failed(trials.size(), 0);
        n_runs += n;
        const auto worst = side_by_side(n, std::min<std::size_t>(most, n), comm, [&](const auto i, const auto &group) {
          const auto &trial = trials[i / n_scenes];
          const auto  path  = path_of(trial, i % n_scenes);
          RunRecord   record;
          Log::line("Run " + path);
          const auto status = run_or_keep(file_of(trial, i % n_scenes), path, {options.overwrite, options.resume},
                                          record, group.comm);
          if (status == RunStatus::failed)
            failed[i / n_scenes] = 1;
          return stop_requested(group.comm) ? RunStatus::stopped : status;
        });
        if (worst == RunStatus::stopped)
          throw Ended{worst};
        dealii::Utilities::MPI::max(failed, comm, failed);
        return failed;
      }

      /// Of each data set with each trial, after its runs; none if one failed or does not reach the data.
      std::vector<std::vector<Curve>>
      curves_of(const std::vector<Trial> &trials)
      {
        const auto                      failed = run(trials);
        std::vector<std::vector<Curve>> found(trials.size());
        for (std::size_t t = 0; t < trials.size(); ++t)
          if (failed[t] == 0)
            {
              for (const auto &data : plan.data)
                found[t].push_back(
                  read_curve(path_of(trials[t], data.scene), data.columns.x, data.columns.y, data.where, comm));
              if (!reaches_data(trials[t], found[t]))
                found[t].clear();
            }
        return found;
      }

      /**
       * Adds the columns of derivatives by the constants @p which, from runs on one side of their values.
       * @return constants without such a run
       */
      std::vector<unsigned int>
      add_differences(const std::vector<double> &values, const std::vector<unsigned int> &which, const bool other_side,
                      Eigen::MatrixXd &columns)
      {
        const Eigen::VectorXd     here = residuals(values);
        const auto                name = numbered();
        std::vector<Trial>        trials;
        std::vector<unsigned int> of_trials, missing;
        for (const unsigned int i : which)
          if (const double near = nearby(values[i], plan.unknowns[i], other_side);
              near >= plan.unknowns[i].lower && near <= plan.unknowns[i].upper)
            {
              trials.push_back({values, name + "," + plan.unknowns[i].name});
              trials.back().values[i] = near;
              of_trials.push_back(i);
            }
          else
            missing.push_back(i);
        if (trials.empty())
          return missing;
        const auto curves = curves_of(trials);
        for (std::size_t t = 0; t < trials.size(); ++t)
          if (const unsigned int i = of_trials[t]; curves[t].empty())
            missing.push_back(i);
          else
            columns.col(i) = (residuals_of(curves[t]) - here) /
                             (plan.unknowns[i].on_scale(trials[t].values[i]) - plan.unknowns[i].on_scale(values[i]));
        return missing;
      }

      double
      deviation(const unsigned int d, const std::size_t i) const
      {
        const auto &measured = plan.data[d].measured;
        return measured.deviation.empty() ? sizes[d] : measured.deviation[i];
      }

      /// By measured value: what residuals count it in, over the largest value that its data set has with @p values.
      Eigen::VectorXd
      deviations_over_computed(const std::vector<double> &values) const
      {
        constexpr double noise  = 1e-6; // of the largest measured value: what is smaller may be rounded off in a run
        const auto      &curves = curves_with(values);
        Eigen::VectorXd  result(plan.n_data());
        unsigned int     k = 0;
        for (unsigned int d = 0; d < plan.data.size(); ++d)
          {
            double largest = noise * sizes[d];
            for (const double x : plan.data[d].measured.x)
              largest = std::max(largest, std::abs(curves[d].value(x).y));
            for (std::size_t i = 0; i < plan.data[d].measured.x.size(); ++i)
              result[k++] = deviation(d, i) / largest;
          }
        return result;
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

      /// What was measured beyond the ends of a run says nothing: refused at the start, and later the trial failed.
      bool
      reaches_data(const Trial &trial, const std::vector<Curve> &curves)
      {
        for (unsigned int d = 0; d < plan.data.size(); ++d)
          for (std::size_t i = 0; i < plan.data[d].measured.x.size(); ++i)
            if (const double x = plan.data[d].measured.x[i]; !curves[d].reaches(x))
              {
                const std::string where = plan.data[d].file + ":" + std::to_string(plan.data[d].measured.line[i]);
                if (trials_done.empty())
                  throw UserError(where, beyond_run(curves[d], plan.data[d].columns.x, x));
                Log::line("fit: run " + trial.name + " does not reach the data at " + where + ": taken as failed");
                if (n_short++ == 0)
                  first_short = where + ", with " + text_of(trial.values);
                return false;
              }
        return true;
      }

      /// A value near by, within the bounds on at least one side.
      double
      nearby(const double value, const Unknown &unknown, const bool other_side) const
      {
        const double step = std::min(plan.difference * unknown.size(value), .25 * (unknown.upper - unknown.lower));
        return (value + step <= unknown.upper) != other_side ? value + step : value - step;
      }

      /// At the start: a constant is not found that changes no value by 1e-4, when it doubles, neither of what was measured nor
      /// of what was computed, which is far smaller where the start is far off.
      void
      check_dependence(const std::vector<double> &values, const Eigen::MatrixXd &by_unknowns) const
      {
        const Eigen::VectorXd over_computed = deviations_over_computed(values);
        for (unsigned int i = 0; i < values.size(); ++i)
          if (const Eigen::VectorXd slopes = by_unknowns.col(i);
              !depends(slopes, values[i], plan.unknowns[i]) &&
              !depends(slopes.cwiseProduct(over_computed), values[i], plan.unknowns[i]))
            throw UserError(plan.unknowns[i].where, "none of the measured values depends on '" + plan.unknowns[i].name +
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

    /// Removes the runs of an earlier fit, "001", "002,ratio,stretched", ...: this one may have fewer. Local.
    void
    remove_runs(const std::string &folder)
    {
      static const std::regex form("[0-9]{3,}(,.*)?");
      std::error_code         code;
      for (const auto &entry : std::filesystem::directory_iterator(folder, code))
        if (const auto name = entry.path().filename().string(); entry.is_directory(code) && !entry.is_symlink(code) &&
                                                                std::regex_match(name, form) &&
                                                                Output::holds_results(entry.path()))
          Output::remove_run(entry.path());
    }

    /// Reads each scene once before the first run.
    void
    check_scenes(const ParameterFile &scene, const FitPlan &plan, const MPI_Comm comm)
    {
      for (const auto &one : plan.scenes)
        read_only(with_assignments(scene, one.set), comm);
    }

    std::vector<double>
    values_of(const LeastSquares &found)
    {
      std::vector<double> values;
      for (const auto &estimate : found.estimates)
        values.push_back(estimate.value);
      return values;
    }

    /// Where curves are straight lines between steps, error_between_steps() knows nothing.
    void
    add_warnings_of_lines(const FitPlan &plan, FitReport &report)
    {
      for (unsigned int d = 0; d < plan.data.size(); ++d)
        {
          const auto &curve = report.at_end[d];
          const auto &x     = plan.data[d].measured.x;
          if (std::any_of(x.begin(), x.end(), [&](const double at) { return curve.is_only_line(at); }))
            report.warnings.push_back("the run has " + counted(curve.x.size(), "row") + " only for '" +
                                      plan.data[d].name +
                                      "', and data lie between them, where straight lines stand for "
                                      "its curve; let 'Time/Largest step' be smaller");
        }
    }

    void
    add_warnings(const FitPlan &plan, const SceneModel &model, FitReport &report)
    {
      report.warnings = report.found.warnings;
      if (!report.found.has_derivatives)
        report.warnings.push_back(model.failed_derivatives);
      else if (!report.found.converged)
        report.warnings.push_back("the search did not end; give more 'Most steps', a better 'Start', or closer bounds");
      if (const double error = model.error_between_steps(report.at_end); error > report.found.noise && error > 1e-6)
        report.warnings.push_back("the steps of the run are too long for its curve: between them it is uncertain by " +
                                  brief(error) + ", more than the noise; let 'Time/Largest step' be smaller");
      if (model.n_short > 0)
        report.warnings.push_back("runs that do not reach all data were taken as failed, in " +
                                  counted(model.n_short, "trial") + " (first " + model.first_short +
                                  "); let the scene go farther");
      add_warnings_of_lines(plan, report);
      for (const auto &warning : report.warnings)
        Log::warning(warning);
    }
  } // namespace

  void
  check_fit(const ParameterFile &file, const MPI_Comm comm)
  {
    check_scenes(file.without("Fit"), read_fit_plan(file, comm), comm);
  }

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
    if (options.overwrite)
      on_root(comm, [&] { remove_runs(folder.path()); });
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
        add_warnings(plan, model, report);
        on_root(comm, [&] { write_fit(plan, report, folder.path()); });
        draw_picture("plot_fit.py", folder.path(), comm);
        Log::line("\n" + fit_table(plan, report) + "Results in " + folder.path());
        return report.found.converged ? RunStatus::finished : RunStatus::failed;
      }
    catch (const Ended &ended)
      {
        Log::warning(ended.status == RunStatus::stopped ?
                       "the fit was stopped; continue with --resume" :
                       "the run at the start failed, so that there is nothing to search from; give another start");
        return ended.status;
      }
  }
} // namespace Stroma::Studies
