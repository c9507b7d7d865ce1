// Saving and continuing MpmMethod.

#include <stroma/base/text.h>
#include <stroma/mpm/method.h>
#include <stroma/mpm/point_weights.h>
#include <stroma/output/named_rows.h>

#include <algorithm>

namespace Stroma::Mpm
{
  template <int dim>
  std::vector<std::uint64_t>
  MpmMethod<dim>::unknown_names() const
  {
    // Names that do not depend on the number of ranks.
    std::vector<std::uint64_t> names;
    for (std::size_t i = 0; i < grid->nodes.n_nodes(); ++i)
      {
        const auto node = grid->nodes.node(i);
        for (unsigned int c = 0; c < dim && grid->nodes.owned.is_element(node.unknown); ++c)
          names.push_back(node.name * dim + c);
      }
    for (dealii::types::global_dof_index i = 0; i < system->bodies.size(); ++i)
      if (u.in_local_range(system->bodies.unknown(0, 0) + i))
        names.push_back(~std::uint64_t(i));
    return names;
  }

  template <int dim>
  void
  MpmMethod<dim>::save(Output::ArchiveWriter &archive) const
  {
    archive.attribute("rebase_time", rebase_time);
    archive.attribute("last_dt", last_dt);
    archive.attribute("solves_below_round_off", below_round_off.count);
    archive.attribute("free_parts", std::uint64_t(n_free_parts));
    archive.attribute("is_assembled", std::uint64_t(is_assembled));
    archive.attribute("two_moments", std::uint64_t(settings.two_moments));
    archive.attribute("shares_stiffness", std::uint64_t(settings.shares_stiffness));
    archive.attribute("n_resets", std::uint64_t(n_resets));
    archive.attribute("n_parts", std::uint64_t(n_parts));
    archive.attribute("n_points", std::uint64_t(points->n_global()));
    archive.attribute("n_first_ids", std::uint64_t(points->n_first_ids()));

    const std::vector<double> zero(last_dt > 0 ? 0 : u.locally_owned_size(), 0.);
    const double             *increment = last_dt > 0 ? last_increment.begin() : zero.data();
    archive.write("unknown_names", dealii::make_array_view(unknown_names()));
    archive.write("displacement", dealii::ArrayView<const double>(u.begin(), u.locally_owned_size()));
    archive.write("last_increment", dealii::ArrayView<const double>(increment, u.locally_owned_size()));
    if (v.size() > 0)
      archive.write("velocity", dealii::ArrayView<const double>(v.begin(), v.locally_owned_size()));

    system->touching.save(archive);
    if (settings.is_rebased() || points->history.stored())
      {
        std::vector<std::uint64_t> cells; // of each point
        std::vector<double>        numbers;
        grid->for_owned_cells([&](const auto &cell, const auto &) {
          cells.resize(cells.size() + points->handler.n_particles_in_cell(cell),
                       grid->box().cell_number(cell->center()));
          for (const auto &point : points->handler.particles_in_cell(cell))
            {
              numbers.push_back(point.get_id());
              for (unsigned int d = 0; d < dim; ++d)
                numbers.push_back(point.get_location()[d]);
              for (unsigned int d = 0; d < dim; ++d)
                numbers.push_back(point.get_reference_location()[d]);
              const auto stored = point.get_properties();
              numbers.insert(numbers.end(), stored.begin(), stored.end());
            }
        });
        archive.write("cells", dealii::make_array_view(cells));
        archive.write("points", dealii::make_array_view(numbers));
      }
  }

  template <int dim>
  void
  MpmMethod<dim>::load_points(const Output::ArchiveReader &archive)
  {
    std::vector<typename dealii::Triangulation<dim>::active_cell_iterator> owned;
    std::vector<std::uint64_t>                                             names;
    grid->for_owned_cells([&](const auto &cell, const auto &) {
      owned.push_back(cell);
      names.push_back(grid->box().cell_number(cell->center()));
    });
    const unsigned int width = 1 + 2 * dim + points->layout.size(); // id, place, place in the cell, fields
    points->set_first_ids(archive.attribute_uint64("n_first_ids"));
    const Output::NamedRows rows(archive, "cells", names, scene.comm);
    const auto              numbers = rows.read("points", width);
    const double           *next    = numbers.data();
    for (std::size_t c = 0; c < owned.size(); ++c)
      for (unsigned int i = 0; i < rows.counts()[c]; ++i, next += width)
        {
          dealii::Point<dim> x, xi;
          std::copy_n(next + 1, dim, x.begin_raw());
          std::copy_n(next + 1 + dim, dim, xi.begin_raw());
          points->handler.insert_particle(x, xi, static_cast<dealii::types::particle_index>(next[0]), owned[c],
                                          dealii::ArrayView<const double>(next + 1 + 2 * dim, points->layout.size()));
        }
    points->handler.update_cached_numbers();
  }

  template <int dim>
  void
  MpmMethod<dim>::load_displacement(const Output::ArchiveReader &archive)
  {
    if (archive.attribute_uint64("n_points") != points->n_global())
      throw UserError("the checkpoint has " + counted(archive.attribute_uint64("n_points"), "point") +
                      ", the scene makes " + grouped(points->n_global()) +
                      "; the image has changed since, so start anew with --overwrite");
    rebase_time           = archive.attribute_double("rebase_time");
    last_dt               = archive.attribute_double("last_dt");
    n_free_parts          = archive.attribute_uint64("free_parts");
    is_assembled          = archive.attribute_uint64("is_assembled") != 0;
    below_round_off.count = archive.attribute_uint64("solves_below_round_off");
    n_resets              = archive.attribute_uint64("n_resets");
    n_parts               = archive.attribute_uint64("n_parts");
    if (n_resets > 0 && settings.weighs_points())
      set_weights(*points, *grid); // to find the gradient shifts
    is_whole = !settings.may_reset() || connected_parts().n_groups() <= n_parts;

    const Output::NamedRows rows(archive, "unknown_names", unknown_names(), scene.comm);
    if (!rows.has_all())
      throw UserError("the checkpoint's grid is not that of the scene; start anew with --overwrite");
    const auto read = [&](const std::string &name, Vector &target) {
      const auto values = rows.read_last(name, 1);
      target            = system->new_vector();
      std::copy(values.begin(), values.end(), target.begin());
    };
    read("displacement", u);
    read("last_increment", last_increment);
    if (archive.has("velocity"))
      read("velocity", v);
    system->touching.load(archive);
    system->set_committed(time, rebase_time, v);
  }

  template class MpmMethod<2>;
  template class MpmMethod<3>;
} // namespace Stroma::Mpm
