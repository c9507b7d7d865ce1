#pragma once

#include <stroma/base/expression.h>
#include <stroma/rigid/resistance.h>
#include <stroma/scene/voxel_materials.h>
#include <stroma/shapes/shape.h>

#include <deal.II/base/bounding_box.h>

#include <memory>
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
    /// Declares and reads the body's section; reads its image on rank 0 and broadcasts it. Collective.
    void add(Parameters &p, const std::string &name, const std::vector<std::string> &materials, MPI_Comm comm);

    /// Whether the body, rigid or not, takes up @p X.
    bool contains(const dealii::Point<dim> &X) const;

    /// Material at @p X, if the body has any there.
    std::optional<unsigned int> material_at(const dealii::Point<dim> &X) const;

    /// Box of the body; of an image, of its voxels that hold material: empty ones round the specimen do not count.
    dealii::BoundingBox<dim> bounding_box() const;

    bool
    is_image() const
    {
      return !shape;
    }

    /// Whether it is drawn along the axes: its edges are then those of its bounding box.
    bool is_box() const;

    /// Whether it is triangles, or a polyline, from a file.
    bool is_surface() const;

    std::string                               name, where;
    bool                                      rigid = false;
    std::optional<dealii::Point<dim>>         pivot;            ///< of a rigid body, if given [m]
    Rigid::Resistance                         resistance;       ///< of a rigid body
    std::shared_ptr<const Shapes::Shape<dim>> shape;            ///< of a drawn body
    SpaceTimeVector<dim>                      initial_velocity; ///< [m/s], only for motion with inertia
    unsigned int                              material = 0;     ///< of a drawn body
    VoxelMaterials                            voxels;           ///< of an image

  private:
    void                        add_resistance(Parameters &p);
    std::optional<unsigned int> voxel_material(const dealii::Point<dim> &X) const;
  };
} // namespace Stroma
