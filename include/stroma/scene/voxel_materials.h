#pragma once

#include <stroma/base/parameters.h>
#include <stroma/image/frame.h>

#include <deal.II/base/array_view.h>
#include <deal.II/base/mpi.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace Stroma
{
  /// Voxels with a material each, the same on all ranks; the ranks of a node share one copy of them.
  struct VoxelMaterials
  {
    static constexpr std::uint8_t empty = 255; ///< voxel without material

    std::array<unsigned int, 3>           size{{0, 0, 0}};
    std::array<double, 3>                 voxel_size{{0, 0, 0}}; ///< [m]
    std::array<double, 3>                 corner{{0, 0, 0}};     ///< lower corner of the first voxel [m]
    dealii::ArrayView<const std::uint8_t> material;              ///< index into the scene's materials, x fastest

    /// The box of voxels that hold material, [first, past): the specimen. All of them if none does.
    std::array<unsigned int, 3> first{{0, 0, 0}}, past{{0, 0, 0}};

    Image::Frame  frame;        ///< these voxels in the coordinates of the file's header
    std::string   file;         ///< as found, or "phantom"
    std::string   remarks;      ///< how the file was understood, for people
    std::uint32_t checksum = 0; ///< CRC-32 of size, voxel size, corner and material
    /// Voxels merged into one along x, y, z, and how many voxels each material had before, by index; at `empty` those
    /// without one.
    std::array<unsigned int, 3> merged{{1, 1, 1}};
    std::vector<double>         n_before_merging;

    std::uint8_t
    at(const unsigned int x, const unsigned int y, const unsigned int z) const
    {
      return material[(std::size_t(z) * size[1] + y) * size[0] + x];
    }

    /**
     * Declares and reads the entries of a body with 'Shape = image' in the current section, and on rank 0 its image.
     * Collective.
     *
     * @param materials names of the scene's materials
     * @param dim space dimension; a plane scene takes one slice
     * Throws UserError on all ranks.
     */
    void add(Parameters &p, const std::vector<std::string> &materials, unsigned int dim, MPI_Comm comm);

  private:
    void find_specimen();

    std::shared_ptr<const std::uint8_t> memory; ///< of the materials
  };
} // namespace Stroma
