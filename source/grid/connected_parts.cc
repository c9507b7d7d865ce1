#include <stroma/base/disjoint_sets.h>
#include <stroma/grid/connected_parts.h>

#include <deal.II/base/mpi.h>
#include <deal.II/grid/grid_tools.h>

#include <algorithm>
#include <limits>

namespace Stroma
{
  namespace
  {
    constexpr std::uint64_t no_label = std::numeric_limits<std::uint64_t>::max();

    /// Calls visit(neighbour) for the active cells on the other side of face @p f.
    template <int dim, typename Visit>
    void
    for_neighbours(const typename ConnectedParts<dim>::Cell &cell, const unsigned int f, const Visit &visit)
    {
      const bool periodic = cell->has_periodic_neighbor(f);
      if (cell->at_boundary(f) && !periodic)
        return;
      const auto neighbour = periodic ? cell->periodic_neighbor(f) : cell->neighbor(f);
      if (neighbour->is_active())
        visit(neighbour);
      else
        for (unsigned int s = 0; s < dealii::GeometryInfo<dim>::max_children_per_face; ++s)
          visit(periodic ? cell->periodic_neighbor_child_on_subface(f, s) : cell->neighbor_child_on_subface(f, s));
    }
  } // namespace

  template <int dim>
  ConnectedParts<dim>::ConnectedParts(const dealii::parallel::distributed::Triangulation<dim> &triangulation,
                                      const std::vector<bool>                                 &holds_material)
    : triangulation(triangulation)
    , label(triangulation.n_active_cells(), no_label)
    , piece(triangulation.n_active_cells(), none())
  {
    find_labels(holds_material);
    number_pieces();
  }

  template <int dim>
  void
  ConnectedParts<dim>::find_labels(const std::vector<bool> &holds_material)
  {
    DisjointSets                                       sets(label.size());
    std::vector<std::pair<unsigned int, unsigned int>> at_ghosts; // owned cell, ghost cell
    for (const auto &cell : triangulation.active_cell_iterators())
      if (cell->is_locally_owned() && holds_material[cell->active_cell_index()])
        for (const unsigned int f : cell->face_indices())
          for_neighbours<dim>(cell, f, [&](const Cell &neighbour) {
            if (neighbour->is_ghost())
              at_ghosts.emplace_back(cell->active_cell_index(), neighbour->active_cell_index());
            else if (holds_material[neighbour->active_cell_index()])
              sets.unite(cell->active_cell_index(), neighbour->active_cell_index());
          });

    std::vector<Label> of_set(label.size(), no_label); // by root
    for (const auto &cell : triangulation.active_cell_iterators())
      if (cell->is_locally_owned() && holds_material[cell->active_cell_index()])
        {
          Label &smallest = of_set[sets.root(cell->active_cell_index())];
          smallest        = std::min<Label>(smallest, cell->global_active_cell_index());
        }
    // Each round carries the smallest label across one more border between ranks.
    for (int changed = 1; changed;)
      {
        for (const auto &cell : triangulation.active_cell_iterators())
          if (cell->is_locally_owned() && holds_material[cell->active_cell_index()])
            label[cell->active_cell_index()] = of_set[sets.root(cell->active_cell_index())];
        dealii::GridTools::exchange_cell_data_to_ghosts<Label, dealii::Triangulation<dim>>(
          triangulation, [&](const Cell &cell) { return label[cell->active_cell_index()]; },
          [&](const Cell &cell, const Label &value) { label[cell->active_cell_index()] = value; });
        changed = 0;
        for (const auto &[cell, ghost] : at_ghosts)
          if (Label &own = of_set[sets.root(cell)]; label[ghost] < own)
            {
              own     = label[ghost];
              changed = 1;
            }
        changed = dealii::Utilities::MPI::max(changed, triangulation.get_communicator());
      }
  }

  template <int dim>
  void
  ConnectedParts<dim>::number_pieces()
  {
    const auto sort = [](std::vector<Label> &labels) {
      std::sort(labels.begin(), labels.end());
      labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
    };
    std::vector<Label> all = label;
    sort(all);
    std::vector<Label> known;
    for (const auto &part : dealii::Utilities::MPI::all_gather(triangulation.get_communicator(), all))
      known.insert(known.end(), part.begin(), part.end());
    sort(known);
    if (!known.empty() && known.back() == no_label)
      known.pop_back();
    n_pieces = known.size();
    for (std::size_t i = 0; i < piece.size(); ++i)
      if (label[i] != no_label)
        piece[i] = std::lower_bound(known.begin(), known.end(), label[i]) - known.begin();

    periodic.assign(n_pieces, false);
    for (const auto &cell : triangulation.active_cell_iterators())
      if (cell->is_locally_owned() && piece_of(cell) != none())
        for (const unsigned int f : cell->face_indices())
          if (cell->has_periodic_neighbor(f))
            for_neighbours<dim>(cell, f, [&](const Cell &neighbour) {
              if (piece_of(neighbour) != none())
                periodic[piece_of(cell)] = true;
            });
  }

  template <int dim>
  std::vector<typename ConnectedParts<dim>::Joint>
  ConnectedParts<dim>::joints() const
  {
    std::vector<Joint>        found;
    std::vector<unsigned int> first(triangulation.n_vertices(), none());
    for (const auto &cell : triangulation.active_cell_iterators())
      if (!cell->is_artificial() && piece_of(cell) != none())
        for (const unsigned int v : cell->vertex_indices())
          {
            unsigned int &known = first[cell->vertex_index(v)];
            if (known == none())
              known = piece_of(cell);
            else if (known != piece_of(cell))
              found.push_back({known, piece_of(cell), cell->vertex(v)});
          }
    return found;
  }

  template <int dim>
  unsigned int
  ConnectedParts<dim>::n_groups() const
  {
    std::vector<unsigned int> joined; // two by two
    for (const auto &joint : joints())
      joined.insert(joined.end(), {joint.first, joint.second});
    DisjointSets sets(n_pieces);
    for (const auto &of_rank : dealii::Utilities::MPI::all_gather(triangulation.get_communicator(), joined))
      for (std::size_t i = 0; i < of_rank.size(); i += 2)
        sets.unite(of_rank[i], of_rank[i + 1]);
    unsigned int n = 0;
    for (unsigned int i = 0; i < n_pieces; ++i)
      n += sets.root(i) == i;
    return n;
  }

  template class ConnectedParts<2>;
  template class ConnectedParts<3>;
} // namespace Stroma
