#include <stroma/base/on_root.h>
#include <stroma/base/text.h>
#include <stroma/output/text_file.h>
#include <stroma/studies/run_record.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace Stroma::Studies
{
  namespace
  {
    using Json = nlohmann::ordered_json; // which writes what is not finite as null

    double
    number_of(const Json &json)
    {
      return json.is_null() ? std::nan("") : json.get<double>();
    }

    std::string
    as_text(const RunRecord &record)
    {
      Json json = {{"parameters", record.parameters},
                   {"status", record.status},
                   {"n_steps", record.n_steps},
                   {"newton_iterations", record.newton_iterations},
                   {"linear_iterations", record.linear_iterations},
                   {"wall_times_s", record.wall_times},
                   {"cpu_times_s", record.cpu_times},
                   {"peak_memory_bytes", record.peak_memory_bytes},
                   {"error_key", record.error_key},
                   {"results", Json::object()},
                   {"errors", Json::object()}};
      for (const auto &[name, value] : record.results)
        json["results"][name] = value;
      for (const auto &[field, norms] : record.errors)
        json["errors"][field] = norms;
      return json.dump(2) + "\n";
    }

    RunRecord
    parse(const std::string &text)
    {
      RunRecord  record;
      const Json json = Json::parse(text);
      json.at("parameters").get_to(record.parameters);
      json.at("n_steps").get_to(record.n_steps);
      json.at("newton_iterations").get_to(record.newton_iterations);
      json.at("linear_iterations").get_to(record.linear_iterations);
      json.at("wall_times_s").get_to(record.wall_times);
      json.at("cpu_times_s").get_to(record.cpu_times);
      json.at("peak_memory_bytes").get_to(record.peak_memory_bytes);
      json.at("error_key").get_to(record.error_key);
      for (const auto &[name, value] : json.at("results").items())
        record.results[name] = number_of(value);
      for (const auto &[field, norms] : json.at("errors").items())
        for (unsigned int n = 0; n < 3; ++n)
          record.errors[field][n] = number_of(norms.at(n));
      json.at("status").get_to(record.status);
      return record;
    }

    std::string
    text_in(const std::string &folder)
    {
      std::ifstream      in(folder + "/" + RunRecord::file_name);
      std::ostringstream text;
      text << in.rdbuf();
      return text.str();
    }

    RunRecord
    parse_or_empty(const std::string &text)
    {
      try
        {
          return parse(text);
        }
      catch (const Json::exception &)
        {
          return {};
        }
    }
  } // namespace

  RunRecord::RunRecord(const std::string &parameters, const RunResult &result)
    : parameters(parameters)
    , status(result.summary.status)
    , results(result.summary.results)
    , n_steps(result.summary.n_steps)
    , newton_iterations(result.summary.newton_iterations)
    , linear_iterations(result.summary.linear_iterations)
    , wall_times{result.summary.wall_time_s}
    , cpu_times{result.cpu_time_s}
    , peak_memory_bytes(result.summary.peak_memory_bytes)
  {}

  void
  RunRecord::write(const std::string &folder, const MPI_Comm comm) const
  {
    on_root(comm, [&] { Output::write_atomically(folder + "/" + file_name, as_text(*this)); });
  }

  RunRecord
  RunRecord::read(const std::string &folder)
  {
    return parse_or_empty(text_in(folder));
  }

  RunRecord
  RunRecord::read(const std::string &folder, const MPI_Comm comm)
  {
    const bool root = dealii::Utilities::MPI::this_mpi_process(comm) == 0;
    return parse_or_empty(dealii::Utilities::MPI::broadcast(comm, root ? text_in(folder) : std::string(), 0));
  }

  std::string
  parameters_text(const ParameterFile &file)
  {
    std::vector<std::string> lines;
    for (const auto &entry : file.entries())
      lines.push_back(join(entry.section, "/") + (entry.section.empty() ? "" : "/") + entry.name + " = " + entry.value);
    std::sort(lines.begin(), lines.end());
    return "Stroma " STROMA_VERSION "\n" + join(lines, "\n");
  }
} // namespace Stroma::Studies
