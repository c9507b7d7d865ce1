#pragma once

#include <cstdint>
#include <vector>

namespace Stroma::Particles
{
  /// Sorts indices by several keys, the least important first: each pass keeps the order of equal ones.
  class PassSort
  {
  public:
    explicit PassSort(std::vector<unsigned int> &order)
      : order(order)
      , sorted(order.size())
    {}

    /// @param key key(i) < n_keys of index i
    template <typename Key>
    void
    pass(const unsigned int n_keys, const Key &key)
    {
      start.assign(n_keys + 1, 0);
      for (const unsigned int i : order)
        ++start[key(i) + 1];
      for (unsigned int k = 0; k < n_keys; ++k)
        start[k + 1] += start[k];
      for (const unsigned int i : order)
        sorted[start[key(i)]++] = i;
      order.swap(sorted);
    }

    /// By ids, in as many passes as the largest one needs.
    void
    pass_ids(const std::vector<std::uint64_t> &id)
    {
      constexpr unsigned int bits = 11, n_keys = 1u << bits;
      std::uint64_t          all = 0;
      for (const unsigned int i : order)
        all |= id[i];
      for (unsigned int shift = 0; shift < 64 && all >> shift > 0; shift += bits)
        pass(n_keys, [&](const unsigned int i) { return static_cast<unsigned int>(id[i] >> shift) % n_keys; });
    }

  private:
    std::vector<unsigned int> &order;
    std::vector<unsigned int>  sorted, start;
  };
} // namespace Stroma::Particles
