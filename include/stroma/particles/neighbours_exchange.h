#pragma once

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>

#include <cstddef>
#include <vector>

namespace Stroma::Particles
{
  /**
   * Copies entries of a field to other ranks, or to further places on this one, where they stand behind the field's own
   * entries: in the order of the ranks that they come from, and as these sent them. The plan is laid once and then
   * serves any field of trivially copied entries, with no allocation after the largest one. Without partners nothing is
   * done.
   */
  class Exchange
  {
  public:
    explicit Exchange(MPI_Comm comm);

    /// Lays the plan. @p send holds for each rank the indices of the entries that it gets; what comes to this rank goes
    /// to the places from @p first on. Collective.
    void reinit(const std::vector<std::vector<unsigned int>> &send, unsigned int first);

    /// Forgets the plan: nothing is copied.
    void clear();

    unsigned int
    n_received() const
    {
      return n_coming;
    }

    /// Copies the entries of @p field, which has places for those that come. An empty field is left alone. Collective.
    template <typename T>
    void
    copy(std::vector<T> &field) const
    {
      if (partners.empty() || field.empty())
        return;
      Assert(field.size() >= first + n_coming, dealii::ExcDimensionMismatch(field.size(), first + n_coming));
      copy_bytes(reinterpret_cast<char *>(field.data()), sizeof(T));
    }

    /// The same for values that belong to what is sent rather than to the field: @p packed holds one for each index of
    /// the plan, rank by rank. Returns those that come. Collective.
    template <typename T>
    std::vector<T>
    copy_packed(const std::vector<T> &packed) const
    {
      std::vector<T> coming(n_coming);
      transfer(reinterpret_cast<const char *>(packed.data()), reinterpret_cast<char *>(coming.data()), sizeof(T));
      return coming;
    }

  private:
    void copy_bytes(char *data, std::size_t bytes) const;
    void transfer(const char *packed, char *coming, std::size_t bytes) const;

    /// A rank that gets something from this one or sends something to it; ranges within what goes and what comes.
    struct Partner
    {
      int          rank;
      unsigned int going, n_going;
      unsigned int coming, n_coming;
    };

    MPI_Comm                  comm;
    std::vector<Partner>      partners; ///< this rank itself included
    std::vector<unsigned int> index;    ///< of the entries that go, partner by partner
    unsigned int              first = 0, n_coming = 0;

    mutable std::vector<char>        packed;
    mutable std::vector<MPI_Request> requests;
  };
} // namespace Stroma::Particles
