#include <stroma/grid/lattice_level.h>
#include <stroma/grid/node_copies.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <memory>
#include <unordered_map>

namespace Stroma
{
  namespace
  {
    /// Mean square of the stiffness of the cells at a node, over its mean squared, up to which linear functions serve: more than any
    /// two materials of a contrast of 2 make, and less than a missing cell.
    constexpr float even = 1.13f;
  } // namespace

  /// Eights of each kind first; returns which of the given cells stands where.
  template <int dim>
  std::vector<unsigned int>
  LatticeLevel<dim>::order_by_kind(const std::vector<unsigned int> &kinds)
  {
    constexpr unsigned int                 width = CellMatrices<dim>::width;
    std::vector<std::vector<unsigned int>> of_kind;
    std::vector<unsigned int>              order, others;
    for (unsigned int k = 0; k < kinds.size(); ++k)
      if (kinds[k] == no_kind)
        others.push_back(k);
      else
        {
          of_kind.resize(std::max<std::size_t>(of_kind.size(), kinds[k] + 1));
          of_kind[kinds[k]].push_back(k);
        }
    left_over.resize(of_kind.size());
    for (unsigned int kind = 0; kind < of_kind.size(); ++kind)
      {
        const unsigned int n_eights = of_kind[kind].size() / width;
        shared.insert(shared.end(), n_eights, kind);
        order.insert(order.end(), of_kind[kind].begin(), of_kind[kind].begin() + width * n_eights);
      }
    for (unsigned int kind = 0; kind < of_kind.size(); ++kind)
      for (std::size_t i = of_kind[kind].size() / width * width; i < of_kind[kind].size(); ++i)
        {
          left_over[kind].push_back(order.size());
          order.push_back(of_kind[kind][i]);
        }
    order.insert(order.end(), others.begin(), others.end());
    return order;
  }

  template <int dim>
  void
  LatticeLevel<dim>::set(const std::size_t k, const dealii::FullMatrix<double> &K_cell)
  {
    matrices.set(slot.empty() ? k : slot[k], K_cell);
  }

  template <int dim>
  void
  LatticeLevel<dim>::set_kind(const unsigned int kind, const dealii::FullMatrix<double> &K_cell)
  {
    if (std::binary_search(shared.begin(), shared.end(), kind))
      matrices.set_shared(kind, K_cell);
    for (const unsigned int k : left_over[kind])
      matrices.set(k, K_cell);
  }

  template <int dim>
  LatticeLevel<dim>::LatticeLevel(const NodeLattice<dim> &nodes, std::vector<Index> given, const MPI_Comm comm,
                                  const std::vector<unsigned int> &kinds)
    : partition(std::make_shared<dealii::Utilities::MPI::Partitioner>(nodes.owned, nodes.relevant, comm))
    , cells(std::move(given))
  {
    std::vector<unsigned int> order;
    if (!kinds.empty())
      {
        const auto unordered = cells;
        order                = order_by_kind(kinds);
        slot.resize(order.size());
        for (unsigned int k = 0; k < order.size(); ++k)
          {
            slot[order[k]] = k;
            cells[k]       = unordered[order[k]];
          }
      }
    std::vector<dealii::types::global_dof_index> unknown;
    nodes.relevant.fill_index_vector(unknown);
    constexpr unsigned int n     = CellMatrices<dim>::n_nodes;
    constexpr auto         none  = std::numeric_limits<std::uint32_t>::max();
    const unsigned int     n_own = partition->locally_owned_size();
    first_cell.assign(n_own / dim, none);
    std::vector<int> first(this->cells.size() * n);
    for (std::size_t k = 0; k < this->cells.size(); ++k)
      for (unsigned int a = 0; a < n; ++a)
        {
          const unsigned int place = partition->global_to_local(
            unknown[nodes.of_cell(order.empty() ? k : order[k])[a]]);
          first[k * n + a] = place;
          if (place < n_own && first_cell[place / dim] == none)
            first_cell[place / dim] = k * n + a;
        }
    matrices.reinit(first, shared);
  }

  template <int dim>
  void
  LatticeLevel<dim>::hold(const std::vector<dealii::types::global_dof_index> &dofs, const std::vector<bool> &is_single)
  {
    held.clear();
    single.clear();
    for (std::size_t i = 0; i < dofs.size(); ++i)
      {
        held.push_back(partition->global_to_local(dofs[i]));
        if (is_single[i] && held.back() < partition->locally_owned_size())
          single.push_back(held.back());
      }
  }

  template <int dim>
  template <typename Number>
  void
  LatticeLevel<dim>::multiply_all(Values<Number> &y, const Values<Number> &x) const
  {
    x.update_ghost_values();
    y = Number();
    matrices.add_product(x.begin(), y.begin());
    y.compress(dealii::VectorOperation::add);
    for (const auto &[place, k] : springs)
      y.local_element(place) += k * x.local_element(place);
    x.zero_out_ghost_values();
  }

