#include <stroma/grid/node_copies.h>

#include <deal.II/base/mpi.h>

#include <map>
#include <numeric>

namespace Stroma
{
  namespace
  {
    /// Smallest number that is joined with @p i.
    template <typename Number>
    Number
    find_root(std::vector<Number> &above, Number i)
    {
      while (above[i] != i)
        i = above[i] = above[above[i]];
      return i;
    }

    template <typename Number>
    void
    join(std::vector<Number> &above, const Number i, const Number j)
    {
      const Number a = find_root(above, i), b = find_root(above, j);
      above[std::max(a, b)] = std::min(a, b);
    }

    using ByRank = std::map<unsigned int, std::vector<std::uint64_t>>;

    /// Numbers of the copies of pieces, told as (coarse node, number of shared nodes, these) one after the other.
    ByRank
    number_copies(const ByRank &told)
    {
      using Words = const std::uint64_t *;
      std::vector<Words>                                             pieces;
      std::map<std::pair<std::uint64_t, std::uint64_t>, std::size_t> first_with; // coarse, shared node
      std::vector<std::size_t>                                       above;
      for (const auto &[rank, words] : told)
        for (Words at = words.data(); at < words.data() + words.size(); at += 2 + at[1])
          {
            above.push_back(pieces.size());
            for (unsigned int i = 0; i < at[1]; ++i)
              join(above, first_with.emplace(std::make_pair(at[0], at[2 + i]), pieces.size()).first->second,
                   pieces.size());
            pieces.push_back(at);
          }
      std::unordered_map<std::uint64_t, std::uint64_t> n_copies;
      std::vector<std::uint64_t>                       number(pieces.size());
      for (std::size_t i = 0; i < pieces.size(); ++i)
        {
          const std::size_t root = find_root(above, i);
          number[i]              = root == i ? n_copies[pieces[i][0]]++ : number[root];
        }
      ByRank      numbers;
      std::size_t i = 0;
      for (const auto &[rank, words] : told)
        for (Words at = words.data(); at < words.data() + words.size(); at += 2 + at[1])
          numbers[rank].push_back(number[i++]);
      return numbers;
    }
  } // namespace

  template <int dim>
  NodeCopies<dim>::NodeCopies(const CellMatrices<dim> &cells, const std::vector<PlaceInParent<dim>> &places,
                              const std::vector<Index> &parents, const std::array<unsigned int, dim> &next,
                              const dealii::Utilities::MPI::Partitioner &partition)
    : cells(cells)
    , places(places)
    , above((partition.locally_owned_size() + partition.n_ghost_indices()) / dim * n_nodes)
  {
    std::iota(above.begin(), above.end(), Pair(0));
    connect();
    std::uint64_t n_lattice = 1;
    for (const unsigned int n : next)
      n_lattice *= n + 1;
    number(find_pieces(parents, next, partition), n_lattice, partition.get_mpi_communicator());
  }

  /// Of node @p a of cell @p k and node @p p of its parent, which moves it: the same from all cells that have the node. Of the
  /// coarse nodes around it the bits of @p p tell one, on those axes along which it lies between two.
  template <int dim>
  typename NodeCopies<dim>::Pair
  NodeCopies<dim>::pair(const std::size_t k, const unsigned int a, const unsigned int p) const
  {
    return cells.first(k, a) / dim * n_nodes + (p & places[k].between(a));
  }

  template <int dim>
  typename NodeCopies<dim>::Pair
  NodeCopies<dim>::root_of(const Pair pair) const
  {
    return find_root(above, pair);
  }

  /// A cell connects all its nodes that a coarse one moves.
  template <int dim>
  void
  NodeCopies<dim>::connect()
  {
    constexpr auto none = std::numeric_limits<Pair>::max();
    for (std::size_t k = 0; k < cells.n_cells(); ++k)
      for (unsigned int p = 0; p < n_nodes; ++p)
        {
          Pair last = none;
          for (unsigned int a = 0; a < n_nodes; ++a)
            if (places[k].weight(a, p) > 0.f)
              {
                const Pair next = pair(k, a, p);
                if (last != none)
                  join(above, last, next);
                last = next;
              }
        }
  }

  template <int dim>
  std::vector<typename NodeCopies<dim>::Piece>
  NodeCopies<dim>::find_pieces(const std::vector<Index> &parents, const std::array<unsigned int, dim> &next,
                               const dealii::Utilities::MPI::Partitioner &partition) const
  {
    const unsigned int n_own = partition.locally_owned_size();
    std::vector<bool>  is_shared(above.size() / n_nodes, false), is_told(above.size(), false);
    for (const auto &[begin, end] : partition.import_indices())
      for (unsigned int i = begin; i < end; ++i)
        is_shared[i / dim] = true;
    for (std::size_t node = n_own / dim; node < is_shared.size(); ++node)
      is_shared[node] = true;
    std::vector<Piece>                    pieces;
    std::unordered_map<Pair, std::size_t> met;
    for (std::size_t k = 0; k < cells.n_cells(); ++k)
      for (unsigned int p = 0; p < n_nodes; ++p)
        {
          std::uint64_t node = 0;
          for (int d = dim - 1; d >= 0; --d)
            node = node * (next[d] + 1) + parents[k][d] + (p >> d & 1);
          for (unsigned int a = 0; a < n_nodes; ++a)
            if (const Pair here = pair(k, a, p); places[k].weight(a, p) > 0.f && !is_told[here])
              {
                is_told[here]    = true;
                const Pair root  = root_of(here);
                const auto found = met.emplace(root, pieces.size());
                if (found.second)
                  pieces.push_back({node, root, {}});
                if (is_shared[here / n_nodes])
                  pieces[found.first->second].border.push_back(partition.local_to_global(here / n_nodes * dim));
              }
        }
    return pieces;
  }

  /// Each rank numbers the copies of a part of the coarse lattice.
  template <int dim>
  void
  NodeCopies<dim>::number(const std::vector<Piece> &pieces, const std::uint64_t n_lattice, const MPI_Comm comm)
  {
    const std::uint64_t of_rank = n_lattice / dealii::Utilities::MPI::n_mpi_processes(comm) + 1;
    ByRank              tell;
    for (const Piece &piece : pieces)
      {
        auto &words = tell[piece.node / of_rank];
        words.push_back(piece.node);
        words.push_back(piece.border.size());
        words.insert(words.end(), piece.border.begin(), piece.border.end());
      }
    const ByRank                        numbers = dealii::Utilities::MPI::some_to_some(comm,
                                                                                       number_copies(
                                                                                         dealii::Utilities::MPI::some_to_some(comm, tell)));
    std::map<unsigned int, std::size_t> next;
    for (const Piece &piece : pieces)
      {
        const unsigned int rank = piece.node / of_rank;
        if (const auto copy = numbers.at(rank)[next[rank]++]; copy > 0)
          copy_of.emplace(piece.root, copy);
      }
  }

  template <int dim>
  std::uint32_t
  NodeCopies<dim>::copy(const std::size_t k, const unsigned int p) const
  {
    if (copy_of.empty())
      return 0;
    unsigned int a = 0;
    while (!(places[k].weight(a, p) > 0.f))
      ++a;
    const auto found = copy_of.find(root_of(pair(k, a, p)));
    return found == copy_of.end() ? 0 : found->second;
  }

  template class NodeCopies<2>;
  template class NodeCopies<3>;
} // namespace Stroma
