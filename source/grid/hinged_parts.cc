#include <stroma/grid/hinged_parts.h>

#include <deal.II/base/mpi.h>

#include <boost/pending/disjoint_sets.hpp>

#include <numeric>
#include <set>
#include <unordered_map>

namespace Stroma
{
  namespace
  {
    /// Sets of numbers that are joined two by two.
    class Sets
    {
    public:
      explicit Sets(const std::size_t n)
        : rank(n, 0)
        , parent(n)
        , sets(rank.data(), parent.data())
      {
        std::iota(parent.begin(), parent.end(), std::size_t(0));
      }

      void        join(const std::size_t a, const std::size_t b) { sets.union_set(a, b); }
      std::size_t of(const std::size_t a) { return sets.find_set(a); }

    private:
      std::vector<std::size_t>                           rank, parent;
      boost::disjoint_sets<std::size_t *, std::size_t *> sets;
    };
  } // namespace

  template <int dim>
  unsigned int
  n_hinged_parts(const BackgroundGrid<dim> &grid)
  {
    // On this rank: nodes by their first unknown's place among the relevant ones.
    Sets                                         mine(grid.relevant.n_elements());
    std::set<std::size_t>                        in_own, in_ghosts;
    std::vector<dealii::types::global_dof_index> dofs(dim << dim);
    for (const auto &cell : grid.dofs.active_cell_iterators())
      {
        if (cell->is_artificial() || !grid.is_active(cell))
          continue;
        cell->get_dof_indices(dofs);
        const auto first = grid.relevant.index_within_set(dofs[0]);
        for (const unsigned int v : cell->vertex_indices())
          {
            const auto node = grid.relevant.index_within_set(dofs[v * dim]);
            (cell->is_locally_owned() ? in_own : in_ghosts).insert(node);
            if (cell->is_locally_owned())
              mine.join(first, node);
          }
      }

    // Over the ranks: a part goes by one of its nodes, and is joined to those of its nodes that other ranks know too.
    std::vector<std::uint64_t> links;
    for (const auto node : in_own)
      if (mine.of(node) == node || in_ghosts.count(node) > 0)
        {
          links.push_back(grid.relevant.nth_index_in_set(mine.of(node)));
          links.push_back(grid.relevant.nth_index_in_set(node));
        }
    const MPI_Comm                                 comm = grid.triangulation.get_communicator();
    std::unordered_map<std::uint64_t, std::size_t> number;
    std::vector<std::size_t>                       ends;
    for (const auto &of_rank : dealii::Utilities::MPI::all_gather(comm, links))
      for (const auto name : of_rank)
        ends.push_back(number.emplace(name, number.size()).first->second);
    Sets all(number.size());
    for (std::size_t i = 0; i < ends.size(); i += 2)
      all.join(ends[i], ends[i + 1]);
    std::set<std::size_t> parts;
    for (const std::size_t end : ends)
      parts.insert(all.of(end));
    return parts.size();
  }

  template unsigned int n_hinged_parts(const BackgroundGrid<2> &);
  template unsigned int n_hinged_parts(const BackgroundGrid<3> &);
} // namespace Stroma
