#include <stroma/base/errors.h>
#include <stroma/base/text.h>
#include <stroma/particles/neighbours.h>
#include <stroma/particles/periodic.h>

#include "neighbours_sort.h"

#include <algorithm>

namespace Stroma::Particles
{
  namespace
  {
    /// Rebuilds after which particles are sorted again. In each, none has moved by more than half the skin, a sixth of a
    /// spacing: neighbours in space are still near each other in memory.
    constexpr unsigned int rebuilds_of_an_order = 20;

    template <int dim>
    bool
    is_fixed(const ParticleSet<dim> &particles, const unsigned int i)
    {
      return !particles.mover.empty() && particles.is_fixed(i);
    }

    template <typename T>
    void
    reorder(std::vector<T> &field, const std::vector<unsigned int> &order)
    {
      std::vector<T> sorted;
      sorted.reserve(order.size());
      for (const unsigned int i : order)
        sorted.push_back(field[i]);
      field.swap(sorted);
    }
  } // namespace

  template <int dim>
  Neighbours<dim>::Neighbours(const Settings &settings, MPI_Comm comm)
    : settings(settings)
    , comm(comm)
    , rank(dealii::Utilities::MPI::this_mpi_process(comm))
    , n_ranks(dealii::Utilities::MPI::n_mpi_processes(comm))
    , ghosts(comm)
  {
    Assert(settings.support > 0. && settings.skin >= 0., dealii::ExcMessage("no reach"));
    for (unsigned int d = 0; d < dim; ++d)
      if (settings.periodic[d] && !(settings.domain.side_length(d) >= 2. * reach()))
        throw UserError(
          settings.where_periodic,
          "the period along " + std::string(1, "xyz"[d]) + " is " + brief(settings.domain.side_length(d)) +
            " m, but particles of reach " + brief(reach()) +
            " m (support and skin) need at least twice that; take a smaller 'Spacing' or a longer period");

    const unsigned int n_codes = any_periodic() ? (dim == 2 ? 9 : 27) : 0;
    shifts.resize(n_codes);
    for (unsigned int code = 0; code < n_codes; ++code)
      for (unsigned int d = dim, rest = code; d-- > 0; rest /= 3)
        if (settings.periodic[d])
          shifts[code][d] = (static_cast<int>(rest % 3) - 1) * settings.domain.side_length(d);
  }

  template <int dim>
  bool
  Neighbours<dim>::any_periodic() const
  {
    return std::find(settings.periodic.begin(), settings.periodic.end(), true) != settings.periodic.end();
  }

  template <int dim>
  void
  Neighbours<dim>::rebuild(ParticleSet<dim> &particles, const bool in_order)
  {
    for (unsigned int i = 0; i < particles.n_owned; ++i)
      particles.x[i] = folded<dim>(particles.x[i], settings.domain, settings.periodic);
    particles.x_search.assign(particles.x.begin(), particles.x.begin() + particles.n_owned);
    search(particles, in_order);
  }

  template <int dim>
  void
  Neighbours<dim>::restore(ParticleSet<dim> &particles, const unsigned int n_in_order)
  {
    n_rebuilds          = 1; // so that nothing is sorted
    n_orders            = 1;
    n_rebuilds_in_order = n_in_order - 1; // unsigned: 0 comes back below
    search(particles, false);
  }

  /// As particles stand at the places of the search.
  template <int dim>
  void
  Neighbours<dim>::search(ParticleSet<dim> &particles, const bool in_order)
  {
    find_used_fields(particles);
    cells.lay(particles.x_search, reach(), settings.domain, settings.periodic, comm);
    cells.divide(particles.x_search, comm);
    const bool all_stay = migrate(particles);
    if (in_order || !all_stay || n_rebuilds == 0 || ++n_rebuilds_in_order == rebuilds_of_an_order)
      sort(particles);
    else
      visit_used(particles, [&](auto &field) { field.resize(particles.n_owned); });
    n_free_particles = particles.n_free;
    make_ghosts(particles);
    number_equations(particles);
    make_pairs(particles);
    ++n_rebuilds;
  }

