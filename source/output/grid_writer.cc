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
#include <sstream>

namespace Stroma::Output
{
  namespace
  {
    template <int dim>
    void
    add_fields(dealii::DataOut<dim> &data_out, const std::vector<NodalField> &nodal,
               const std::vector<CellField> &cells, const std::vector<ScalarNodalField<dim>> &scalars)
    {
      using dealii::DataOut;
      const std::vector<dealii::DataComponentInterpretation::DataComponentInterpretation> vector(
        dim, dealii::DataComponentInterpretation::component_is_part_of_vector);
      for (const NodalField &field : nodal)
        data_out.add_data_vector(*field.values, std::vector<std::string>(dim, field.name), DataOut<dim>::type_dof_data,
                                 vector);
      for (const auto &field : scalars)
        data_out.add_data_vector(*field.dof_handler, *field.values, field.name);
      for (const CellField &field : cells)
        data_out.add_data_vector(*field.values, field.name, DataOut<dim>::type_cell_data);
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
    write_piece(const dealii::DataOut<dim> &data_out, const std::string &path)
    {
      std::ofstream out(path, std::ios::binary);
      std::string   reason = std::strerror(errno);
      if (out)
        try
          {
            data_out.write_vtu(out); // throws if the stream fails
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
  write_grid(const std::string &folder, const std::string &stem, const unsigned int counter,
             const dealii::DoFHandler<dim> &dof_handler, const std::vector<NodalField> &nodal,
             const std::vector<CellField> &cells, const std::vector<ScalarNodalField<dim>> &scalars)
  {
    const MPI_Comm       comm = dof_handler.get_communicator();
    const std::string    base = stem + "_" + dealii::Utilities::int_to_string(counter, 4);
    dealii::DataOut<dim> data_out;
    data_out.attach_dof_handler(dof_handler);
    add_fields(data_out, nodal, cells, scalars);
    select_cells_with_unknowns(data_out, dof_handler);
    data_out.build_patches(dof_handler.get_fe(0).degree);

    dealii::DataOutBase::VtkFlags flags;
    flags.compression_level = dealii::DataOutBase::VtkFlags::best_speed;
    data_out.set_flags(flags);

    const auto piece = [&base](const unsigned int rank) { return base + "." + std::to_string(rank) + ".vtu"; };
    const auto own   = folder + "/" + piece(dealii::Utilities::MPI::this_mpi_process(comm));
    const auto error = first_error(write_piece(data_out, own), comm);
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
      write_atomically(folder + "/" + base + ".pvtu", record.str());
    });
    return base + ".pvtu";
  }

  template std::string write_grid<2>(const std::string &, const std::string &, unsigned int,
                                     const dealii::DoFHandler<2> &, const std::vector<NodalField> &,
                                     const std::vector<CellField> &, const std::vector<ScalarNodalField<2>> &);
  template std::string write_grid<3>(const std::string &, const std::string &, unsigned int,
                                     const dealii::DoFHandler<3> &, const std::vector<NodalField> &,
                                     const std::vector<CellField> &, const std::vector<ScalarNodalField<3>> &);
} // namespace Stroma::Output
