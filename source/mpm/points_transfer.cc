// The way of points to their cells after a reset, by arithmetic on the lattice of cells: it is right however far they move.

#include <stroma/mpm/points.h>

#include <deal.II/base/mpi.h>

#include <map>
#include <unordered_map>

namespace Stroma::Mpm
{
  namespace
  {
    template <int dim>
    using Cell = typename dealii::Triangulation<dim>::active_cell_iterator;

    /// Numbers that are known to travel: the cell, the id, the place, the place in the cell, the stored numbers.
    template <int dim>
    std::size_t
    width(const Layout &layout)
    {
      return 2 + 2 * dim + layout.size();
    }

    template <int dim>
    std::vector<double>
    parcel_of(const dealii::Particles::ParticleAccessor<dim> &point, const std::uint64_t cell,
              const dealii::Point<dim> &xi)
    {
      const auto          x       = point.get_location();
      const auto          numbers = point.get_properties();
      std::vector<double> parcel{double(cell), double(point.get_id())};
      parcel.insert(parcel.end(), x.begin_raw(), x.end_raw());
      parcel.insert(parcel.end(), xi.begin_raw(), xi.end_raw());
      parcel.insert(parcel.end(), numbers.begin(), numbers.end());
      return parcel;
    }

    /// Cells by their numbers.
    template <int dim>
    using KnownCells = std::unordered_map<std::uint64_t, Cell<dim>>;

    /// Owned and ghost cells of the box.
    template <int dim>
    KnownCells<dim>
    known_cells(const BackgroundGrid<dim> &grid)
    {
      KnownCells<dim> known;
      for (const auto &cell : grid.triangulation.active_cell_iterators())
        if (!cell->is_artificial() && grid.box().contains(cell->center()))
          known.emplace(grid.box().cell_number(cell->center()), cell);
      return known;
    }

    /// Makes points of the parcels that stand one behind the other in @p arrived.
    template <int dim>
    void
    insert(dealii::Particles::ParticleHandler<dim> &handler, const Layout &layout, const KnownCells<dim> &known,
           const std::vector<double> &arrived)
    {
      for (auto next = arrived.begin(); next != arrived.end(); next += width<dim>(layout))
        {
          dealii::Point<dim> x, xi;
          std::copy(next + 2, next + 2 + dim, x.begin_raw());
          std::copy(next + 2 + dim, next + 2 + 2 * dim, xi.begin_raw());
          handler.insert_particle(x, xi, static_cast<dealii::types::particle_index>(next[1]),
                                  known.at(static_cast<std::uint64_t>(next[0])),
                                  dealii::ArrayView<const double>(&*next + 2 + 2 * dim, layout.size()));
        }
    }
  } // namespace

  template <int dim>
  void
  Points<dim>::move_to_their_cells()
  {
    const auto    &box   = grid.box();
    const MPI_Comm comm  = grid.triangulation.get_communicator();
    const auto     known = known_cells(grid);
    using Iterator       = typename Handler::particle_iterator;
    std::vector<Iterator>                                           leaving;
    std::map<unsigned int, std::vector<double>>                     parcels; // by rank
    std::vector<double>                                             staying; // in other cells of this rank
    std::vector<std::pair<dealii::Point<dim>, std::vector<double>>> far;     // beyond the ghost cells: cell's centre

    // In the order of the cells, which a resumed run repeats; that of the handler tells of the past.
    for (const auto &cell : grid.triangulation.active_cell_iterators())
      {
        if (!cell->is_locally_owned())
          continue;
        const std::uint64_t here   = box.cell_number(cell->center());
        const auto          inside = handler.particles_in_cell(cell);
        for (auto point = inside.begin(); point != inside.end(); ++point)
          {
            const auto          x      = point->get_location();
            const std::uint64_t number = box.cell_number(x);
            const auto          xi     = box.place_in_cell(x);
            if (number == here)
              {
                point->set_reference_location(xi);
                continue;
              }
            leaving.push_back(point);
            auto       parcel = parcel_of<dim>(*point, number, xi);
            const auto found  = known.find(number);
            if (found == known.end())
              far.emplace_back(box.cell_centre(x), std::move(parcel));
            else
              {
                auto &to = found->second->is_locally_owned() ? staying : parcels[found->second->subdomain_id()];
                to.insert(to.end(), parcel.begin(), parcel.end());
              }
          }
      }
    std::vector<dealii::Point<dim>> centres;
    for (const auto &[centre, parcel] : far)
      centres.push_back(centre);
    // On all ranks or none: find_point_owner_rank reduces over the ranks, whatever its documentation says (9.4).
    if (dealii::Utilities::MPI::max(far.size(), comm) > 0)
      {
        const auto owners = grid.triangulation.find_point_owner_rank(centres);
        for (std::size_t i = 0; i < far.size(); ++i)
          {
            auto &to = parcels[owners[i]];
            to.insert(to.end(), far[i].second.begin(), far[i].second.end());
          }
      }
    handler.remove_particles(leaving);

    insert(handler, layout, known, staying);
    for (const auto &[from, arrived] : dealii::Utilities::MPI::some_to_some(comm, parcels))
      insert(handler, layout, known, arrived);
    handler.update_cached_numbers();
  }

  template void Points<2>::move_to_their_cells();
  template void Points<3>::move_to_their_cells();
} // namespace Stroma::Mpm
