#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace Stroma
{
  /// Sets of numbers that are known to belong together: at first each number alone.
  class DisjointSets
  {
  public:
    explicit DisjointSets(const std::size_t n)
      : parent(n)
    {
      std::iota(parent.begin(), parent.end(), 0u);
    }

    /// The number that stands for the set of @p i.
    unsigned int
    root(unsigned int i)
    {
      while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
      return i;
    }

    void
    unite(const unsigned int a, const unsigned int b)
    {
      if (parent[a] != parent[b])
        parent[root(a)] = root(b);
    }

  private:
    std::vector<unsigned int> parent;
  };
} // namespace Stroma
