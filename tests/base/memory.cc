#include "message_of.h"

#include <stroma/base/memory.h>

#include <gtest/gtest.h>

#include <sys/resource.h>

namespace
{
  using namespace Stroma;

  TEST(Memory, RefusesWhatExceedsTheLimitOrTheMachine)
  {
    EXPECT_GT(Memory::available(), 1e6);
    EXPECT_EQ(message_of([] { Memory::require(MPI_COMM_WORLD, 1e3, "f.prm:1", "a grid"); }), "");
    EXPECT_EQ(message_of([] {
                Memory::require(MPI_COMM_WORLD, 1e18, "f.prm:1", "a grid");
              }).find("f.prm:1: a grid would take about 1e+09 GB of memory, but there are "),
              0u);
    Memory::set_limit(2e9);
    EXPECT_EQ(
      message_of([] { Memory::require(MPI_COMM_WORLD, 2.5e9, "f.prm:1", "a grid"); }),
      "f.prm:1: a grid would take about 2.5 GB of memory, but 'Memory limit' is 2 GB; make it smaller, or raise 'Memory "
      "limit' [GB] if you know better");
    EXPECT_TRUE(Memory::has_room(MPI_COMM_WORLD, 1e9));
    EXPECT_FALSE(Memory::has_room(MPI_COMM_WORLD, 2.5e9));
    EXPECT_TRUE(Memory::has_room_now(MPI_COMM_WORLD, 1e6));
    Memory::set_limit(2e6); // the program itself holds more
    EXPECT_TRUE(Memory::has_room(MPI_COMM_WORLD, 1e6));
    EXPECT_FALSE(Memory::has_room_now(MPI_COMM_WORLD, 1e6));
    Memory::set_limit(1e20);
    EXPECT_FALSE(Memory::has_room_now(MPI_COMM_WORLD, 1e18));
    EXPECT_EQ(message_of([] { Memory::require(MPI_COMM_WORLD, 1e18, "f.prm:1", "a grid"); }), "");
    Memory::set_limit(0.);
    EXPECT_EQ(
      message_of([] { Memory::require_indices(3e9, "f.prm:1", "a grid"); }),
      "f.prm:1: a grid would have more unknowns than the 2,147,483,647 that this build can number; make it smaller");
  }

  TEST(Memory, KnowsTheLimitOfTheAddressSpace)
  {
    rlimit before{};
    getrlimit(RLIMIT_AS, &before);
    rlimit small   = before;
    small.rlim_cur = 1; // less than what is taken already
    setrlimit(RLIMIT_AS, &small);
    const double left = Memory::available();
    setrlimit(RLIMIT_AS, &before);
    EXPECT_LE(left, 0.);
  }
} // namespace
