#pragma once

#include <stroma/base/parameters.h>

#include <deal.II/base/bounding_box.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace Stroma
{
  /// Voxels with a material each, the same on all ranks.
  struct VoxelMaterials
  {
    static constexpr std::uint8_t empty = 255; ///< voxel without material

    std::array<unsigned int, 3> size{{0, 0, 0}};
    std::array<double, 3>       voxel_size{{0, 0, 0}}; ///< [m]
    std::array<double, 3>       corner{{0, 0, 0}};     ///< lower corner of the first voxel [m]
    std::vector<std::uint8_t>   material;              ///< index into the scene's materials, x fastest

    std::uint8_t at(const unsigned int x, const unsigned int y, const unsigned int z) const
    {
      return material[(std::size_t(z) * size[1] + y) * size[0] + x];
    }
  };

  /// A piece of material: a volume image, or a drawn shape of one material.
  template <int dim>
  class Body
  {
  public:
    enum class Shape
    {
      image,
      box,
      ball
    };

    /// Declares and reads the body's section; reads its image on rank 0 and broadcasts it. Collective.
    void add(Parameters &p, const std::string &name, const std::vector<std::string> &materials, MPI_Comm comm);

    /// Material at @p X, if the body has any there.
    std::optional<unsigned int> material_at(const dealii::Point<dim> &X) const;

    dealii::BoundingBox<dim> bounding_box() const;

    std::string        name, where;
    Shape              shape = Shape::box;
    dealii::Point<dim> first, second; ///< box: corners; ball: centre [m]
    double             radius = 0;    ///< ball [m]
    unsigned int       material = 0;  ///< of a drawn shape
    VoxelMaterials     voxels;        ///< of an image
    std::string        image_source;  ///< file name or "phantom"
  };
} // namespace Stroma
