#include <stroma/base/output_error.h>
#include <stroma/output/vtu.h>

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <ostream>

namespace Stroma::Output
{
  namespace
  {
    constexpr std::size_t block_size  = 1 << 16; // bytes compressed at a time
    constexpr std::size_t sample_size = 1 << 12; // of which so many decide whether it is worth it

    void
    compress(std::vector<Bytef> &out, uLongf &size, const Bytef *source, const std::size_t n_bytes, const int level)
    {
      size = out.size();
      if (compress2(out.data(), &size, source, n_bytes, level) != Z_OK)
        throw OutputError("zlib could not compress a block of output");
    }

    /// Numbers that vary shrink by a fifth at best, at 25 MB/s: these are stored. Zeros, lattices and indices shrink
    /// to a small part, and faster.
    int
    worthwhile_level(std::vector<Bytef> &out, const Bytef *source, const std::size_t n_bytes)
    {
      const std::size_t sample = std::min(n_bytes, sample_size);
      uLongf            size;
      compress(out, size, source, sample, Z_BEST_SPEED);
      return size < sample * 6 / 10 ? Z_BEST_SPEED : Z_NO_COMPRESSION;
    }

    /// Appends @p bytes in VTK's compressed form: number of blocks, their size, size of a last partial one, the
    /// compressed sizes, the compressed blocks.
    void
    append_compressed(std::string &out, const void *bytes, const std::size_t n_bytes)
    {
      const std::size_t          n_blocks = (n_bytes + block_size - 1) / block_size;
      std::vector<std::uint64_t> header   = {n_blocks, block_size, n_bytes % block_size};
      header.resize(3 + n_blocks);
      const std::size_t start = out.size(), header_bytes = header.size() * sizeof(std::uint64_t);
      out.resize(start + header_bytes);

      std::vector<Bytef> compressed(compressBound(block_size));
      for (std::size_t b = 0; b < n_blocks; ++b)
        {
          const auto       *source = static_cast<const Bytef *>(bytes) + b * block_size;
          const std::size_t length = std::min(block_size, n_bytes - b * block_size);
          uLongf            size;
          compress(compressed, size, source, length, worthwhile_level(compressed, source, length));
          header[3 + b] = size;
          out.append(reinterpret_cast<const char *>(compressed.data()), size);
        }
      std::copy_n(reinterpret_cast<const char *>(header.data()), header_bytes, out.begin() + start);
    }

    /// A <DataArray> whose content is @p data, appended to @p appended.
    template <typename T>
    std::string
    data_array(const std::string &type, const std::string &name, const unsigned int components,
               const std::vector<T> &data, std::string &appended)
    {
      const std::string text = "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                               std::to_string(components) + "\" format=\"appended\" offset=\"" +
                               std::to_string(appended.size()) + "\"/>\n";
      append_compressed(appended, data.data(), data.size() * sizeof(T));
      return text;
    }

    /// One vertex cell for each point.
    std::string
    vertex_cells(const std::size_t n, std::string &appended)
    {
      constexpr std::uint8_t    vtk_vertex = 1;
      std::vector<std::int32_t> index(n);
      for (std::size_t i = 0; i < n; ++i)
        index[i] = i;
      std::string text = "<Cells>\n" + data_array("Int32", "connectivity", 1, index, appended);
      for (auto &i : index)
        ++i;
      text += data_array("Int32", "offsets", 1, index, appended);
      text += data_array("UInt8", "types", 1, std::vector<std::uint8_t>(n, vtk_vertex), appended);
      return text + "</Cells>\n";
    }

    std::string
    file_head(const std::string &type)
    {
      return "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type +
             "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" "
             "compressor=\"vtkZLibDataCompressor\">\n";
    }
  } // namespace

  /// Strings of a file are the codes of their characters, with a 0 behind each.
  std::string
  field_data(const FileNotes &notes)
  {
    std::string text;
    for (const auto &[name, strings] : notes)
      if (!strings.empty())
        {
          text += "<DataArray type=\"String\" Name=\"" + name + "\" NumberOfTuples=\"" +
                  std::to_string(strings.size()) + "\" format=\"ascii\">\n";
          for (const auto &string : strings)
            {
              for (const char c : string)
                text += std::to_string(static_cast<unsigned char>(c)) + " ";
              text += "0\n";
            }
          text += "</DataArray>\n";
        }
    return text.empty() ? "" : "<FieldData>\n" + text + "</FieldData>\n";
  }

  void
  write_vtu(std::ostream &out, const std::vector<PieceField> &fields, const PointBlock &block, const FileNotes &notes)
  {
    const std::string n = std::to_string(block.n_points());
    std::string       appended;
    std::size_t       numbers = 5 * block.n_points(); // positions, connectivity, offsets
    for (const auto &values : block.values)
      numbers += values.size();
    appended.reserve(numbers * sizeof(float) + block.n_points() + (1 << 16)); // growing would need twice the memory
    out << file_head("UnstructuredGrid") << "<UnstructuredGrid>\n"
        << field_data(notes) << "<Piece NumberOfPoints=\"" << n << "\" NumberOfCells=\"" << n << "\">\n<Points>\n"
        << data_array("Float32", "Points", 3, block.positions, appended) << "</Points>\n"
        << vertex_cells(block.n_points(), appended) << "<PointData>\n";
    for (std::size_t f = 0; f < fields.size(); ++f)
      out << data_array("Float32", fields[f].name, fields[f].components, block.values[f], appended);
    out << "</PointData>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_" << appended
        << "\n</AppendedData>\n</VTKFile>\n";
  }

  std::string
  pvtu_record(const std::vector<PieceField> &fields, const std::vector<std::string> &pieces)
  {
    std::string text = file_head("PUnstructuredGrid") + "<PUnstructuredGrid GhostLevel=\"0\">\n<PPoints>\n" +
                       "<PDataArray type=\"Float32\" Name=\"Points\" NumberOfComponents=\"3\"/>\n</PPoints>\n" +
                       "<PPointData>\n";
    for (const PieceField &field : fields)
      text += "<PDataArray type=\"Float32\" Name=\"" + field.name + "\" NumberOfComponents=\"" +
              std::to_string(field.components) + "\"/>\n";
    text += "</PPointData>\n";
    for (const std::string &piece : pieces)
      text += "<Piece Source=\"" + piece + "\"/>\n";
    return text + "</PUnstructuredGrid>\n</VTKFile>\n";
  }
} // namespace Stroma::Output
