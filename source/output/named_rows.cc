#include <stroma/base/errors.h>
#include <stroma/output/named_rows.h>

#include <algorithm>
#include <numeric>
#include <unordered_map>

namespace Stroma::Output
{
  namespace
  {
    namespace MPI = dealii::Utilities::MPI;

    /// The rank that keeps account of a name: any, but the same for all.
    unsigned int
    accountant(std::uint64_t name, const unsigned int n_ranks)
    {
      name ^= name >> 33;
      name *= 0xff51afd7ed558ccdull;
      name ^= name >> 33;
      return name % n_ranks;
    }

    /// (name, index) of each name, to its accountant.
    std::map<unsigned int, std::vector<std::uint64_t>>
    to_accountants(const std::vector<std::uint64_t> &names, const MPI_Comm comm)
    {
      std::map<unsigned int, std::vector<std::uint64_t>> told;
      for (std::size_t i = 0; i < names.size(); ++i)
        {
          auto &list = told[accountant(names[i], MPI::n_mpi_processes(comm))];
          list.push_back(names[i]);
          list.push_back(i);
        }
      return MPI::some_to_some(comm, told);
    }
  } // namespace

  NamedRows::NamedRows(const ArchiveReader &archive, const std::string &names, const std::vector<std::uint64_t> &wanted,
                       const MPI_Comm comm, const std::size_t portion)
    : archive(archive)
    , comm(comm)
    , portion(portion)
  {
    const auto share = archive.read_uint64(names);
    n_share          = share.size();
    is_share_wanted  = MPI::min(are_in_order(share, wanted) ? 1 : 0, comm) == 1;
    if (!is_share_wanted)
      make_plan(orders(share, wanted), wanted.size());
    const bool has_all_here = std::all_of(n_rows.begin(), n_rows.end(), [](const unsigned int n) { return n > 0; });
    is_complete             = MPI::min(has_all_here ? 1 : 0, comm) == 1;
  }

  /// Whether the share holds the wanted names and no others, in their order, as on the ranks that wrote it; then fills n_rows.
  bool
  NamedRows::are_in_order(const std::vector<std::uint64_t> &names, const std::vector<std::uint64_t> &wanted)
  {
    n_rows.assign(wanted.size(), 1);
    if (names == wanted)
      return true;
    n_rows.assign(wanted.size(), 0);
    std::size_t i = 0;
    for (std::size_t w = 0; w < wanted.size(); ++w)
      for (; i < names.size() && names[i] == wanted[w]; ++i)
        ++n_rows[w];
    return i == names.size();
  }

  /// What this rank has to send: (row of its share, rank, index among what that rank wants), in turn.
  NamedRows::ByRank
  NamedRows::orders(const std::vector<std::uint64_t> &names, const std::vector<std::uint64_t> &wanted) const
  {
    std::unordered_map<std::uint64_t, std::vector<std::pair<unsigned int, std::uint64_t>>> who_wants;
    for (const auto &[rank, list] : to_accountants(wanted, comm))
      for (std::size_t i = 0; i < list.size(); i += 2)
        who_wants[list[i]].emplace_back(rank, list[i + 1]);
    ByRank given;
    for (const auto &[holder, list] : to_accountants(names, comm))
      for (std::size_t i = 0; i < list.size(); i += 2)
        if (const auto wants = who_wants.find(list[i]); wants != who_wants.end())
          for (const auto &[rank, index] : wants->second)
            for (const std::uint64_t number : {list[i + 1], std::uint64_t(rank), index})
              given[holder].push_back(number);
    return MPI::some_to_some(comm, given);
  }

  void
  NamedRows::make_plan(const ByRank &orders, const std::size_t n_wanted)
  {
    std::map<unsigned int, std::vector<std::pair<std::uint64_t, std::uint64_t>>> rows; // to each rank: row, index
    for (const auto &order : orders)
      for (std::size_t i = 0; i < order.second.size(); i += 3)
        rows[order.second[i + 1]].emplace_back(order.second[i], order.second[i + 2]);
    ByRank indices;
    for (auto &[rank, list] : rows)
      {
        std::sort(list.begin(), list.end());
        for (const auto &[row, index] : list)
          {
            sent[rank].push_back(row);
            indices[rank].push_back(index);
          }
      }
    received = MPI::some_to_some(comm, indices);

    n_rows.assign(n_wanted, 0);
    for (const auto &from : received)
      for (const std::uint64_t index : from.second)
        ++n_rows[index];
    std::vector<std::uint64_t> next(n_wanted, 0); // place of the next row of each name
    for (std::size_t w = 1; w < n_wanted; ++w)
      next[w] = next[w - 1] + n_rows[w - 1];
    for (auto &from : received) // by rank, so in the order of the file
      for (std::uint64_t &index : from.second)
        index = next[index]++;
  }

  std::vector<double>
  NamedRows::read(const std::string &array, const unsigned int width) const
  {
    auto share = archive.read_double(array, width);
    if (MPI::min(share.size() == n_share * width ? 1 : 0, comm) == 0)
      throw UserError("'" + array + "' of the checkpoint does not fit to its names; start anew with --overwrite");
    if (is_share_wanted)
      return share;
    std::vector<double> result(std::accumulate(n_rows.begin(), n_rows.end(), std::size_t(0)) * width);
    const std::size_t   at_once = std::max<std::size_t>(portion / width, 1); // rows
    std::uint64_t       most    = 0;                                         // to one rank
    for (const auto &to : sent)
      most = std::max<std::uint64_t>(most, to.second.size());
    most = MPI::max(most, comm);
    for (std::size_t begin = 0; begin < most; begin += at_once)
      {
        std::map<unsigned int, std::vector<double>> values;
        for (const auto &[rank, rows] : sent)
          for (std::size_t k = begin; k < std::min(begin + at_once, rows.size()); ++k)
            values[rank].insert(values[rank].end(), share.begin() + rows[k] * width,
                                share.begin() + (rows[k] + 1) * width);
        for (const auto &[rank, numbers] : MPI::some_to_some(comm, values))
          for (std::size_t k = 0; k < numbers.size() / width; ++k)
            std::copy_n(numbers.data() + k * width, width, result.data() + received.at(rank)[begin + k] * width);
      }
    return result;
  }

  std::vector<double>
  NamedRows::read_last(const std::string &array, const unsigned int width) const
  {
    const auto          rows = read(array, width);
    std::vector<double> last(n_rows.size() * width);
    std::size_t         end = 0;
    for (std::size_t w = 0; w < n_rows.size(); ++w)
      {
        end += n_rows[w];
        std::copy_n(rows.data() + (end - 1) * width, width, last.data() + w * width);
      }
    return last;
  }
} // namespace Stroma::Output