  /// Which fields are used, since a rank without particles cannot tell.
  template <int dim>
  void
  Neighbours<dim>::find_used_fields(ParticleSet<dim> &particles)
  {
    used_fields.clear();
    particles.visit_fields([&](const char *, const auto &field) { used_fields.push_back(!field.empty()); });
    dealii::Utilities::MPI::max(used_fields, comm, used_fields);
  }

  /// Gives particles to the owners of their cells; those that come stand behind the ones that were here. Returns whether all
  /// particles, of all ranks, stay where they are.
  template <int dim>
  bool
  Neighbours<dim>::migrate(ParticleSet<dim> &particles)
  {
    kept.clear();
    if (n_ranks == 1)
      {
        for (unsigned int i = 0; i < particles.n_owned; ++i)
          kept.push_back(i);
        return true;
      }
    std::vector<std::vector<unsigned int>> send(n_ranks);
    for (unsigned int i = 0; i < particles.n_owned; ++i)
      {
        const unsigned int to = cells.owner_of(particles.x_search[i]);
        (to == rank ? kept : send[to]).push_back(i);
      }
    Exchange moves(comm);
    moves.reinit(send, particles.n_owned);
    visit_used(particles, [&](auto &field) {
      field.resize(particles.n_owned + moves.n_received());
      moves.copy(field);
    });
    for (unsigned int i = 0; i < moves.n_received(); ++i)
      kept.push_back(particles.n_owned + i);
    return dealii::Utilities::MPI::max(moves.n_received(), comm) == 0;
  }

  /// Free ones first, each part by cell along the curve, then by id.
  template <int dim>
  void
  Neighbours<dim>::sort(ParticleSet<dim> &particles)
  {
    const unsigned int        first = cells.first_position[rank], n_cells = cells.first_position[rank + 1] - first;
    std::vector<unsigned int> key(particles.size());
    particles.n_free = 0;
    for (const unsigned int i : kept)
      {
        const bool fixed = is_fixed(particles, i);
        key[i]           = cells.position_of(particles.x_search[i]) - first + (fixed ? n_cells : 0);
        particles.n_free += fixed ? 0 : 1;
      }
    PassSort by(kept);
    by.pass_ids(particles.id);
    by.pass(2 * n_cells, [&](const unsigned int i) { return key[i]; });

    particles.n_owned = static_cast<unsigned int>(kept.size());
    visit_used(particles, [&](auto &field) { reorder(field, kept); });
    n_rebuilds_in_order = 0;
    ++n_orders;
  }

  template <int dim>
  void
  Neighbours<dim>::number_equations(const ParticleSet<dim> &particles)
  {
    const std::uint64_t n_free = particles.n_free;
    first_equation             = 0;
    MPI_Exscan(&n_free, &first_equation, 1, MPI_UINT64_T, MPI_SUM, comm);
    n_equations = dealii::Utilities::MPI::sum(n_free, comm);
    equation.assign(particles.size(), no_equation);
    for (unsigned int i = 0; i < particles.n_free; ++i)
      equation[i] = first_equation + i;
    update_ghosts(equation);
  }

  template <int dim>
  bool
  Neighbours<dim>::outdated(const ParticleSet<dim> &particles) const
  {
    Assert(n_rebuilds == 0 || particles.x_search.size() == particles.size(),
           dealii::ExcDimensionMismatch(particles.x_search.size(), particles.size()));
    const double limit = .25 * settings.skin * settings.skin;
    bool         moved = n_rebuilds == 0;
    for (unsigned int i = 0; i < particles.n_owned && !moved; ++i)
      moved = !((particles.x[i] - particles.x_search[i]).norm_square() <= limit);
    return dealii::Utilities::MPI::max(moved ? 1 : 0, comm) == 1;
  }

  template <int dim>
  dealii::Point<dim>
  Neighbours<dim>::image_near(dealii::Point<dim> x, const dealii::Point<dim> &near) const
  {
    for (unsigned int d = 0; d < dim; ++d)
      if (settings.periodic[d])
        {
          const double period = settings.domain.side_length(d);
          x[d] += period * std::round((near[d] - x[d]) / period);
        }
    return x;
  }

  template class Neighbours<2>;
  template class Neighbours<3>;
} // namespace Stroma::Particles
