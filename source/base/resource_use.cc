#include <stroma/base/log.h>
#include <stroma/base/resource_use.h>

#include <malloc.h>

#include <ctime>
#include <fstream>

namespace Stroma
{
  namespace
  {
    double
    cpu_time_of_process()
    {
      timespec time{};
      clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
      return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
    }

    /// Whether the system has forgotten the largest memory of this process so far.
    bool
    forget_peak()
    {
      malloc_trim(0);
      std::ofstream file("/proc/self/clear_refs");
      file << 5 << std::flush;
      return file.good();
    }
  } // namespace

  ResourceUse::ResourceUse()
    : is_forgotten(forget_peak())
    , peak_before(peak_memory_bytes())
    , cpu_before(cpu_time_of_process())
  {}

  double
  ResourceUse::cpu_time() const
  {
    return cpu_time_of_process() - cpu_before;
  }

  std::optional<std::uint64_t>
  ResourceUse::peak_memory() const
  {
    const std::uint64_t peak = peak_memory_bytes();
    if (!is_forgotten && peak <= peak_before)
      return std::nullopt;
    return peak;
  }
} // namespace Stroma
