#include <stroma/output/collective.h>
#include <stroma/output/series.h>
#include <stroma/output/text_file.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>

namespace Stroma::Output
{
  namespace
  {
    std::string
    header_of(const TimeSeries::Row &row)
    {
      std::string header;
      for (const auto &column : row)
        header += (header.empty() ? "" : ",") + csv_cell(column.first);
      return header;
    }

    std::string
    difference(const std::string &file, const std::string &given)
    {
      return "the file has the columns '" + file + "', this run has '" + given + "'";
    }
  } // namespace

  void
  check_names(const TimeSeries::Row &row)
  {
    std::set<std::string> names;
    for (const auto &column : row)
      if (!names.insert(column.first).second)
        throw UserError("two results are called '" + column.first +
                        "'; give the supports, bodies or probes behind them other names");
  }

  TimeSeries::TimeSeries(const std::string &path, const MPI_Comm comm)
    : path(path)
    , comm(comm)
  {}

  bool
  TimeSeries::resume(const double until)
  {
    bool has_last_row = false;
    on_root(comm, [&] {
      std::error_code code;
      if (std::filesystem::file_size(path, code) > 0 && !code)
        has_last_row = read_back(until);
    });
    return dealii::Utilities::MPI::broadcast(comm, has_last_row, 0);
  }

  bool
  TimeSeries::read_back(const double until)
  {
    std::ifstream in(path, std::ios::binary);
    std::string   kept;
    const double  same         = 1e-10 * std::abs(until);
    bool          has_last_row = false;
    for (std::string line; std::getline(in, line) && !in.eof();)
      {
        const double time = std::strtod(line.c_str(), nullptr);
        if (!header.empty() && time > until + same)
          continue;
        has_last_row = !header.empty() && time >= until - same;
        header       = header.empty() ? line : header;
        kept += line + "\n";
      }
    if (header.rfind("time_s", 0) != 0)
      throw UserError(path, "not a time series of Stroma: its first line must begin with time_s, remove the file");
    write_atomically(path, kept);
    file.open(path, std::ios::binary | std::ios::app);
    return has_last_row;
  }

  void
  TimeSeries::add(const Row &row)
  {
    on_root(comm, [&] { write(row); });
  }

  void
  TimeSeries::write(const Row &row)
  {
    const std::string given = header_of(row);
    if (header.empty())
      {
        check_names(row);
        header = given;
        file.open(path, std::ios::binary | std::ios::trunc);
        file << header << '\n';
      }
    if (header != given)
      throw UserError(path, difference(header, given) + "; columns cannot change, use another output folder");
    std::string line;
    for (const auto &column : row)
      line += (line.empty() ? "" : ",") + to_text(column.second);
    std::error_code code;
    const auto      size = std::filesystem::file_size(path, code);
    file << line << '\n' << std::flush;
    if (file)
      return;
    file.close();
    if (!code)
      std::filesystem::resize_file(path, size, code); // no half row
    throw OutputError(path, "the row cannot be written (disk full or folder not writable)");
  }
} // namespace Stroma::Output
