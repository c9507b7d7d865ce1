// Saving and continuing MpmMethod.

#include <stroma/mpm/method.h>
#include <stroma/output/collective.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <map>

namespace Stroma::Mpm
{
  template <int dim>
  std::vector<std::uint64_t>
  MpmMethod<dim>::unknown_names() const
  {
    // A name that does not depend on the number of ranks: the node's number on the lattice, then the component.
    std::vector<std::uint64_t>                   names(grid->owned.n_elements());
    std::vector<dealii::types::global_dof_index> dofs(dim << dim);
    const auto                                  &box = grid->box();
    for (const auto &cell : grid->dofs.active_cell_iterators())
      if (!cell->is_artificial() && grid->is_active(cell))
        {
          cell->get_dof_indices(dofs);
          for (const unsigned int v : cell->vertex_indices())
            {
              std::uint64_t node = 0;
              for (int d = dim - 1; d >= 0; --d)
                node = node * (box.n_cells[d] + 1) +
                       std::llround((cell->vertex(v)[d] - box.lower[d]) / box.cell_size[d]);
              for (unsigned int c = 0; c < dim; ++c)
                if (grid->owned.is_element(dofs[v * dim + c]))
                  names[grid->owned.index_within_set(dofs[v * dim + c])] = node * dim + c;
            }
        }
    return names;
  }

  template <int dim>
  void
  MpmMethod<dim>::save(Output::ArchiveWriter &archive) const
  {
    const auto scope = timers.scope("checkpoint");
    archive.attribute("time", time);
    archive.attribute("rebase_time", rebase_time);
    archive.attribute("last_dt", last_dt);
    archive.attribute("solves_below_round_off", below_round_off.count);
    archive.attribute("free_parts", std::uint64_t(n_free_parts));
    archive.attribute("n_resets", std::uint64_t(n_resets));
    archive.attribute("n_parts", std::uint64_t(n_parts));
    archive.attribute("n_points", std::uint64_t(points->handler.n_global_particles()));

    const std::vector<double> zero(last_dt > 0 ? 0 : u.locally_owned_size(), 0.);
    const double *increment = last_dt > 0 ? last_increment.begin() : zero.data();
    archive.write("unknown_names", dealii::make_array_view(unknown_names()));
    archive.write("displacement", dealii::ArrayView<const double>(u.begin(), u.locally_owned_size()));
    archive.write("last_increment", dealii::ArrayView<const double>(increment, u.locally_owned_size()));
    if (v.size() > 0)
      archive.write("velocity", dealii::ArrayView<const double>(v.begin(), v.locally_owned_size()));
    std::vector<double> scalars;
    for (const auto &scalar : committed_scalars)
      scalars.push_back(scalar.second);
    if (dealii::Utilities::MPI::this_mpi_process(scene.comm) > 0)
      scalars.clear();
    archive.write("scalars", dealii::make_array_view(scalars));

    if (settings.is_rebased() || points->history.stored())
      {
        std::vector<std::uint64_t> cells, ids;
        std::vector<double>        numbers;
        for (const auto &cell : grid->triangulation.active_cell_iterators())
          if (cell->is_locally_owned() && points->handler.n_particles_in_cell(cell) > 0)
            {
              cells.push_back(grid->box().cell_number(cell->center()));
              cells.push_back(points->handler.n_particles_in_cell(cell));
              for (const auto &point : points->handler.particles_in_cell(cell))
                {
                  ids.push_back(point.get_id());
                  for (unsigned int d = 0; d < dim; ++d)
                    numbers.push_back(point.get_location()[d]);
                  for (unsigned int d = 0; d < dim; ++d)
                    numbers.push_back(point.get_reference_location()[d]);
                  const auto stored = point.get_properties();
                  numbers.insert(numbers.end(), stored.begin(), stored.end());
                }
            }
        archive.write("cells", dealii::make_array_view(cells));
        archive.write("ids", dealii::make_array_view(ids));
        archive.write("points", dealii::make_array_view(numbers));
      }
  }

