#include <stroma/base/text.h>
#include <stroma/output/text_file.h>
#include <stroma/studies/fit_report.h>
#include <stroma/studies/text_table.h>

#include <nlohmann/json.hpp>

#include <cmath>

namespace Stroma::Studies
{
  namespace
  {
    using Json = nlohmann::ordered_json; // which writes what is not finite as null

    Json
    unknowns_of(const FitPlan &plan, const LeastSquares &found)
    {
      Json list = Json::array();
      for (unsigned int i = 0; i < plan.unknowns.size(); ++i)
        {
          const auto &unknown  = plan.unknowns[i];
          const auto &estimate = found.estimates[i];
          Json        row      = Json::array();
          for (unsigned int j = 0; j < found.correlation.cols(); ++j)
            row.push_back(found.correlation(i, j));
          list.push_back({{"name", unknown.name},
                          {"value", estimate.value},
                          {"confidence_95", {estimate.lower, estimate.upper}},
                          {"start", unknown.start},
                          {"bounds", {unknown.lower, unknown.upper}},
                          {"scale", unknown.logarithmic ? "logarithmic" : "linear"},
                          {"at_bound", estimate.at_bound},
                          {"correlation", row}});
        }
      return list;
    }

    Json
    data_of(const FitPlan &plan, const FitReport &report)
    {
      Json list = Json::array();
      for (unsigned int d = 0; d < plan.data.size(); ++d)
        {
          const auto &data = plan.data[d];
          list.push_back({{"name", data.name},
                          {"file", data.file},
                          {"against", data.columns.x},
                          {"quantity", data.columns.y},
                          {"x", data.measured.x},
                          {"y", data.measured.y},
                          {"deviation", data.measured.deviation}});
          for (const auto &[name, curves] : {std::pair("start", &report.at_start), std::pair("end", &report.at_end)})
            if (d < curves->size())
              list.back()[name] = {{"x", (*curves)[d].x}, {"y", (*curves)[d].y}};
        }
      return list;
    }

    Rows
    values_of(const FitPlan &plan, const FitReport &report)
    {
      Rows rows{{"data", "against", "x", "quantity", "measured", "model"}};
      for (unsigned int d = 0; d < report.at_end.size(); ++d)
        for (std::size_t i = 0; i < plan.data[d].measured.x.size(); ++i)
          {
            const auto &data = plan.data[d];
            rows.push_back({data.name, data.columns.x, text_of("%.9g", data.measured.x[i]), data.columns.y,
                            text_of("%.9g", data.measured.y[i]),
                            text_of("%.9g", report.at_end[d].value(data.measured.x[i]).y)});
          }
      return rows;
    }
  } // namespace

  std::string
  fit_table(const FitPlan &plan, const FitReport &report)
  {
    Rows rows{{"constant", "start", "value", "95 % from", "to"}};
    for (unsigned int i = 0; i < plan.unknowns.size(); ++i)
      {
        const auto &estimate = report.found.estimates[i];
        rows.push_back({plan.unknowns[i].name, text_of("%.6g", plan.unknowns[i].start), text_of("%.6g", estimate.value),
                        text_of("%.4g", estimate.lower), text_of("%.4g", estimate.upper)});
      }
    std::string text = aligned(rows);
    text += "  noise " + text_of("%.3g", report.found.noise) +
            " of the largest value of each curve, or of the given deviations; " + counted(plan.n_data(), "value") +
            ", " + counted(report.n_runs, "run") + "\n";
    for (const auto &warning : report.warnings)
      text += "  warning: " + warning + "\n";
    return text;
  }

  void
  write_fit(const FitPlan &plan, const FitReport &report, const std::string &folder)
  {
    const Json json = {{"converged", report.found.converged},
                       {"n_runs", report.n_runs},
                       {"n_evaluations", report.found.n_evaluations},
                       {"n_derivatives", report.found.n_derivatives},
                       {"noise", report.found.noise},
                       {"parameters", unknowns_of(plan, report.found)},
                       {"data", data_of(plan, report)},
                       {"warnings", report.warnings}};
    Output::write_atomically(folder + "/fit.csv", csv(values_of(plan, report)));
    Output::write_atomically(folder + "/fit.txt", fit_table(plan, report));
    Output::write_atomically(folder + "/fit.json",
                             json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"); // last: it is complete
  }
} // namespace Stroma::Studies
