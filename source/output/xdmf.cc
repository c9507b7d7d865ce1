#include <stroma/base/output_error.h>
#include <stroma/base/text.h>
#include <stroma/output/hdf5_handle.h>
#include <stroma/output/xdmf.h>

#include <cstdint>

namespace Stroma::Output
{
  namespace
  {
    bool
    write_table(const hid_t file, const std::string &name, const hid_t type, const void *data, const hsize_t rows,
                const hsize_t columns)
    {
      const hsize_t    size[] = {rows, columns};
      const Hdf5Handle space(H5Screate_simple(2, size, nullptr), H5Sclose);
      Hdf5Handle set(H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
      return set && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0 && set.close();
    }

    bool
    write_tables(const hid_t file, const std::vector<PieceField> &fields, const PointBlock &block)
    {
      const std::size_t          n = block.n_points();
      std::vector<std::uint32_t> index(n);
      for (std::size_t i = 0; i < n; ++i)
        index[i] = i;
      bool good = write_table(file, "cells", H5T_NATIVE_UINT32, index.data(), n, 1) &&
                  write_table(file, "positions", H5T_NATIVE_FLOAT, block.positions.data(), n, 3);
      for (std::size_t f = 0; f < fields.size() && good; ++f)
        good = write_table(file, fields[f].name, H5T_NATIVE_FLOAT, block.values[f].data(), n, fields[f].components);
      return good;
    }

    std::string
    data_item(const Hdf5Piece &piece, const std::string &name, const unsigned int columns, const std::string &type)
    {
      return "<DataItem Dimensions=\"" + std::to_string(piece.n_points) + " " + std::to_string(columns) +
             "\" NumberType=\"" + type + "\" Precision=\"4\" Format=\"HDF\">" + piece.file + ":/" + name +
             "</DataItem>\n";
    }

    std::string
    piece_grid(const std::vector<PieceField> &fields, const Hdf5Piece &piece)
    {
      std::string text = "<Grid Name=\"" + piece.file + "\" GridType=\"Uniform\">\n" +
                         "<Topology TopologyType=\"Polyvertex\" NumberOfElements=\"" + std::to_string(piece.n_points) +
                         "\" NodesPerElement=\"1\">\n" + data_item(piece, "cells", 1, "UInt") +
                         "</Topology>\n<Geometry GeometryType=\"XYZ\">\n" + data_item(piece, "positions", 3, "Float") +
                         "</Geometry>\n";
      for (const PieceField &field : fields)
        {
          const std::string type = field.components == 1 ? "Scalar" : field.components == 3 ? "Vector" : "Tensor";
          text += "<Attribute Name=\"" + field.name + "\" AttributeType=\"" + type + "\" Center=\"Node\">\n" +
                  data_item(piece, field.name, field.components, "Float") + "</Attribute>\n";
        }
      return text + "</Grid>\n";
    }
  } // namespace

  void
  write_hdf5_piece(const std::string &path, const std::vector<PieceField> &fields, const PointBlock &block)
  {
    const Hdf5Errors errors;
    std::size_t      numbers = 4 * block.n_points(); // positions and cells
    for (const auto &values : block.values)
      numbers += values.size();
    Hdf5Handle  file;
    std::string reason = create_with_space(file, path, numbers * sizeof(float));
    if (reason.empty() && !write_tables(file, fields, block))
      reason = errors.reason();
    if (!file.close() && reason.empty())
      reason = errors.reason();
    if (!reason.empty())
      throw OutputError(path, "the file cannot be written (" + reason + ")");
  }

  std::string
  xdmf_record(const std::vector<PieceField> &fields, const std::vector<Hdf5Piece> &pieces, const FileNotes &notes)
  {
    std::string text = "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n"
                       "<Grid Name=\"points\" GridType=\"Collection\" CollectionType=\"Spatial\">\n";
    for (const auto &[name, strings] : notes)
      text += "<Information Name=\"" + name + "\" Value=\"" + join(strings, ", ") + "\"/>\n";
    for (const Hdf5Piece &piece : pieces)
      text += piece_grid(fields, piece);
    return text + "</Grid>\n</Domain>\n</Xdmf>\n";
  }
} // namespace Stroma::Output
