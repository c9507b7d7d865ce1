#include <stroma/output/collective.h>
#include <stroma/output/pvd.h>
#include <stroma/output/text_file.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>

namespace Stroma::Output
{
  namespace
  {
    bool
    is_xdmf(const std::string &path)
    {
      return std::filesystem::path(path).extension() == ".xdmf";
    }

    std::string
    pvd_text(const std::vector<std::pair<double, std::string>> &list)
    {
      std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
      for (const auto &[time, file] : list)
        text += "<DataSet timestep=\"" + to_text(time) + "\" group=\"\" part=\"0\" file=\"" + file + "\"/>\n";
      return text + "</Collection>\n</VTKFile>\n";
    }

    /// Each record is included; the times stand in front, and once more in a comment, where restore() finds them.
    std::string
    xdmf_text(const std::vector<std::pair<double, std::string>> &list)
    {
      std::string times, records;
      for (const auto &[time, file] : list)
        {
          times += to_text(time) + " ";
          records += "<!-- timestep=\"" + to_text(time) + "\" file=\"" + file + "\" -->\n<xi:include href=\"" + file +
                     "\" xpointer=\"xpointer(//Xdmf/Domain/Grid)\"/>\n";
        }
      return "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\" xmlns:xi=\"http://www.w3.org/2001/XInclude\">\n<Domain>\n"
             "<Grid Name=\"series\" GridType=\"Collection\" CollectionType=\"Temporal\">\n<Time TimeType=\"List\">\n"
             "<DataItem Format=\"XML\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"" +
             std::to_string(list.size()) + "\">" + times + "</DataItem>\n</Time>\n" + records +
             "</Grid>\n</Domain>\n</Xdmf>\n";
    }
  } // namespace

  PvdSeries::PvdSeries(const std::string &path, const MPI_Comm comm)
    : path(path)
    , comm(comm)
  {}

  void
  PvdSeries::restore(const double until)
  {
    on_root(comm, [&] {
      list.clear();
      std::ifstream    in(path);
      const std::regex entry("timestep=\"([^\"]*)\".* file=\"([^\"]*)\"");
      std::smatch      match;
      for (std::string line; std::getline(in, line);)
        if (std::regex_search(line, match, entry))
          list.emplace_back(std::strtod(match[1].str().c_str(), nullptr), match[2]);
      const double last = until + 1e-10 * std::abs(until);
      list.erase(std::remove_if(list.begin(), list.end(), [&](const auto &e) { return e.first > last; }), list.end());
      write_atomically(path, text());
    });
  }

  unsigned int
  PvdSeries::next_number() const
  {
    unsigned int next = 0;
    on_root(comm, [&] {
      const std::regex number("_([0-9]{1,9})\\.");
      std::smatch      match;
      for (const auto &[time, file] : list)
        if (std::regex_search(file, match, number))
          next = std::max<unsigned int>(next, std::stoul(match[1]) + 1);
    });
    return dealii::Utilities::MPI::broadcast(comm, next, 0);
  }

  bool
  PvdSeries::has(const double time) const
  {
    const double same  = 1e-10 * std::abs(time);
    const bool   found = std::any_of(list.begin(), list.end(),
                                     [&](const auto &e) { return std::abs(e.first - time) <= same; });
    return dealii::Utilities::MPI::broadcast(comm, found, 0);
  }

  void
  PvdSeries::add(const double time, const std::string &file)
  {
    on_root(comm, [&] {
      list.erase(std::remove_if(list.begin(), list.end(), [&](const auto &e) { return e.first == time; }), list.end());
      list.emplace_back(time, file);
      write_atomically(path, text());
    });
  }

  std::string
  PvdSeries::text() const
  {
    return is_xdmf(path) ? xdmf_text(list) : pvd_text(list);
  }
} // namespace Stroma::Output
