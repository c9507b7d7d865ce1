#include <stroma/base/output_error.h>
#include <stroma/output/collective.h>
#include <stroma/output/grid_writer.h>
#include <stroma/output/text_file.h>

#include <deal.II/grid/filtered_iterator.h>
#include <deal.II/numerics/data_out.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

namespace Stroma::Output
{
  namespace
  {
    /// deal.II's, in the units and with the notes of a file.
    template <int dim>
    class GridData : public dealii::DataOut<dim>
    {
    public:
      /// Fields are called with their unit; @p factor turns numbers in SI into it.
      void
      know(const std::string &name, const double factor)
      {
        factors[name] = factor;
      }

      void
      write(std::ostream &out, const GridFile &file, const dealii::DataOutBase::VtkFlags &flags) const
      {
        namespace Base = dealii::DataOutBase;
        Base::write_vtu_header(out, flags);
        out << field_data(file.notes);
        const bool    as_it_is = file.units.is_si();
        const Patches scaled   = as_it_is ? Patches() : in_units(file);
        Base::write_vtu_main(as_it_is ? this->get_patches() : scaled, this->get_dataset_names(),
                             this->get_nonscalar_data_ranges(), flags, out);
        Base::write_vtu_footer(out);
      }

    private:
      using Patches = std::vector<dealii::DataOutBase::Patch<dim, dim>>;

      Patches
      in_units(const GridFile &file) const
      {
        Patches      patches = this->get_patches();
        const auto   names   = this->get_dataset_names();
        const double length  = file.units.of("m").factor;
        for (auto &patch : patches)
          {
            for (auto &vertex : patch.vertices)
              vertex *= length;
            for (unsigned int row = 0; row < names.size(); ++row)
              for (unsigned int i = 0; i < patch.data.n_cols(); ++i)
                patch.data(row, i) *= static_cast<float>(factors.at(names[row]));
          }
        return patches;
      }

      std::map<std::string, double> factors;
    };

    template <int dim>
    void
    add_fields(GridData<dim> &data_out, const FileUnits &units, const std::vector<NodalField> &nodal,
               const std::vector<CellField> &cells, const std::vector<ScalarNodalField<dim>> &scalars)
    {
      const auto named = [&](const auto &field) {
        const auto name = units.name(field.name, field.unit);
        data_out.know(name, units.of(field.unit).factor);
        return name;
      };
      using dealii::DataOut;
      const std::vector<dealii::DataComponentInterpretation::DataComponentInterpretation> vector(
        dim, dealii::DataComponentInterpretation::component_is_part_of_vector);
      for (const NodalField &field : nodal)
        data_out.add_data_vector(*field.values, std::vector<std::string>(dim, named(field)),
                                 DataOut<dim>::type_dof_data, vector);
      for (const auto &field : scalars)
        data_out.add_data_vector(*field.dof_handler, *field.values, named(field));
      for (const CellField &field : cells)
        data_out.add_data_vector(*field.values, named(field), DataOut<dim>::type_cell_data);
    }

    template <int dim>
    void
    select_cells_with_unknowns(dealii::DataOut<dim> &data_out, const dealii::DoFHandler<dim> &dof_handler)
    {
      using Cell                  = typename dealii::Triangulation<dim>::cell_iterator;
      const auto carries_unknowns = [&dof_handler](const Cell &cell) {
        if (!cell->is_active() || !cell->is_locally_owned())
          return false;
        const typename dealii::DoFHandler<dim>::active_cell_iterator dof_cell(&dof_handler.get_triangulation(),
                                                                              cell->level(), cell->index(),
                                                                              &dof_handler);
        return dof_cell->active_fe_index() == 0;
      };
      data_out.set_cell_selection(dealii::FilteredIterator<Cell>(carries_unknowns));
    }

    /// Reason of failure, or "".
    template <int dim>
    std::string
    write_piece(const GridData<dim> &data_out, const GridFile &file, const std::string &path)
    {
      std::ofstream out(path, std::ios::binary);
      std::string   reason = std::strerror(errno);
      if (out)
        try
          {
            dealii::DataOutBase::VtkFlags flags;
            flags.compression_level = dealii::DataOutBase::VtkFlags::best_speed;
            data_out.write(out, file, flags); // throws if the stream fails
            out.close();
            reason = std::strerror(errno);
          }
        catch (const std::exception &)
          {
            reason = "disk full?";
            out.setstate(std::ios::failbit);
          }
      return out ? "" : path + ": the file cannot be written (" + reason + ")";
    }
  } // namespace

  template <int dim>
  std::string
  write_grid(const GridFile &file, const dealii::DoFHandler<dim> &dof_handler, const std::vector<NodalField> &nodal,
             const std::vector<CellField> &cells, const std::vector<ScalarNodalField<dim>> &scalars)
  {
    const MPI_Comm    comm = dof_handler.get_communicator();
    const std::string base = "grid_" + dealii::Utilities::int_to_string(file.counter, 4);
    GridData<dim>     data_out;
    data_out.attach_dof_handler(dof_handler);
    add_fields(data_out, file.units, nodal, cells, scalars);
    select_cells_with_unknowns(data_out, dof_handler);
    data_out.build_patches(dof_handler.get_fe(0).degree);

    const auto piece = [&base](const unsigned int rank) { return base + "." + std::to_string(rank) + ".vtu"; };
    const auto own   = file.folder + "/" + piece(dealii::Utilities::MPI::this_mpi_process(comm));
    const auto error = first_error(write_piece(data_out, file, own), comm);
    if (!error.empty())
      {
        std::error_code ignored;
        std::filesystem::remove(own, ignored);
        throw OutputError(error);
      }
    on_root(comm, [&] {
      std::vector<std::string> pieces;
      for (unsigned int rank = 0; rank < dealii::Utilities::MPI::n_mpi_processes(comm); ++rank)
        pieces.push_back(piece(rank));
      std::ostringstream record;
      data_out.write_pvtu_record(record, pieces);
      write_atomically(file.folder + "/" + base + ".pvtu", record.str());
    });
    return base + ".pvtu";
  }

  template std::string write_grid<2>(const GridFile &, const dealii::DoFHandler<2> &, const std::vector<NodalField> &,
                                     const std::vector<CellField> &, const std::vector<ScalarNodalField<2>> &);
  template std::string write_grid<3>(const GridFile &, const dealii::DoFHandler<3> &, const std::vector<NodalField> &,
                                     const std::vector<CellField> &, const std::vector<ScalarNodalField<3>> &);
} // namespace Stroma::Output
