#include <stroma/base/errors.h>
#include <stroma/base/memory.h>
#include <stroma/base/reserved_memory.h>
#include <stroma/base/text.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>

#include <sys/resource.h>
#include <unistd.h>

namespace Stroma::Memory
{
  namespace
  {
    constexpr double unlimited = std::numeric_limits<double>::infinity(), GB = 1e9;

    double limit = 0.;

    /// The number in a file of one number, or infinity ("max", no such file).
    double
    number_in(const std::string &path)
    {
      std::ifstream in(path);
      double        value = 0.;
      return in >> value ? value : unlimited;
    }

    /// 'MemAvailable' of the machine [bytes].
    double
    free_of_machine()
    {
      std::ifstream in("/proc/meminfo");
      for (std::string line; std::getline(in, line);)
        if (line.rfind("MemAvailable:", 0) == 0)
          return 1024. * std::strtod(line.c_str() + 13, nullptr);
      return unlimited;
    }

    /// What the control groups above this process leave [bytes]; pages of files that can be given back count as free.
    double
    free_of_control_groups()
    {
      double        least = unlimited;
      std::ifstream in("/proc/self/cgroup");
      for (std::string line; std::getline(in, line);)
        {
          const auto parts = split(line, ':');
          if (parts.size() != 3 || (!parts[1].empty() && parts[1].find("memory") == std::string::npos))
            continue;
          const bool        is_v2 = parts[1].empty();
          const std::string root  = is_v2 ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory";
          const std::string most  = is_v2 ? "/memory.max" : "/memory.limit_in_bytes";
          const std::string now   = is_v2 ? "/memory.current" : "/memory.usage_in_bytes";
          for (std::string group = parts[2];; group = group.substr(0, group.find_last_of('/')))
            {
              const std::string folder = root + (group == "/" ? "" : group);
              double            cache  = 0.;
              std::ifstream     stat(folder + "/memory.stat");
              std::string       name;
              for (double value = 0.; stat >> name >> value;)
                if (name == "inactive_file" || name == "total_inactive_file")
                  cache = value;
              const double largest = number_in(folder + most), used = number_in(folder + now);
              if (std::isfinite(largest) && std::isfinite(used))
                least = std::min(least, largest - used + cache);
              if (group.empty() || group == "/")
                break;
            }
        }
      return least;
    }

    /// What this process holds [bytes].
    struct Held
    {
      double address_space = 0., resident = 0.;
    };

    Held
    held()
    {
      std::ifstream in("/proc/self/statm"); // in pages
      Held          result;
      in >> result.address_space >> result.resident;
      const double page = static_cast<double>(sysconf(_SC_PAGESIZE));
      return {result.address_space * page, result.resident * page};
    }

    /// What the limit on the address space leaves [bytes].
    double
    free_of_address_space()
    {
      rlimit space{};
      if (getrlimit(RLIMIT_AS, &space) != 0 || space.rlim_cur == RLIM_INFINITY)
        return unlimited;
      return static_cast<double>(space.rlim_cur) - held().address_space;
    }

    std::string
    gigabytes(const double bytes)
    {
      return brief(bytes / GB < 10 ? std::round(bytes / GB * 10) / 10 : std::round(bytes / GB)) + " GB";
    }

    void
    refuse_beyond(const double has, const double bytes, const std::string &where, const std::string &what)
    {
      if (bytes > has)
        throw UserError(where, what + " would take about " + gigabytes(bytes) + " of memory, but " +
                                 (limit > 0. ? "'Memory limit' is " : "there are ") + gigabytes(std::max(0., has)) +
                                 "; make it smaller, or raise 'Memory limit' [GB] if you know better");
    }

    /// What one of @p comm's ranks may take if those of its machine share alike.
    double
    share(const MPI_Comm comm)
    {
      MPI_Comm node;
      MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
      const double ranks = dealii::Utilities::MPI::n_mpi_processes(node);
      MPI_Comm_free(&node);
      return std::min(std::min(free_of_machine(), free_of_control_groups()) / ranks, free_of_address_space());
    }

    /// What is left to the ranks of @p comm together.
    double
    free_of_ranks(const MPI_Comm comm)
    {
      return dealii::Utilities::MPI::n_mpi_processes(comm) * dealii::Utilities::MPI::min(share(comm), comm);
    }

    /// What the ranks of @p comm may take together.
    double
    of_ranks(const MPI_Comm comm)
    {
      const double has = limit > 0. ? limit : free_of_ranks(comm);
      // Free memory changes; ranks must not come to different results.
      return dealii::Utilities::MPI::min(has, comm);
    }
  } // namespace

  void
  set_limit(const double bytes)
  {
    limit = bytes;
  }

  double
  available()
  {
    return std::min({free_of_machine(), free_of_control_groups(), free_of_address_space()});
  }

  bool
  has_room(const MPI_Comm comm, const double bytes)
  {
    return bytes + reserved_for_results() <= of_ranks(comm);
  }

  bool
  has_room_now(const MPI_Comm comm, const double bytes)
  {
    double left = free_of_ranks(comm);
    if (limit > 0.)
      left = std::min(left, limit - dealii::Utilities::MPI::sum(held().resident, comm));
    return dealii::Utilities::MPI::min(left, comm) >= bytes;
  }

  void
  require(const MPI_Comm comm, const double bytes, const std::string &where, const std::string &what)
  {
    refuse_beyond(of_ranks(comm), bytes + reserved_for_results(), where, what);
  }

  void
  require_here(const double bytes, const std::string &where, const std::string &what)
  {
    refuse_beyond(limit > 0. ? limit : available(), bytes, where, what);
  }

  std::string
  about(const double n)
  {
    char text[32];
    std::snprintf(text, sizeof(text), "%.2g", n);
    return text;
  }

  void
  require_indices(const double n, const std::string &where, const std::string &what)
  {
    if (n >= std::numeric_limits<int>::max())
      throw UserError(where, what + " would have more unknowns than the " + grouped(std::numeric_limits<int>::max()) +
                               " that this build can number; make it smaller");
  }
} // namespace Stroma::Memory
