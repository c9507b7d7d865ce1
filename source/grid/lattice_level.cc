#include <stroma/grid/lattice_level.h>

#include <algorithm>
#include <map>
#include <unordered_map>

namespace Stroma
{
  template <int dim>
  LatticeLevel<dim>::LatticeLevel(const NodeLattice<dim> &nodes, std::vector<Index> cells, const MPI_Comm comm)
    : partition(std::make_shared<dealii::Utilities::MPI::Partitioner>(nodes.owned, nodes.relevant, comm))
    , cells(std::move(cells))
  {
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
          const unsigned int place = partition->global_to_local(unknown[nodes.of_cell(k)[a]]);
          first[k * n + a]         = place;
          if (place < n_own && first_cell[place / dim] == none)
            first_cell[place / dim] = k * n + a;
        }
    matrices.reinit(first);
  }

  template <int dim>
  void
  LatticeLevel<dim>::hold(const std::vector<dealii::types::global_dof_index> &dofs)
  {
    held.clear();
    for (const auto dof : dofs)
      held.push_back(partition->global_to_local(dof));
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
  std::vector<typename LatticeLevel<dim>::Index>
  LatticeLevel<dim>::place_in_parents(const std::array<unsigned int, dim> &n_cells,
                                      const std::array<unsigned int, dim> &next)
  {
    using Place = PlaceInParent<dim>;
    std::unordered_map<std::uint64_t, std::uint32_t> met;
    std::vector<Index>                               parents;
    places.resize(cells.size());
    for (std::size_t k = 0; k < cells.size(); ++k)
      {
        Index         parent = cells[k];
        std::uint64_t name   = 0;
        for (unsigned int d = 0; d < dim; ++d)
          {
            const unsigned int i = cells[k][d];
            if (next[d] == n_cells[d] || (i % 2 == 0 && i + 1 == n_cells[d])) // a last one without a sibling
              places[k].part[d] = Place::whole;
            else
              places[k].part[d] = i % 2 == 0 ? Place::lower_half : Place::upper_half;
            parent[d] = next[d] == n_cells[d] ? i : i / 2;
            name      = name * next[d] + parent[d];
          }
        const auto [at, is_new] = met.emplace(name, parents.size());
        if (is_new)
          parents.push_back(parent);
        places[k].parent = at->second;
      }
    return parents;
  }

  /// Calls visit(first unknown of an owned node, that of a coarse one that moves it, by how much).
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
            visit(node * dim, coarse.matrices.first(place.parent, p), weight);
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
    for_parents(coarse, [&](const unsigned int fine, const unsigned int other, const float weight) {
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
  LatticeLevel<dim>::coarsen(LatticeLevel &coarse) const
  {
    coarse.matrices.allocate();
    coarse.matrices.set_zero();
    coarse.matrices.add_coarsened(matrices, places);
  }

  template <int dim>
  void
  LatticeLevel<dim>::restrict_to(const LatticeLevel &coarse, Values<float> &r_coarse, const Values<float> &r) const
  {
    r_coarse                = 0.f;
    const float *const from = r.begin();
    float *const       to   = r_coarse.begin();
    for_parents(coarse, [&](const unsigned int fine, const unsigned int other, const float weight) {
      for (unsigned int i = 0; i < dim; ++i)
        to[other + i] += weight * from[fine + i];
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
    for_parents(coarse, [&](const unsigned int fine, const unsigned int other, const float weight) {
      for (unsigned int i = 0; i < dim; ++i)
        to[fine + i] += weight * from[other + i];
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
