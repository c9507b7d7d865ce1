#include <stroma/base/reserved_memory.h>

namespace Stroma::Memory
{
  namespace
  {
    double reserved = 0.;
  }

  void
  reserve_for_results(const double bytes)
  {
    reserved = bytes;
  }

  double
  reserved_for_results()
  {
    return reserved;
  }
} // namespace Stroma::Memory
