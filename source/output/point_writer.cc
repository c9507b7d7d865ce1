#include <stroma/base/output_error.h>
#include <stroma/output/collective.h>
#include <stroma/output/point_writer.h>
#include <stroma/output/text_file.h>
#include <stroma/output/vtu.h>
#include <stroma/output/xdmf.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace Stroma::Output
{
  namespace
  {
    /// For each component in the file the component given to add(), or -1 for a zero.
    std::vector<int>
    component_sources(const unsigned int components, const Format format)
    {
      switch (components)
        {
          case 1:
            return {0};
          case 2:
            return {0, 1, -1};
          case 3:
            return {0, 1, 2};
          case 6:
            return format == Format::vtu ? std::vector<int>{0, 1, 2, 3, 5, 4} :
                                           std::vector<int>{0, 3, 4, 3, 1, 5, 4, 5, 2};
          default:
            Assert(components == 9, dealii::ExcMessage("a field has 1, 2, 3, 6 or 9 components"));
            return {0, 1, 2, 3, 4, 5, 6, 7, 8};
        }
    }

    void
    write_vtu_file(const std::string &path, const std::vector<PieceField> &fields, const PointBlock &block,
                   const FileNotes &notes)
    {
      errno = 0;
      std::ofstream out(path, std::ios::binary);
      write_vtu(out, fields, block, notes);
      out.close();
      if (!out)
        throw OutputError(path, std::string("the file cannot be written (") + std::strerror(errno) + ")");
    }
  } // namespace

  template <int dim>
  PointWriter<dim>::PointWriter(const std::string &folder, const std::string &stem, const unsigned int counter,
                                const std::vector<Field> &given, const MPI_Comm comm, const Format format,
                                const FileNotes &notes)
    : folder(folder)
    , base_name(stem + "_" + dealii::Utilities::int_to_string(counter, 4))
    , comm(comm)
    , format(format)
    , notes(notes)
  {
    for (const Field &field : given)
      {
        sources.push_back(component_sources(field.components, format));
        for (int &source : sources.back())
          source += source < 0 ? 0 : n_values;
        fields.push_back({field.name, static_cast<unsigned int>(sources.back().size())});
        n_values += field.components;
      }
    block.values.resize(fields.size());
  }

  template <int dim>
  void
  PointWriter<dim>::add(const dealii::Point<dim> &x, const dealii::ArrayView<const double> &values)
  {
    AssertDimension(values.size(), n_values);
    for (unsigned int d = 0; d < 3; ++d)
      block.positions.push_back(d < dim ? static_cast<float>(x[d]) : 0.f);
    for (std::size_t f = 0; f < fields.size(); ++f)
      for (const int source : sources[f])
        block.values[f].push_back(source < 0 ? 0.f : static_cast<float>(values[source]));
    if (block.n_points() == piece_size)
      flush();
  }

  template <int dim>
  void
  PointWriter<dim>::flush()
  {
    const std::string path = folder + "/" + piece_name(dealii::Utilities::MPI::this_mpi_process(comm), written.size());
    written.push_back(block.n_points());
    if (error.empty())
      try
        {
          format == Format::vtu ? write_vtu_file(path, fields, block, notes) : write_hdf5_piece(path, fields, block);
        }
      catch (const std::exception &exception)
        {
          error = exception.what();
        }
    block.positions.clear();
    for (auto &values : block.values)
      values.clear();
  }

  template <int dim>
  std::string
  PointWriter<dim>::close()
  {
    const bool first = dealii::Utilities::MPI::this_mpi_process(comm) == 0;
    if (block.n_points() > 0 || (first && written.empty()))
      flush();
    block                   = {};
    const auto        sizes = dealii::Utilities::MPI::gather(comm, written);
    const std::string name  = base_name + (format == Format::vtu ? ".pvtu" : ".xdmf");
    try
      {
        throw_if_any<OutputError>(error, comm);
        on_root(comm, [&] { write_atomically(folder + "/" + name, record(sizes)); });
      }
    catch (...)
      {
        remove_pieces();
        throw;
      }
    return name;
  }

  template <int dim>
  std::string
  PointWriter<dim>::piece_name(const unsigned int rank, const unsigned int piece) const
  {
    return base_name + "." + std::to_string(rank) + "." + std::to_string(piece) +
           (format == Format::vtu ? ".vtu" : ".h5");
  }

  template <int dim>
  std::string
  PointWriter<dim>::record(const std::vector<std::vector<std::size_t>> &sizes) const
  {
    std::vector<std::string> names;
    std::vector<Hdf5Piece>   pieces;
    for (std::size_t rank = 0; rank < sizes.size(); ++rank)
      for (std::size_t piece = 0; piece < sizes[rank].size(); ++piece)
        {
          names.push_back(piece_name(rank, piece));
          pieces.push_back({names.back(), sizes[rank][piece]});
        }
    return format == Format::vtu ? pvtu_record(fields, names) : xdmf_record(fields, pieces, notes);
  }

  template <int dim>
  void
  PointWriter<dim>::remove_pieces() const
  {
    const unsigned int rank = dealii::Utilities::MPI::this_mpi_process(comm);
    std::error_code    ignored;
    for (std::size_t piece = 0; piece < written.size(); ++piece)
      std::filesystem::remove(folder + "/" + piece_name(rank, piece), ignored);
  }

  template class PointWriter<2>;
  template class PointWriter<3>;
} // namespace Stroma::Output
