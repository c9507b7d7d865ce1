#pragma once

#include <cstdint>
#include <optional>

namespace Stroma
{
  /**
   * What a part of a program's work takes of the machine, from construction on: CPU time of the process with all its
   * threads, and its largest resident memory.
   *
   * A process only knows the largest memory since it began. It is forgotten at construction, as Linux allows (write 5 to
   * /proc/self/clear_refs), and what was freed before is given back first, so that one run after another in a process has its
   * own. Where that is refused, a peak that an earlier part of the work may have made is not told.
   */
  class ResourceUse
  {
  public:
    ResourceUse();

    /// CPU time since construction [s].
    double cpu_time() const;

    /// Largest resident memory since construction [bytes]; nothing where that is not known.
    std::optional<std::uint64_t> peak_memory() const;

  private:
    bool          is_forgotten;
    std::uint64_t peak_before; ///< [bytes]
    double        cpu_before;  ///< [s]
  };
} // namespace Stroma
