#include <stroma/base/text.h>
#include <stroma/studies/common_fields.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace Stroma::Studies
{
  namespace
  {
    /// The fields that have an H1 semi norm, and their gradients.
    const std::map<std::string, std::string> gradients = {{"displacement_m", "displacement_gradient"},
                                                          {"velocity_m_per_s", "velocity_gradient_per_s"}};

    bool
    contains(const std::vector<std::string> &names, const std::string &name)
    {
      return std::find(names.begin(), names.end(), name) != names.end();
    }

    bool
    is_gradient(const std::string &name)
    {
      return std::any_of(gradients.begin(), gradients.end(), [&](const auto &pair) { return pair.second == name; });
    }

    /// Whether a source knows its values at @p time.
    bool
    knows(const std::vector<double> &times, const double time)
    {
      return times.empty() || std::any_of(times.begin(), times.end(), [&](const double t) {
               return std::abs(t - time) <= 1e-9 * std::max(std::abs(t), std::abs(time));
             });
    }

    std::string
    in_words(const FieldSource &source)
    {
      std::vector<std::string> texts;
      for (const double time : source.times())
        texts.push_back(shortest(time));
      return source.name() + " has " + (texts.empty() ? "any time" : join(texts, ", ") + " s");
    }
  } // namespace

  std::vector<double>
  common_times(const FieldSource &a, const FieldSource &b, const CompareOptions &options)
  {
    std::vector<double> times;
    for (const double time : options.times.empty() ? a.times() : options.times)
      if (knows(a.times(), time) && knows(b.times(), time))
        times.push_back(time);
      else if (!options.times.empty())
        throw UserError("there is no state at " + shortest(time) + " s in both: " + in_words(a) + ", " + in_words(b) +
                        "; choose times that both have");
    if (times.empty())
      throw UserError("the two have no time in common: " + in_words(a) + ", " + in_words(b) +
                      "; set 'Output/Fields every' so that both keep states at the same times");
    if (options.only_last)
      times.erase(times.begin(), times.end() - 1);
    return times;
  }

  std::vector<std::string>
  common_fields(FieldSource &a, FieldSource &b, const CompareOptions &options)
  {
    const auto               of_a = names_of(a.fields()), of_b = names_of(b.fields());
    std::vector<std::string> common;
    for (const auto &name : of_a)
      if (contains(of_b, name) && !is_gradient(name))
        common.push_back(name);
    if (common.empty())
      throw UserError(a.name() + " has the fields " + join(of_a, ", ") + "; " + b.name() + " has none of them but " +
                      join(of_b, ", "));
    std::vector<std::string> asked;
    for (const auto &name : options.fields)
      asked.push_back(full_field_name(name));
    for (const auto &name : asked)
      for (const auto &[names, source] : {std::make_pair(of_a, &a), std::make_pair(of_b, &b)})
        if (!contains(names, name))
          throw UserError(source->name() + " has no field '" + shown(name) + "'; both have: " + join(common, ", "));
    return asked.empty() ? common : asked;
  }

  std::vector<std::string>
  with_gradients(const std::vector<std::string> &fields, FieldSource &a, FieldSource &b)
  {
    auto all = fields;
    for (const auto &[name, gradient] : gradients)
      if (contains(fields, name) && !contains(fields, gradient) && contains(names_of(a.fields()), gradient) &&
          contains(names_of(b.fields()), gradient))
        all.push_back(gradient);
    return all;
  }

  std::string
  gradient_of(const std::string &name)
  {
    const auto found = gradients.find(name);
    return found == gradients.end() ? "" : found->second;
  }

  std::vector<std::string>
  comparable_fields()
  {
    return {"displacement_m", "displacement_gradient", "velocity_m_per_s", "velocity_gradient_per_s",
            "von_mises_Pa",   "pressure_Pa",           "cauchy_stress_Pa"};
  }

  std::string
  full_field_name(const std::string &name)
  {
    for (const auto &known : {"displacement_m", "velocity_m_per_s", "von_mises_Pa", "pressure_Pa", "cauchy_stress_Pa"})
      if (std::string(known).rfind(name + "_m", 0) == 0 || std::string(known).rfind(name + "_Pa", 0) == 0)
        return known;
    return name;
  }
} // namespace Stroma::Studies
