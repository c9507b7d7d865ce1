#include <stroma/base/parameters.h>
#include <stroma/base/text.h>
#include <stroma/base/unknown_entries.h>
#include <stroma/output/folder.h>
#include <stroma/simulation/simulation.h>
#include <stroma/studies/plan.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

namespace Stroma::Studies
{
  namespace
  {
    const std::set<std::string> own_sections = {"Cases", "Error", "Reference"};

    bool
    has(const std::vector<std::string> &names, const std::string &name)
    {
      return std::find(names.begin(), names.end(), name) != names.end();
    }

    std::string
    last_part(const std::string &parameter)
    {
      return parameter.substr(parameter.find_last_of('/') + 1);
    }

    void
    read_set(Parameters &p, std::vector<std::string> &set)
    {
      std::string text;
      p.add("Set", text, "entries to set, as Section/name = value, separated by commas");
      set = assignments(text);
      for (const auto &one : set)
        if (one.find('=') == std::string::npos || one.find('=') == 0)
          throw UserError(p.where("Set"),
                          "'Set' was given as '" + shown(text) + "'; it must be a list of Section/name = value");
    }

    void
    read_cases(Parameters &p, StudyPlan &plan)
    {
      const auto section = p.section("Cases", "one subsection a curve; without it there is one");
      for (const auto &name : p.names("case"))
        {
          const auto subsection = p.section(name);
          StudyCase  one;
          one.name = name;
          read_set(p, one.set);
          one.where = p.where("Set");
          plan.cases.push_back(one);
        }
      if (plan.cases.empty())
        plan.cases.emplace_back();
    }

    /// The parts between commas; parentheses keep commas together, and fall away around a whole part.
    std::vector<std::string>
    values_of(const std::string &text)
    {
      std::vector<std::string> values;
      std::string              value;
      int                      depth = 0;
      const auto               take  = [&] {
        value = trim(value);
        if (value.size() > 1 && value.front() == '(' && value.back() == ')' && value.find(')') == value.size() - 1)
          value = trim(value.substr(1, value.size() - 2));
        values.push_back(value);
        value.clear();
      };
      for (const char c : text)
        {
          depth += c == '(' ? 1 : c == ')' ? -1 : 0;
          if (c == ',' && depth == 0)
            take();
          else
            value += c;
        }
      if (!trim(text).empty())
        take();
      return values;
    }

    /// The numbers that a value consists of; none where it is a word.
    std::vector<double>
    components_of(const Parameters &p, const std::string &value)
    {
      std::vector<double> numbers;
      try
        {
          for (const auto &part : split(value, ','))
            numbers.push_back(p.parse_number("Values", part, ""));
        }
      catch (const UserError &)
        {
          numbers.clear();
        }
      return numbers;
    }

    /// Whether @p b is @p a times a number.
    bool
    is_multiple(const std::vector<double> &a, const std::vector<double> &b)
    {
      constexpr double round_off = 1e-12;
      bool             same      = a.size() == b.size() && a[0] != 0.;
      for (std::size_t i = 1; i < a.size() && same; ++i)
        same = std::abs(a[0] * b[i] - a[i] * b[0]) <= round_off * std::abs(a[i] * b[0]);
      return same;
    }

    /**
     * The numbers along an axis that values stand for: their first components if all values are multiples of the first one, as
     * (5, 10) and (10, 20), else that of each whose components are equal. Others, and words, are not a number.
     */
    std::vector<double>
    numbers_along(const Parameters &p, const std::vector<std::string> &values)
    {
      std::vector<std::vector<double>> all;
      for (const auto &value : values)
        all.push_back(components_of(p, value));
      const auto          first = std::find_if(all.begin(), all.end(), [](const auto &one) { return !one.empty(); });
      const bool          alike = std::all_of(first, all.end(),
                                              [&](const auto &one) { return one.empty() || is_multiple(*first, one); });
      std::vector<double> numbers;
      for (const auto &one : all)
        {
          const bool is_number = !one.empty() && (alike || std::set<double>(one.begin(), one.end()).size() == 1);
          numbers.push_back(is_number ? one[0] : std::nan(""));
        }
      return numbers;
    }

