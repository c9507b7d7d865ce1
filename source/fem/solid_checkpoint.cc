// Saving and continuing SolidMethod.

#include <stroma/fem/solid_method.h>
#include <stroma/output/collective.h>

#include <deal.II/grid/cell_id.h>

#include <algorithm>
#include <map>

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

    /// Puts values of the names @p from to the places of the names @p to. False if one is missing.
    bool
    place_values(const std::vector<std::uint64_t> &from, const std::vector<double> &values, const unsigned int width,
                 const std::vector<std::uint64_t> &to, double *target)
    {
      std::map<std::uint64_t, std::size_t> place;
      for (std::size_t i = 0; i < from.size(); ++i)
        place[from[i]] = i;
      for (std::size_t i = 0; i < to.size(); ++i)
        {
          const auto found = place.find(to[i]);
          if (found == place.end() || (found->second + 1) * width > values.size())
            return false;
          std::copy_n(values.data() + found->second * width, width, target + i * width);
        }
      return true;
    }
  } // namespace

  template <int dim>
  void
  SolidMethod<dim>::save(Output::ArchiveWriter &archive) const
  {
    const auto scope = timers.scope("checkpoint");
    archive.attribute("time", time);
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
        std::vector<std::uint64_t> names;
        for (const auto &cell : unknowns->dofs.active_cell_iterators())
          if (cell->is_locally_owned())
            names.push_back(name_of<dim>(cell));
        archive.write("cell_names", dealii::make_array_view(names));
        archive.write("material_history", dealii::make_array_view(system->cells.history));
      }
    for (const auto &contact : system->contacts)
      contact.save(archive);
    std::vector<double> scalars;
    for (const auto &scalar : committed_scalars)
      if (is_root)
        scalars.push_back(scalar.second);
    archive.write("scalars", dealii::make_array_view(scalars));
  }

  template <int dim>
  void
  SolidMethod<dim>::load(const Output::ArchiveReader &archive)
  {
    time    = archive.attribute_double("time");
    last_dt = archive.attribute_double("last_dt");
    n_free_parts          = archive.attribute_uint64("free_parts");
    below_round_off.count = archive.attribute_uint64("solves_below_round_off");
    const auto whole = [&](const std::string &name) {
      auto values = archive.read_double(name);
      return archive.is_same_ranks() ? values : Output::gather_all(values, scene.comm);
    };
    const auto whole_names = [&](const std::string &name) {
      auto values = archive.read_uint64(name);
      return archive.is_same_ranks() ? values : Output::gather_all(values, scene.comm);
    };
    const auto names = whole_names("unknown_names");
    const auto mine  = unknowns->names();
    last_increment   = system->new_vector();
    int found        = 1;
    for (const auto &[name, vector] : {std::pair<const char *, Vector *>("displacement", &motion.u),
                                       {"last_increment", &last_increment},
                                       {"velocity", &motion.v},
                                       {"acceleration", &motion.a}})
      if (vector->size() > 0)
        found &= place_values(names, whole(name), 1, mine, vector->begin());
    if (const unsigned int width = system->cells.cell().n_history() * system->cells.cell().n_points(); width > 0)
      {
        std::vector<std::uint64_t> cells;
        for (const auto &cell : unknowns->dofs.active_cell_iterators())
          if (cell->is_locally_owned())
            cells.push_back(name_of<dim>(cell));
        found &= place_values(whole_names("cell_names"), whole("material_history"), width, cells, system->cells.history.data());
      }
    if (dealii::Utilities::MPI::min(found, scene.comm) == 0)
      throw UserError("the checkpoint's mesh is not that of the scene; start anew with --overwrite");
    for (auto &contact : system->contacts)
      contact.load(archive);

    const auto     scalars = Output::gather_all(archive.read_double("scalars"), scene.comm);
    Solvers::Stage stage;
    stage.t       = time;
    stage.v_known = motion.v;
    stage.a_known = motion.a;
    system->set_stage(stage, time, motion.u);
    Vector r = system->new_vector();
    system->residual(r, motion.u);
    collect_scalars(motion.u);
    for (std::size_t i = 0; i < std::min(scalars.size(), committed_scalars.size()); ++i)
      committed_scalars[i].second = scalars[i];
  }

  template class SolidMethod<2>;
  template class SolidMethod<3>;
} // namespace Stroma::Fem
