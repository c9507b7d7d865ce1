#include <stroma/grid/node_lattice.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <unordered_map>

namespace Stroma
{
  namespace
  {
    using ByRank = std::map<unsigned int, std::vector<std::uint64_t>>;

    /// Asks rank @p whom[i] for @p question[i]; @p answer makes the questions of all ranks their answers, in place.
    /// Collective.
    template <typename Answer>
    std::vector<std::uint64_t>
    ask(const std::vector<std::uint64_t> &question, const std::vector<std::uint64_t> &whom, const Answer &answer,
        const MPI_Comm comm)
    {
      ByRank questions;
      for (std::size_t i = 0; i < question.size(); ++i)
        questions[whom[i]].push_back(question[i]);
      ByRank asked = dealii::Utilities::MPI::some_to_some(comm, questions);
      answer(asked);
      const ByRank                        answers = dealii::Utilities::MPI::some_to_some(comm, asked);
      std::map<unsigned int, std::size_t> next;
      std::vector<std::uint64_t>          result(question.size());
      for (std::size_t i = 0; i < question.size(); ++i)
        result[i] = answers.at(whom[i])[next[whom[i]]++];
      return result;
    }
  } // namespace

  template <int dim>
  NodeLattice<dim>::NodeLattice(const ShapeFunctions<dim> &shape, const MPI_Comm comm)
    : shape(shape)
    , comm(comm)
  {
    for (unsigned int d = 0; d < dim; ++d)
      size[d] = shape.lattice_size(d);
  }

  template <int dim>
  std::uint64_t
  NodeLattice<dim>::name_of(const Index &node) const
  {
    std::uint64_t name = 0;
    for (int d = dim - 1; d >= 0; --d)
      name = name * size[d] + node[d];
    return name;
  }

  template <int dim>
  typename NodeLattice<dim>::Index
  NodeLattice<dim>::index_of(std::uint64_t name) const
  {
    Index node;
    for (unsigned int d = 0; d < dim; ++d, name /= size[d - 1])
      node[d] = name % size[d];
    return node;
  }

  template <int dim>
  std::uint64_t
  NodeLattice<dim>::n_lattice() const
  {
    return std::accumulate(size.begin(), size.end(), std::uint64_t(1), std::multiplies<>());
  }

  /// The rank that each node belongs to. Parts of the lattice are kept by the ranks in turn, who are told of all its users.
  template <int dim>
  typename NodeLattice<dim>::Names
  NodeLattice<dim>::find_owners(const Names &known) const
  {
    const std::uint64_t all   = n_lattice();
    const std::uint64_t ranks = dealii::Utilities::MPI::n_mpi_processes(comm);
    if (ranks == 1)
      return Names(known.size(), 0);
    Names keeper = known;
    for (auto &name : keeper)
      name = name % all / (all / ranks + 1);
    return ask(
      known, keeper,
      [](ByRank &asked) {
        std::unordered_map<std::uint64_t, std::uint64_t> lowest;
        for (const auto &[rank, nodes] : asked) // from the lowest rank on
          for (const auto name : nodes)
            lowest.emplace(name, rank);
        for (auto &[rank, nodes] : asked)
          for (auto &name : nodes)
            name = lowest.at(name);
      },
      comm);
  }

  /// The first unknown of each node: of its own by the order in which they are known, of others' by asking them.
  template <int dim>
  typename NodeLattice<dim>::Names
  NodeLattice<dim>::find_unknowns(const Names &known, const Names &owner)
  {
    const unsigned int  me    = dealii::Utilities::MPI::this_mpi_process(comm);
    const std::uint64_t n_own = dim * std::count(owner.begin(), owner.end(), me);
    const auto          each  = dealii::Utilities::MPI::all_gather(comm, n_own);
    std::uint64_t       next  = std::accumulate(each.begin(), each.begin() + me, std::uint64_t(0));
    owned                     = dealii::IndexSet(std::accumulate(each.begin(), each.end(), std::uint64_t(0)));
    owned.add_range(next, next + n_own);
    std::unordered_map<std::uint64_t, std::uint64_t> own;
    Names                                            result(known.size()), others, whom;
    for (std::size_t i = 0; i < known.size(); ++i)
      if (owner[i] == me)
        {
          own.emplace(known[i], next);
          result[i] = next;
          next += dim;
        }
      else
        {
          others.push_back(known[i]);
          whom.push_back(owner[i]);
        }
    const auto answers = ask(
      others, whom,
      [&](ByRank &asked) {
        for (auto &[rank, nodes] : asked)
          for (auto &name : nodes)
            name = own.at(name);
      },
      comm);
    for (std::size_t i = 0, k = 0; i < known.size(); ++i)
      if (owner[i] != me)
        result[i] = answers[k++];
    return result;
  }

  template <int dim>
  void
  NodeLattice<dim>::distribute(const std::vector<Index> &cells, const std::vector<std::uint32_t> &copies)
  {
    const unsigned int                     n   = shape.n_nodes();
    const std::uint64_t                    all = n_lattice();
    std::unordered_map<std::uint64_t, int> met;
    Names                                  known; // in the order in which the cells meet them
    cell_nodes.resize(cells.size() * n);
    for (std::size_t k = 0; k < cells.size(); ++k)
      for (unsigned int a = 0; a < n; ++a)
        {
          const auto copy = copies.empty() ? 0 : copies[k * n + a];
          const auto name = name_of(shape.node_index(cells[k], a)) + copy * all; // that of the lattice, modulo all
          const auto [at, fresh] = met.emplace(name, known.size());
          if (fresh)
            known.push_back(name);
          cell_nodes[k * n + a] = at->second;
        }
    met.clear();
    const Names      unknown = find_unknowns(known, find_owners(known));
    std::vector<int> order(known.size()), place(known.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](const int i, const int j) { return unknown[i] < unknown[j]; });

    relevant = dealii::IndexSet(owned.size());
    names.clear();
    first_unknown.clear();
    for (const int i : order)
      {
        place[i] = dim * names.size();
        names.push_back(known[i]);
        first_unknown.push_back(unknown[i]);
        relevant.add_range(unknown[i], unknown[i] + dim);
      }
    owned.compress();
    relevant.compress();
    for (int &node : cell_nodes)
      node = place[node];
  }

  template <int dim>
  typename NodeLattice<dim>::Node
  NodeLattice<dim>::node(const std::size_t i) const
  {
    const Index index = index_of(names[i]);
    return {names[i], index, first_unknown[i], shape.place(index)};
  }

  template class NodeLattice<2>;
  template class NodeLattice<3>;
} // namespace Stroma
