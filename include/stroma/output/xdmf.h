#pragma once

#include <stroma/output/vtu.h>

namespace Stroma::Output
{
  /// Writes points and fields as datasets of one HDF5 file. Local to the rank. Throws UserError.
  void write_hdf5_piece(const std::string &path, const std::vector<PieceField> &fields, const PointBlock &block);

  /// An HDF5 piece as the record names it.
  struct Hdf5Piece
  {
    std::string file; ///< relative to the record
    std::size_t n_points;
  };

  /// The XDMF record (a spatial collection) that joins pieces. Tensors have nine components there; @p notes are its
  /// Information.
  std::string xdmf_record(const std::vector<PieceField> &fields, const std::vector<Hdf5Piece> &pieces,
                          const FileNotes &notes = {});
} // namespace Stroma::Output
