#pragma once

#include <stroma/base/expression.h>
#include <stroma/scene/voxel_materials.h>

#include <deal.II/base/bounding_box.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace Stroma
{
  /// A piece of material, or a rigid body: a volume image, or a drawn shape of one material. Supports and loads on 'body
  /// NAME' move and turn a rigid body, and it is at rest if there are none: Rigid::Body.
  template <int dim>
  class Body
  {
  public:
    enum class Shape
    {
      image,
      box,
      ball,
      ring,         ///< sector of a ring about the origin of angles, 2D
      quadrilateral ///< 2D
    };

    /// Declares and reads the body's section; reads its image on rank 0 and broadcasts it. Collective.
    void add(Parameters &p, const std::string &name, const std::vector<std::string> &materials, MPI_Comm comm);

    /// Whether the body, rigid or not, takes up @p X.
    bool contains(const dealii::Point<dim> &X) const;

    /// Material at @p X, if the body has any there.
    std::optional<unsigned int> material_at(const dealii::Point<dim> &X) const;

    /// Box of the body; of an image, of its voxels that hold material: empty ones round the specimen do not count.
    dealii::BoundingBox<dim> bounding_box() const;

    std::string                       name, where;
    Shape                             shape = Shape::box;
    bool                              rigid = false;
    std::optional<dealii::Point<dim>> pivot;              ///< of a rigid body, if given [m]
    dealii::Point<dim>                first, second;      ///< box: corners; ball, ring: centre [m]
    double                            radius       = 0;   ///< ball, ring: outer radius [m]
    double                            inner_radius = 0;   ///< ring [m]
    std::array<double, 2>             angles{{0., 360.}}; ///< ring: from, to, anticlockwise from x [degrees]
    std::array<dealii::Point<dim>, 4> corners;            ///< quadrilateral, anticlockwise [m]
    SpaceTimeVector<dim>              initial_velocity;   ///< [m/s], only for motion with inertia
    unsigned int                      material = 0;       ///< of a drawn shape
    VoxelMaterials                    voxels;             ///< of an image

  private:
    void                        add_drawn(Parameters &p);
    std::optional<unsigned int> voxel_material(const dealii::Point<dim> &X) const;
  };
} // namespace Stroma