    void
    read_varied(Parameters &p, const std::string &name, StudyPlan &plan)
    {
      const auto section = p.section(name);
      Varied     varied;
      varied.name = name;
      if (!p.given("Parameter") &&
          std::any_of(own_sections.begin(), own_sections.end(), [&](const auto &own) { return resembles(name, own); }))
        throw UnknownEntry(p.where_section(), "section 'Study/" + shown(name) +
                                                "' names no 'Parameter' to vary; known here: any section with one, " +
                                                join({own_sections.begin(), own_sections.end()}, ", "));
      p.add("Parameter", varied.parameter, "entry to vary, as Section/name", true);
      std::string values;
      p.add("Values", values,
            "its values, from coarse to fine, between commas; one that holds commas stands in parentheses: "
            "(20, 20), (40, 40)");
      varied.values = values_of(values);
      p.add("Only", varied.only, "names of the cases that it applies to; default: all");
      varied.where = p.where("Values");
      if (varied.values.empty() && p.get_mode() == Parameters::Mode::read)
        throw UserError(p.where_section(), "'Values' is missing; list the values of '" + varied.parameter + "'");
      varied.numbers = numbers_along(p, varied.values);
      for (const auto &only : varied.only)
        if (std::none_of(plan.cases.begin(), plan.cases.end(), [&](const auto &c) { return c.name == only; }))
          {
            std::vector<std::string> known;
            for (const auto &one : plan.cases)
              known.push_back(one.name);
            throw UserError(p.where("Only"),
                            "'Only' names '" + shown(only) + "'; it must be of the cases: " + join(known, ", "));
          }
      plan.varied.push_back(varied);
    }

    /// @param name of the section over whose values means are taken, or ""
    void
    set_averaged(const Parameters &p, const std::string &name, StudyPlan &plan)
    {
      std::vector<std::string> known;
      for (unsigned int v = 0; v < plan.varied.size(); ++v)
        {
          known.push_back(plan.varied[v].name);
          if (known.back() == name)
            plan.averaged = v;
        }
      if (!name.empty() && plan.averaged < 0)
        throw UserError(p.where("Mean over"),
                        "'Mean over' was given as '" + shown(name) +
                          "'; it must be one of the sections that vary an entry: " + join(known, ", "));
    }

    void
    read_error(Parameters &p, StudyPlan &plan)
    {
      auto &error  = plan.error;
      error.wanted = has(p.subsections(), "Error");
      if (!error.wanted)
        return;
      const auto section   = p.section("Error", "difference of every run from a reference");
      double     time      = -1.;
      error.compare.fields = {"displacement_m"};
      p.add("Against", error.against,
            "exact, reference (the run of section Reference), or a run's folder or stored reference", true);
      p.add("Fields", error.compare.fields, "fields to compare; the first one is drawn");
      p.add_choice<ErrorNorm>("Norm", error.norm, "relative norm of the table",
                              {{"L2", ErrorNorm::L2}, {"H1", ErrorNorm::H1}, {"max", ErrorNorm::max}});
      if (p.given("Time"))
        p.add("Time", time, "when; default: the end", "s", Range::non_negative());
      p.add_choice<CompareOptions::Points>("Points", error.compare.points,
                                           "at the run's own points or on a common grid",
                                           {{"run", CompareOptions::Points::run},
                                            {"grid", CompareOptions::Points::grid}});
      p.add("Grid", error.compare.grid, "cells of the common grid along each axis", Range::at_least(1));
      if (error.compare.fields.empty())
        throw UserError(p.where("Fields"), "'Fields' is empty; name the fields to compare, for example displacement_m");
      for (auto &field : error.compare.fields)
        {
          const auto known = comparable_fields();
          field            = full_field_name(field);
          if (!has(known, field))
            throw UserError(p.where("Fields"),
                            "'Fields' names '" + shown(field) + "'; it must be of: " + join(known, ", "));
        }
      if (error.norm == ErrorNorm::H1 && error.compare.fields[0] != "displacement_m" &&
          error.compare.fields[0] != "velocity_m_per_s")
        throw UserError(p.where("Norm"),
                        "'Norm = H1' is for 'Fields = displacement_m' or 'velocity_m_per_s'; choose L2 or max");
      if (p.given("Grid") && error.compare.points != CompareOptions::Points::grid)
        throw UserError(p.where("Grid"), "'Grid' is for 'Points = grid'; set it or remove 'Grid'");
      if (time >= 0.)
        error.compare.times = {time};
      error.compare.only_last = true;
    }

