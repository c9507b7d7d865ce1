#include <stroma/base/resource_use.h>

#include <gtest/gtest.h>

#include <memory>
#include <vector>

using namespace Stroma;

namespace
{
  /// Makes so much memory resident for a while.
  std::uint64_t
  peak_with(const std::size_t bytes)
  {
    const ResourceUse       use;
    const std::vector<char> all(bytes, 1);
    return use.peak_memory().value_or(all.front() - 1);
  }
} // namespace

TEST(ResourceUse, APeakIsOfItsOwnPartOfTheWork)
{
  const auto small = peak_with(10000000), large = peak_with(200000000), small_again = peak_with(10000000);
  EXPECT_GT(large, small + 180000000);
  EXPECT_LT(small_again, small + 20000000);
}

TEST(ResourceUse, CpuTimeIsThatOfWork)
{
  const ResourceUse use;
  volatile double   sum = 0;
  while (use.cpu_time() < .05)
    sum = sum + 1.;
  EXPECT_LT(use.cpu_time(), 1.);
  EXPECT_GT(sum, 1000.);
}