  template <int dim>
  template <typename Number>
  void
  LatticeLevel<dim>::vmult(Values<Number> &y, const Values<Number> &x) const
  {
    multiply_all(y, x);
    set_held_to_zero(y);
  }

  template <int dim>
  template <typename Number>
  void
  LatticeLevel<dim>::find_diagonal(Values<Number> &d) const
  {
    d = Number();
    matrices.add_diagonal(d.begin());
    d.compress(dealii::VectorOperation::add);
    for (const auto &[place, k] : springs)
      d.local_element(place) += k;
  }

  template <int dim>
  template <typename Number>
  void
  LatticeLevel<dim>::set_held_to_zero(Values<Number> &x) const
  {
    const unsigned int n_own = partition->locally_owned_size();
    for (const unsigned int place : held)
      if (place < n_own)
        x.local_element(place) = Number();
  }

  template <int dim>
  typename LatticeLevel<dim>::Index
  LatticeLevel<dim>::parent_of(const Index &cell, const std::array<unsigned int, dim> &n_cells,
                               const std::array<unsigned int, dim> &next, PlaceInParent<dim> &place)
  {
    using Place = PlaceInParent<dim>;
    Index parent;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const unsigned int i = cell[d];
        if (next[d] == n_cells[d] || (i % 2 == 0 && i + 1 == n_cells[d])) // a last one without a sibling
          place.part[d] = Place::whole;
        else
          place.part[d] = i % 2 == 0 ? Place::lower_half : Place::upper_half;
        parent[d] = next[d] == n_cells[d] ? i : i / 2;
      }
    return parent;
  }

  template <int dim>
  typename LatticeLevel<dim>::Parents
  LatticeLevel<dim>::place_in_parents(const std::array<unsigned int, dim> &n_cells,
                                      const std::array<unsigned int, dim> &next, const bool splits)
  {
    constexpr unsigned int n    = CellMatrices<dim>::n_nodes;
    constexpr auto         none = std::numeric_limits<std::uint32_t>::max();
    n_box                       = n_cells;
    places.resize(cells.size());
    std::vector<Index> parent(cells.size());
    for (std::size_t k = 0; k < cells.size(); ++k)
      parent[k] = parent_of(cells[k], n_cells, next, places[k]);
    std::unique_ptr<NodeCopies<dim>> copies;
    if (splits)
      copies = std::make_unique<NodeCopies<dim>>(matrices, places, parent, next, *partition);

    Parents                                          parents;
    std::unordered_map<std::uint64_t, std::uint32_t> first; // of the same index
    std::vector<std::uint32_t>                       after; // the next one of it
    for (std::size_t k = 0; k < cells.size(); ++k)
      {
        std::uint64_t name = 0;
        for (unsigned int d = 0; d < dim; ++d)
          name = name * next[d] + parent[k][d];
        std::array<std::uint32_t, n> copy{};
        for (unsigned int p = 0; copies && p < n; ++p)
          copy[p] = copies->copy(k, p);
        std::uint32_t *at = &first.emplace(name, none).first->second;
        while (*at != none && splits && !std::equal(copy.begin(), copy.end(), parents.copies.begin() + *at * n))
          at = &after[*at];
        const bool is_new = *at == none;
        if (is_new)
          *at = parents.cells.size();
        places[k].parent = *at;
        if (is_new)
          {
            parents.cells.push_back(parent[k]);
            if (splits)
              {
                parents.copies.insert(parents.copies.end(), copy.begin(), copy.end());
                after.push_back(none);
              }
          }
      }
    parents.kinds = kinds_of_parents(parents, next);
    return parents;
  }

  /// Of each cell of this rank, in the order of their matrices; empty where cells have no kinds.
  template <int dim>
  std::vector<unsigned int>
  LatticeLevel<dim>::find_kinds() const
  {
    std::vector<unsigned int> kinds(left_over.empty() ? 0 : cells.size(), no_kind);
    for (std::size_t k = 0; k < matrices.n_sharing(); ++k)
      kinds[k] = shared[k / CellMatrices<dim>::width];
    for (unsigned int kind = 0; kind < left_over.size(); ++kind)
      for (const unsigned int k : left_over[kind])
        kinds[k] = kind;
    return kinds;
  }

  /// Parents with all their children on this rank, and all of one kind, are of it too.
  template <int dim>
  std::vector<unsigned int>
  LatticeLevel<dim>::kinds_of_parents(const Parents &parents, const std::array<unsigned int, dim> &next) const
  {
    const auto                kinds = find_kinds();
    std::vector<unsigned int> of_parent(kinds.empty() ? 0 : parents.cells.size(), no_kind);
    std::vector<std::uint8_t> n_alike(of_parent.size(), 0);
    unsigned int              all = 1;
    for (unsigned int d = 0; d < dim; ++d)
      all *= next[d] == n_box[d] ? 1 : 2;
    for (std::size_t k = 0; k < kinds.size(); ++k)
      if (const auto parent = places[k].parent; n_alike[parent] == 0 || of_parent[parent] == kinds[k])
        {
          of_parent[parent] = kinds[k];
          ++n_alike[parent];
        }
    for (std::size_t parent = 0; parent < of_parent.size(); ++parent)
      if (n_alike[parent] < all)
        of_parent[parent] = no_kind;
    return of_parent;
  }

  /// The matrices of the coarse grid's kinds: of the children of one cell of each.
  template <int dim>
  void
  LatticeLevel<dim>::coarsen_kinds(LatticeLevel &coarse, const std::vector<unsigned int> &kinds) const
  {
    constexpr auto                          none = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t>              first(coarse.left_over.size(), none);
    std::vector<dealii::FullMatrix<double>> sum(first.size());
    for (std::size_t k = 0; k < places.size() && !kinds.empty(); ++k)
      if (const unsigned int kind = kinds[places[k].parent]; kind != no_kind)
        {
          if (first[kind] == none)
            {
              first[kind] = places[k].parent;
              sum[kind].reinit(matrices.n_rows, matrices.n_rows);
            }
          if (first[kind] == places[k].parent)
            weights.add_parent(matrices, k, places[k], sum[kind]);
        }
    for (unsigned int kind = 0; kind < first.size(); ++kind)
      if (first[kind] != none)
        coarse.set_kind(kind, sum[kind]);
  }

  /// Calls visit(first unknown of an owned node, that of a coarse one that moves it, by how much, the block of bent weights).
  template <int dim>
  template <typename Visit>
  void
  LatticeLevel<dim>::for_parents(const LatticeLevel &coarse, const Visit &visit) const
  {
    constexpr unsigned int n = CellMatrices<dim>::n_nodes;
    for (std::size_t node = 0; node < first_cell.size(); ++node)
      {
        const PlaceInParent<dim> &place = places[first_cell[node] / n];
        for (unsigned int p = 0; p < n; ++p)
          if (const float weight = place.weight(first_cell[node] % n, p); weight > 0.f)
            visit(node * dim, coarse.matrices.first(place.parent, p), weight, weights.of_node(node, p));
      }
  }

  template <int dim>
  void
  LatticeLevel<dim>::hold_coarser(LatticeLevel &coarse) const
  {
    auto               is_held = new_vector<float>(), moves_held = coarse.template new_vector<float>();
    const unsigned int n_own = partition->locally_owned_size();
    for (const unsigned int place : held)
      if (place < n_own)
        is_held.local_element(place) = 1.f;
    for (const unsigned int place : single)
      is_held.local_element(place) = 0.f;
    for_parents(coarse, [&](const unsigned int fine, const unsigned int other, const float weight, const float *) {
      for (unsigned int i = 0; i < dim; ++i)
        moves_held.begin()[other + i] += weight * is_held.begin()[fine + i];
    });
    moves_held.compress(dealii::VectorOperation::add);
    moves_held.update_ghost_values();
    coarse.held.clear();
    for (unsigned int i = 0; i < coarse.partition->locally_owned_size() + coarse.partition->n_ghost_indices(); ++i)
      if (moves_held.local_element(i) > 0.f)
        coarse.held.push_back(i);
  }

  template <int dim>
  void
  LatticeLevel<dim>::coarsen(LatticeLevel &coarse)
  {
    const auto kinds = coarse.find_kinds();
    if (!dealii::Utilities::MPI::logical_or(!left_over.empty(), partition->get_mpi_communicator()))
      find_weights(); // else cells of a kind have the same functions
    coarse.matrices.allocate();
    coarse.matrices.set_zero();
    std::vector<bool> is_done(kinds.empty() ? 0 : cells.size());
    for (std::size_t k = 0; k < is_done.size(); ++k)
      is_done[k] = kinds[places[k].parent] != no_kind;
    weights.coarsen(matrices, places, is_done, coarse.matrices);
    coarsen_kinds(coarse, kinds);
    coarsen_springs(coarse);
  }

  template <int dim>
  void
  LatticeLevel<dim>::find_weights()
  {
    const auto is_uneven = find_uneven();
    auto       diagonal  = new_vector<float>();
    find_diagonal(diagonal);
    diagonal.update_ghost_values();
    weights.find(matrices, places, is_uneven, diagonal);
  }

  /// By node of this rank: whether the cells around it differ in stiffness, or some are missing, and nothing holds it.
  template <int dim>
  std::vector<bool>
  LatticeLevel<dim>::find_uneven() const
  {
    constexpr unsigned int n   = CellMatrices<dim>::n_nodes;
    auto                   sum = new_vector<float>(); // of stiffness over how many there may be, and of its square
    for (std::size_t k = 0; k < cells.size(); ++k)
      {
        const float trace = matrices.trace(k);
        for (unsigned int a = 0; a < n; ++a)
          {
            float share = 1.f / n;
            for (unsigned int d = 0; d < dim; ++d)
              if (const unsigned int i = cells[k][d] + (a >> d & 1); i == 0 || i == n_box[d])
                share *= 2.f;
            float *const here = sum.begin() + matrices.first(k, a);
            here[0] += share * trace;
            here[1] += share * trace * trace;
          }
      }
    sum.compress(dealii::VectorOperation::add);
    for (const auto &[place, k] : springs)
      sum.local_element(place / dim * dim + 1) = 0.f;
    sum.update_ghost_values();
    std::vector<bool> is_uneven((partition->locally_owned_size() + partition->n_ghost_indices()) / dim);
    for (std::size_t node = 0; node < is_uneven.size(); ++node)
      {
        const float *const here = sum.begin() + node * dim;
        is_uneven[node]         = here[1] > even * here[0] * here[0];
      }
    for (const unsigned int place : held)
      is_uneven[place / dim] = false;
    return is_uneven;
  }

  /// A spring that is moved by several coarse unknowns is shared out among them.
  template <int dim>
  void
  LatticeLevel<dim>::coarsen_springs(LatticeLevel &coarse) const
  {
    coarse.springs.clear();
    if (dealii::Utilities::MPI::sum(single.size() + springs.size(), partition->get_mpi_communicator()) == 0)
      return;
    auto diagonal = new_vector<float>(), k = diagonal, k_coarse = coarse.template new_vector<float>();
    find_diagonal(diagonal);
    for (const unsigned int place : single)
      k.local_element(place) = diagonal.local_element(place);
    for (const auto &[place, stiffness] : springs)
      k.local_element(place) = stiffness;
    restrict_to(coarse, k_coarse, k);
    for (unsigned int place = 0; place < coarse.partition->locally_owned_size(); ++place)
      if (k_coarse.local_element(place) > 0.f)
        coarse.springs.emplace_back(place, k_coarse.local_element(place));
  }

  template <int dim>
  void
  LatticeLevel<dim>::restrict_to(const LatticeLevel &coarse, Values<float> &r_coarse, const Values<float> &r) const
  {
    r_coarse                = 0.f;
    const float *const from = r.begin();
    float *const       to   = r_coarse.begin();
    for_parents(coarse, [&](const unsigned int fine, const unsigned int other, const float weight, const float *W) {
      for (unsigned int i = 0; i < dim; ++i)
        if (!W)
          to[other + i] += weight * from[fine + i];
        else
          for (unsigned int j = 0; j < dim; ++j)
            to[other + j] += W[i * dim + j] * from[fine + i];
    });
    r_coarse.compress(dealii::VectorOperation::add);
    coarse.set_held_to_zero(r_coarse);
  }

  template <int dim>
  void
  LatticeLevel<dim>::add_prolonged(const LatticeLevel &coarse, Values<float> &x, const Values<float> &x_coarse) const
  {
    x_coarse.update_ghost_values();
    const float *const from = x_coarse.begin();
    float *const       to   = x.begin();
    for_parents(coarse, [&](const unsigned int fine, const unsigned int other, const float weight, const float *W) {
      for (unsigned int i = 0; i < dim; ++i)
        if (!W)
          to[fine + i] += weight * from[other + i];
        else
          for (unsigned int j = 0; j < dim; ++j)
            to[fine + i] += W[i * dim + j] * from[other + j];
    });
    x_coarse.zero_out_ghost_values();
    set_held_to_zero(x);
  }

#define INSTANTIATE(dim, Number)                                                                                       \
  template void LatticeLevel<dim>::vmult(Values<Number> &, const Values<Number> &) const;                              \
  template void LatticeLevel<dim>::multiply_all(Values<Number> &, const Values<Number> &) const;                       \
  template void LatticeLevel<dim>::find_diagonal(Values<Number> &) const;                                              \
  template void LatticeLevel<dim>::set_held_to_zero(Values<Number> &) const;
  template class LatticeLevel<2>;
  template class LatticeLevel<3>;
  INSTANTIATE(2, float)
  INSTANTIATE(2, double)
  INSTANTIATE(3, float)
  INSTANTIATE(3, double)
#undef INSTANTIATE
} // namespace Stroma
