#include <stroma/base/constants_in_use.h>
#include <stroma/base/parameters.h>
#include <stroma/base/text.h>
#include <stroma/base/unknown_entries.h>
#include <stroma/output/folder.h>
#include <stroma/simulation/simulation.h>
#include <stroma/studies/fit_plan.h>
#include <stroma/studies/plan.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Studies
{
  namespace
  {
    /// Whether an entry of the scene, or of how scenes differ, mentions a constant.
    bool
    is_mentioned(const ParameterFile &file, const std::string &constant)
    {
      return std::any_of(file.entries().begin(), file.entries().end(), [&](const auto &entry) {
        const bool is_of_fit = !entry.section.empty() && entry.section[0] == "Fit" && entry.name != "Set";
        return !is_of_fit && mentions(entry, constant);
      });
    }

    void
    check_bounds(const Parameters &p, const Unknown &unknown)
    {
      const std::string range = "between " + brief(unknown.lower) + " ('Lower') and " + brief(unknown.upper) +
                                " ('Upper')";
      if (!(unknown.lower < unknown.upper))
        throw UserError(p.where("Upper"),
                        "'Upper' (" + brief(unknown.upper) + ") must be above 'Lower' (" + brief(unknown.lower) + ")");
      if (unknown.logarithmic && !(unknown.lower > 0.))
        throw UserError(p.where("Lower"),
                        "'Lower' was given as " + brief(unknown.lower) +
                          "; on a logarithmic scale it must be positive; raise it, or set 'Scale = linear'");
      const bool is_above = unknown.start >= unknown.upper;
      if (is_above || !(unknown.lower < unknown.start))
        throw UserError(p.where(p.given("Start") ? "Start" :
                                is_above         ? "Upper" :
                                                   "Lower"),
                        "the start of '" + unknown.name + "', " + brief(unknown.start) + ", is not " + range +
                          "; widen the bounds, or give 'Start'");
    }

    void
    read_unknown(Parameters &p, const std::string &name, const ParameterFile &whole, FitPlan &plan)
    {
      const auto section = p.section(name, "a constant of section Constants");
      const bool reading = p.get_mode() == Parameters::Mode::read;
      const auto known   = p.constants().find(name);
      if (reading && (known == p.constants().end() || name == "pi"))
        {
          std::vector<std::string> names;
          for (const auto &constant : p.constants())
            if (constant.first != "pi")
              names.push_back(constant.first);
          throw UserError(p.where_section(), "'" + shown(name) + "' is no constant of section Constants, which has: " +
                                               (names.empty() ? "none" : join(names, ", ")) +
                                               "; name there what is to be fitted, and use the name where it acts");
        }
      Unknown unknown;
      unknown.name  = name;
      unknown.where = p.where_section();
      unknown.start = known == p.constants().end() ? std::nan("") : known->second;
      unknown.lower = unknown.upper = std::nan("");
      p.add("Lower", unknown.lower, "least value", "", Range::any());
      p.add("Upper", unknown.upper, "largest value", "", Range::any());
      p.add("Start", unknown.start, "where the search begins; default: the constant's value", "", Range::any());
      p.add_choice<bool>("Scale", unknown.logarithmic,
                         "steps and confidence intervals are of the number or its logarithm",
                         {{"logarithmic", true}, {"linear", false}});
      if (!reading)
        return;
      check_bounds(p, unknown);
      if (!is_mentioned(whole, name))
        throw UserError(p.where_section(), "nothing in the file depends on the constant '" + name +
                                             "'; use it in an entry, or do not fit it");
      plan.unknowns.push_back(unknown);
    }

    /// The scene of a data set; equal ones are run once.
    unsigned int
    scene_of(FitPlan &plan, const std::string &name, const std::vector<std::string> &set)
    {
      for (unsigned int s = 0; s < plan.scenes.size(); ++s)
        if (plan.scenes[s].set == set)
          return s;
      plan.scenes.push_back({name, set});
      return plan.scenes.size() - 1;
    }

    void
    read_data_set(Parameters &p, const std::string &name, const MPI_Comm comm, FitPlan &plan)
    {
      const auto section = p.section(name, "a curve that was measured");
      DataSet    data;
      data.name      = name;
      data.where     = p.where_section();
      data.columns.x = "time_s";
      std::string set;
      p.add_file("File", data.file, "comma-separated values with names of columns in the first line", "");
      p.add("Against", data.columns.x,
            "what it is measured against: a column of series.csv that only grows or falls, as time_s, strain_y");
      p.add("Quantity", data.columns.y, "what is measured: a column of series.csv, as reaction_force_y_N", true);
      p.add("Deviation", data.columns.deviation,
            "column of the file with standard deviations; without it noise is the same all along a curve, and unknown");
      p.add("Set", set, "how the scene differs for these data: Section/name = value, separated by commas");
      for (const auto &one : assignments(set))
        if (one.find('=') == std::string::npos || one.find('=') == 0)
          throw UserError(p.where("Set"),
                          "'Set' was given as '" + shown(set) + "'; it must be a list of Section/name = value");
      if (p.get_mode() == Parameters::Mode::document)
        return;
      data.scene    = scene_of(plan, name, assignments(set));
      data.measured = read_measured(data.file, data.columns, comm);
      plan.data.push_back(data);
    }

    void
    read_fit(Parameters &p, const ParameterFile &whole, const MPI_Comm comm, FitPlan &plan)
    {
      p.add("Difference", plan.difference, "for derivatives: change of a constant over itself", "",
            Range::open(0., .1));
      p.add("Most steps", plan.most, "steps of the search at most", Range::at_least(1));
      {
        const auto section = p.section("Parameters", "what is fitted, one subsection a constant");
        for (const auto &name : p.names("constant"))
          read_unknown(p, name, whole, plan);
        if (plan.unknowns.empty() && p.get_mode() == Parameters::Mode::read)
          throw UserError(
            p.where_section(),
            "nothing to fit; add a subsection with 'Lower' and 'Upper' for each constant to section Parameters");
      }
      const auto section = p.section("Data", "what was measured, one subsection a curve");
      for (const auto &name : p.names("data set"))
        read_data_set(p, name, comm, plan);
      if (plan.n_data() < plan.unknowns.size())
        throw UserError(p.where_section(), counted(plan.n_data(), "measured value") + " cannot tell " +
                                             counted(plan.unknowns.size(), "parameter") +
                                             " apart; give more data, or fit fewer");
    }
  } // namespace

  unsigned int
  FitPlan::n_data() const
  {
    unsigned int n = 0;
    for (const auto &one : data)
      n += one.measured.x.size();
    return n;
  }

  FitPlan
  read_fit_plan(const ParameterFile &whole, const MPI_Comm comm)
  {
    const auto file = whole.only({"Fit", "Units", "Constants"});
    const auto read = [&](const Parameters::Mode mode) {
      FitPlan    plan;
      Parameters p(file, mode);
      unknown_first(
        [&] {
          const auto section = p.section("Fit", "constants that make the scene's results equal to measured ones");
          read_fit(p, whole, comm, plan);
        },
        [&] { p.finish_declared(); });
      p.finish();
      return plan;
    };
    return unknown_first([&] { return read(Parameters::Mode::read); },
                         [&] {
                           read(Parameters::Mode::document);
                           parameter_template(whole.without("Study").without("Fit"), comm);
                         });
  }
} // namespace Stroma::Studies