  template <int dim>
  void
  MpmMethod<dim>::load_points(const Output::ArchiveReader &archive)
  {
    auto       cells   = archive.read_uint64("cells");
    auto       ids     = archive.read_uint64("ids");
    auto       numbers = archive.read_double("points");
    const bool same    = archive.is_same_ranks();
    if (!same)
      {
        cells   = Output::gather_all(cells, scene.comm);
        ids     = Output::gather_all(ids, scene.comm);
        numbers = Output::gather_all(numbers, scene.comm);
      }
    std::map<std::uint64_t, typename dealii::Triangulation<dim>::active_cell_iterator> owned_cells;
    for (const auto &cell : grid->triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        owned_cells.emplace(grid->box().cell_number(cell->center()), cell);
    const unsigned int width = 2 * dim + points->layout.size();
    std::size_t        p     = 0;
    for (std::size_t c = 0; c < cells.size(); c += 2)
      {
        const auto owned = owned_cells.find(cells[c]);
        for (std::uint64_t i = 0; i < cells[c + 1]; ++i, ++p)
          {
            if (owned == owned_cells.end())
              continue;
            const double      *next = numbers.data() + p * width;
            dealii::Point<dim> x, xi;
            for (unsigned int d = 0; d < dim; ++d)
              {
                x[d]  = next[d];
                xi[d] = next[dim + d];
              }
            points->handler.insert_particle(x, xi, static_cast<dealii::types::particle_index>(ids[p]), owned->second,
                                            dealii::ArrayView<const double>(next + 2 * dim, points->layout.size()));
          }
      }
    points->handler.update_cached_numbers();
  }

  template <int dim>
  void
  MpmMethod<dim>::load_displacement(const Output::ArchiveReader &archive)
  {
    if (archive.attribute_uint64("n_points") != points->handler.n_global_particles())
      throw UserError("the checkpoint has " + std::to_string(archive.attribute_uint64("n_points")) +
                      " points, the scene makes " + std::to_string(points->handler.n_global_particles()) +
                      "; the image has changed since, so start anew with --overwrite");
    time        = archive.attribute_double("time");
    rebase_time = archive.attribute_double("rebase_time");
    last_dt     = archive.attribute_double("last_dt");
    n_free_parts          = archive.attribute_uint64("free_parts");
    below_round_off.count = archive.attribute_uint64("solves_below_round_off");
    n_resets    = archive.attribute_uint64("n_resets");
    n_parts     = archive.attribute_uint64("n_parts");
    is_whole    = !settings.may_reset() || connected_parts().n_groups() <= n_parts;

    const auto whole = [&](auto part) { return archive.is_same_ranks() ? part : Output::gather_all(part, scene.comm); };
    const auto names = whole(archive.read_uint64("unknown_names"));
    std::vector<std::pair<std::uint64_t, std::size_t>> place(names.size());
    for (std::size_t i = 0; i < names.size(); ++i)
      place[i] = {names[i], i};
    std::sort(place.begin(), place.end());

    const auto mine  = unknown_names();
    int        found = 1;
    const auto read  = [&](const std::string &name, Vector &target) {
      const auto values = whole(archive.read_double(name));
      target            = system->new_vector();
      for (std::size_t i = 0; i < mine.size() && found; ++i)
        {
          const auto entry = std::lower_bound(place.begin(), place.end(), std::make_pair(mine[i], std::size_t(0)));
          found            = entry != place.end() && entry->first == mine[i];
          if (found)
            target.begin()[i] = values[entry->second];
        }
    };
    read("displacement", u);
    read("last_increment", last_increment);
    if (archive.has("velocity"))
      read("velocity", v);
    if (dealii::Utilities::MPI::min(found, scene.comm) == 0)
      throw UserError("the checkpoint's grid is not that of the scene; start anew with --overwrite");

    const auto scalars = Output::gather_all(archive.read_double("scalars"), scene.comm);
    Vector     r       = system->new_vector();
    system->set_committed(time, rebase_time, v);
    system->residual(r, u);
    collect_scalars(time);
    for (std::size_t i = 0; i < std::min(scalars.size(), committed_scalars.size()); ++i)
      committed_scalars[i].second = scalars[i];
  }

  template class MpmMethod<2>;
  template class MpmMethod<3>;
} // namespace Stroma::Mpm