    void
    read_reference(Parameters &p, StudyPlan &plan)
    {
      if (!has(p.subsections(), "Reference"))
        {
          if (plan.error.against == "reference")
            throw UserError(p.where_section(),
                            "'Against = reference' needs a section Reference; say there by 'Set' how the "
                            "reference differs from the scene");
          return;
        }
      const auto section = p.section("Reference", "the run that others are compared with");
      read_set(p, plan.error.reference);
      plan.error.where_reference = p.where("Set");
      if (plan.error.against != "reference")
        throw UserError(p.where_section(),
                        "section Reference is for 'Error/Against = reference'; set it or remove the section");
    }

    /// All entries of sections Error and Reference as text.
    std::string
    error_key(const ParameterFile &file)
    {
      std::string text;
      for (const auto &entry : file.entries())
        if (entry.section.size() == 2 && entry.section[0] == "Study" &&
            (entry.section[1] == "Error" || entry.section[1] == "Reference") && entry.name != "Norm")
          text += entry.section[1] + "/" + entry.name + "=" + entry.value + "\n";
      return text;
    }

    /// @p name with '_' for what had better not stand in the name of a folder.
    std::string
    as_folder(std::string name)
    {
      for (char &c : name)
        if (const auto byte = static_cast<unsigned char>(c);
            byte < 0x80 && std::isalnum(byte) == 0 && std::string("_-+.,=()%").find(c) == std::string::npos)
          c = '_';
      return name;
    }

    constexpr std::size_t most_runs = 10000, longest_folder = 200;

    /// The runs of one case: all combinations of the values that apply to it, the last one fastest.
    void
    add_runs(StudyPlan &plan, const unsigned int in_case)
    {
      const auto               &one = plan.cases[in_case];
      std::vector<unsigned int> applies;
      std::size_t               n = 1;
      for (unsigned int v = 0; v < plan.varied.size(); ++v)
        {
          const auto &only = plan.varied[v].only;
          if (only.empty() || has(only, one.name))
            {
              applies.push_back(v);
              n *= plan.varied[v].values.size();
              if (n + plan.runs.size() > most_runs)
                throw UserError(plan.varied[v].where, "the study would have more than " + counted(most_runs, "run") +
                                                        ", all combinations of the values; list fewer values");
            }
        }
      for (std::size_t i = 0; i < n; ++i)
        {
          PlannedRun run;
          run.in_case = in_case;
          run.set     = one.set;
          run.values.assign(plan.varied.size(), "-");
          std::vector<std::string> folder, curve;
          if (!one.name.empty())
            folder.push_back(one.name);
          curve            = folder;
          std::size_t rest = n, place = i;
          for (const unsigned int v : applies)
            {
              const auto &varied = plan.varied[v];
              rest /= varied.values.size();
              const std::size_t which = place / rest;
              place %= rest;
              run.values[v] = varied.values[which];
              run.set.push_back(varied.parameter + "=" + run.values[v]);
              folder.push_back(last_part(varied.parameter) + "=" + run.values[v]);
              if (v != applies.back())
                curve.push_back(folder.back());
              else
                {
                  run.axis        = v;
                  run.axis_number = varied.numbers[which];
                  run.coarser     = which > 0 ? static_cast<int>(plan.runs.size()) - 1 : -1;
                }
            }
          run.folder = as_folder(join(folder, ","));
          if (run.folder.size() > longest_folder)
            throw UserError(applies.empty() ? one.where : plan.varied[applies.back()].where,
                            "the folder '" + shown(run.folder) + "' of a run would have a name of more than " +
                              std::to_string(longest_folder) +
                              " letters; vary a constant of section Constants instead");
          run.curve = join(curve, ", ");
          plan.runs.push_back(run);
        }
    }

