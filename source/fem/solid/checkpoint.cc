// Saving and continuing SolidMethod.

#include <stroma/fem/solid/method.h>
#include <stroma/output/named_rows.h>

#include <deal.II/grid/cell_id.h>

#include <algorithm>

namespace Stroma::Fem
{
  namespace
  {
    template <int dim>
    std::uint64_t
    name_of(const typename dealii::DoFHandler<dim>::active_cell_iterator &cell)
    {
      std::uint64_t hash = 0;
      for (const unsigned int part : cell->id().template to_binary<dim>())
        {
          hash ^= part + 0x9e3779b97f4a7c15ull + (hash << 6) + (hash >> 2);
          hash *= 0xff51afd7ed558ccdull;
        }
      return hash;
    }

    dealii::ArrayView<const double>
    owned_part(const Vector &v)
    {
      return dealii::ArrayView<const double>(v.begin(), v.size() > 0 ? v.locally_owned_size() : 0);
    }

    /// Of the owned cells, in their order.
    template <int dim>
    std::vector<std::uint64_t>
    cell_names(const dealii::DoFHandler<dim> &dofs)
    {
      std::vector<std::uint64_t> names;
      for (const auto &cell : dofs.active_cell_iterators())
        if (cell->is_locally_owned())
          names.push_back(name_of<dim>(cell));
      return names;
    }
  } // namespace

  template <int dim>
  void
  SolidMethod<dim>::save(Output::ArchiveWriter &archive) const
  {
    archive.attribute("last_dt", last_dt);
    archive.attribute("solves_below_round_off", below_round_off.count);
    archive.attribute("free_parts", std::uint64_t(n_free_parts));
    const bool                 is_root = dealii::Utilities::MPI::this_mpi_process(scene.comm) == 0;
    std::vector<std::uint64_t> cells   = is_root ? mesh->history() : std::vector<std::uint64_t>();
    archive.write("refined_cells", dealii::make_array_view(cells));
    archive.write("unknown_names", dealii::make_array_view(unknowns->names()));
    archive.write("displacement", owned_part(motion.u));
    const Vector nothing(motion.u.locally_owned_elements(), scene.comm);
    archive.write("last_increment", owned_part(last_dt > 0 ? last_increment : nothing));
    if (motion.v.size() > 0)
      archive.write("velocity", owned_part(motion.v));
    if (motion.a.size() > 0)
      archive.write("acceleration", owned_part(motion.a));
    if (system->cells.cell().n_history() > 0)
      {
        archive.write("cell_names", dealii::make_array_view(cell_names(unknowns->dofs)));
        archive.write("material_history", dealii::make_array_view(system->cells.history));
      }
    system->touching.save(archive);
  }

  template <int dim>
  void
  SolidMethod<dim>::load(const Output::ArchiveReader &archive)
  {
    last_dt               = archive.attribute_double("last_dt");
    n_free_parts          = archive.attribute_uint64("free_parts");
    below_round_off.count = archive.attribute_uint64("solves_below_round_off");
    const auto check      = [](const Output::NamedRows &rows) {
      if (!rows.has_all())
        throw UserError("the checkpoint's mesh is not that of the scene; start anew with --overwrite");
    };
    const Output::NamedRows of_unknowns(archive, "unknown_names", unknowns->names(), scene.comm);
    check(of_unknowns);
    last_increment = system->new_vector();
    for (const auto &[name, vector] : {std::pair<const char *, Vector *>("displacement", &motion.u),
                                       {"last_increment", &last_increment},
                                       {"velocity", &motion.v},
                                       {"acceleration", &motion.a}})
      if (vector->size() > 0)
        {
          const auto values = of_unknowns.read_last(name, 1);
          std::copy(values.begin(), values.end(), vector->begin());
        }
    if (const unsigned int width = system->cells.cell().n_history() * system->cells.cell().n_points(); width > 0)
      {
        const Output::NamedRows of_cells(archive, "cell_names", cell_names(unknowns->dofs), scene.comm);
        check(of_cells);
        system->cells.history = of_cells.read_last("material_history", width);
      }
    system->touching.load(archive);

    Solvers::Stage stage;
    stage.t       = time;
    stage.v_known = motion.v;
    stage.a_known = motion.a;
    system->set_stage(stage, time, motion.u);
    Vector r = system->new_vector();
    system->residual(r, motion.u);
  }

  template class SolidMethod<2>;
  template class SolidMethod<3>;
} // namespace Stroma::Fem
