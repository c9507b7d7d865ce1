#pragma once

#include <stroma/output/archive.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace Stroma::Output
{
  /**
   * Rows of numbers in a checkpoint, each with a name that does not depend on the number of ranks: of an unknown, a cell or
   * a node. The names are an array of their own, which several arrays may share; a name may have any number of rows.
   *
   * They are read on any number of ranks: each reads its share of the file and sends every row to the ranks that want its
   * name, which it learns from the rank that keeps account of the name. No rank sees the whole. Rows go in portions, as MPI
   * counts in int; names do not: 2^31 bytes are 89 million of them between two ranks.
   */
  class NamedRows
  {
  public:
    /// @param names array of the archive @param wanted names whose rows this rank wants
    /// @param portion numbers that one rank sends to another at once. Collective.
    NamedRows(const ArchiveReader &archive, const std::string &names, const std::vector<std::uint64_t> &wanted,
              MPI_Comm comm, std::size_t portion = std::size_t(1) << 26);

    /// Number of rows of each wanted name.
    const std::vector<unsigned int> &
    counts() const
    {
      return n_rows;
    }

    /// Whether each wanted name of each rank has a row.
    bool
    has_all() const
    {
      return is_complete;
    }

    /// The wanted rows of an array of @p width numbers a row: name by name, those of one name in the order of the file.
    /// Throws UserError. Collective.
    std::vector<double> read(const std::string &array, unsigned int width) const;

    /// The same, of each wanted name the last row; unknowns that are tied to each other at one place share a name. Needs
    /// has_all().
    std::vector<double> read_last(const std::string &array, unsigned int width) const;

  private:
    using ByRank = std::map<unsigned int, std::vector<std::uint64_t>>;

    bool   are_in_order(const std::vector<std::uint64_t> &names, const std::vector<std::uint64_t> &wanted);
    ByRank orders(const std::vector<std::uint64_t> &names, const std::vector<std::uint64_t> &wanted) const;
    void   make_plan(const ByRank &orders, std::size_t n_wanted);

    const ArchiveReader      &archive;
    MPI_Comm                  comm;
    std::size_t               portion;
    bool                      is_share_wanted = false; ///< on all ranks, as it is
    bool                      is_complete     = false;
    std::size_t               n_share         = 0; ///< rows of this rank's share of the file
    std::vector<unsigned int> n_rows;
    ByRank                    sent;     ///< to each rank: rows of this one's share, ascending
    ByRank                    received; ///< from each rank: where these rows go
  };
} // namespace Stroma::Output