    /// The folders of the runs, which must differ from each other and from what a study writes.
    void
    check_folders(const Parameters &p, const StudyPlan &plan)
    {
      std::set<std::string> folders{"reference", "states",    "study.csv", "study.txt", "study.json",
                                    "study.png", "means.csv", "means.txt", "means.png"};
      for (const auto &run : plan.runs)
        {
          const auto &of_case = plan.cases[run.in_case].where;
          Output::path_inside("", run.folder, of_case.empty() ? p.where_section() : of_case);
        }
      for (const auto &run : plan.runs)
        if (!folders.insert(run.folder).second)
          throw UserError(p.where_section(), "two runs would be called '" + run.folder +
                                               "'; rename a case, or remove a value that is there twice");
    }

    /// Declares the entries of section Study and reads them.
    StudyPlan
    read_entries(Parameters &p)
    {
      StudyPlan  plan;
      const auto names = p.subsections();
      if (!has(names, "Error"))
        plan.results = {"reaction_force_y_N"};
      p.add("Results", plan.results, "results to tabulate");
      plan.where_results = p.given("Results") ? p.where("Results") : "";
      p.add("Reference", plan.published, "published values of the first result, one a run; - for none");
      std::string mean_over;
      p.add("Mean over", mean_over,
            "section of an entry, as of seeds: means and standard errors over its values are told");
      p.add("Repeat", plan.repeat, "how often a short run is done, for its time", Range::at_least(1));
      p.add("Repeat below", plan.repeat_below, "wall time in seconds up to which a run is short", "",
            Range::non_negative());
      p.all_declared();
      read_cases(p, plan);
      for (const auto &name : names)
        if (own_sections.count(name) == 0)
          read_varied(p, name, plan);
      set_averaged(p, mean_over, plan);
      if (plan.varied.empty() && plan.cases.size() == 1 && p.get_mode() == Parameters::Mode::read)
        throw UserError(p.where_section(),
                        "nothing to vary; add subsections with 'Parameter' and 'Values' to section Study");
      read_error(p, plan);
      read_reference(p, plan);
      return plan;
    }

    StudyPlan
    plan_of(const ParameterFile &file)
    {
      Parameters p(file);
      StudyPlan  plan;
      {
        const auto section = p.section("Study", "one scene over many values");
        plan               = read_entries(p);
        plan.error.key     = error_key(file);
        for (unsigned int c = 0; c < plan.cases.size(); ++c)
          add_runs(plan, c);
        check_folders(p, plan);
        if (!plan.published.empty() && (plan.results.empty() || plan.published.size() != plan.runs.size()))
          throw UserError(p.where("Reference"), "'Reference' has " + counted(plan.published.size(), "value") + " for " +
                                                  counted(plan.runs.size(), "run") + "; give one a run");
        for (auto &value : plan.published)
          if (value != "-")
            value = shortest(p.parse_number("Reference", value, ""));
      }
      p.finish();
      return plan;
    }

    /// Throws UnknownEntry for what is no entry of section Study.
    void
    look_for_unknown(const ParameterFile &file)
    {
      Parameters p(file, Parameters::Mode::document);
      unknown_first(
        [&] {
          const auto section = p.section("Study");
          read_entries(p);
        },
        [&] { p.finish_declared(); });
      p.finish();
    }
  } // namespace

  std::vector<std::string>
  assignments(const std::string &text)
  {
    std::vector<std::string> parts;
    for (const auto &part : split(text, ','))
      if (part.find('=') != std::string::npos || parts.empty())
        parts.push_back(part);
      else
        parts.back() += ", " + part;
    return parts;
  }

  StudyPlan
  read_plan(const ParameterFile &whole, const MPI_Comm comm)
  {
    const ParameterFile file = whole.only({"Study", "Units", "Constants"});
    return unknown_first([&] { return plan_of(file); },
                         [&] {
                           look_for_unknown(file);
                           parameter_template(whole.without("Study").without("Fit"), comm);
                         });
  }
} // namespace Stroma::Studies
