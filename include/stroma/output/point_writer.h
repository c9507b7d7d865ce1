#pragma once

#include <stroma/output/state_fields.h>
#include <stroma/output/vtu.h>

#include <deal.II/base/array_view.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/point.h>

namespace Stroma::Output
{
  /// File format of material points.
  enum class Format
  {
    vtu, ///< VTU pieces and a PVTU record
    xdmf ///< HDF5 pieces and an XDMF record
  };

  /**
   * Writes material points with their fields to <folder>/<stem>_<counter>.<rank>.<piece>.vtu and one record
   * <stem>_<counter>.pvtu (.h5 and .xdmf). Points are pushed one by one and a file is written whenever piece_size are
   * waiting, so memory does not grow with the number of points: 4 bytes a number, and as much again while a piece is
   * being written. Numbers are stored in single precision, two-dimensional vectors with a third component 0.
   *
   * add() is local to the rank; constructor and close() are collective. A write that fails (disk full) is reported by
   * close() on all ranks, which then removes the pieces of this record.
   */
  template <int dim>
  class PointWriter
  {
  public:
    static constexpr std::size_t piece_size = 500000; ///< points in a file

    PointWriter(const std::string &folder, const std::string &stem, unsigned int counter,
                const std::vector<Field> &fields, MPI_Comm comm, Format format = Format::vtu,
                const FileNotes &notes = {});

    /// @param x position [m]
    /// @param values all components of the first field, then of the second, and so on
    void add(const dealii::Point<dim> &x, const dealii::ArrayView<const double> &values);

    /// Writes what remains and, on rank 0, the record. Returns the record's file name without the folder.
    /// Throws OutputError on all ranks if a file could not be written. Collective.
    std::string close();

  private:
    void        flush();
    std::string piece_name(unsigned int rank, unsigned int piece) const;
    std::string record(const std::vector<std::vector<std::size_t>> &sizes) const;
    void        remove_pieces() const;

    std::string                   folder, base_name;
    MPI_Comm                      comm;
    Format                        format;
    std::vector<PieceField>       fields;
    FileNotes                     notes;
    std::vector<std::vector<int>> sources; ///< for each field and written component its place in `values`, or -1
    unsigned int                  n_values = 0;
    PointBlock                    block;
    std::vector<std::size_t>      written; ///< points of each piece of this rank
    std::string                   error;   ///< first failure of this rank
  };
} // namespace Stroma::Output
