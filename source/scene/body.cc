#include <stroma/scene/body.h>
#include <stroma/shapes/box.h>
#include <stroma/shapes/faceted.h>
#include <stroma/shapes/table.h>

#include <algorithm>

namespace Stroma
{
  template <int dim>
  void
  Body<dim>::add(Parameters &p, const std::string &body_name, const std::vector<std::string> &materials,
                 const MPI_Comm comm)
  {
    name                     = body_name;
    where                    = p.where_section();
    auto              shapes = Shapes::table<dim>();
    Shapes::Read<dim> read   = shapes.front().second;
    shapes.insert(shapes.begin(), {"image", nullptr});
    p.add_choice("Shape", read, "a volume image, or a drawn shape", shapes);
    if (!read)
      {
        voxels.add(p, materials, dim, comm);
        return;
      }
    shape = read(p, comm);
    p.add("Rigid", rigid, "a rigid body instead of a piece of material");
    if (p.get_mode() == Parameters::Mode::document || (rigid && p.given("Pivot")))
      pivot = Shapes::read_point<dim>(p, "Pivot", "about which a rigid body turns, its centroid if not given", 0.);
    if (rigid || p.get_mode() == Parameters::Mode::document)
      add_resistance(p);
    if (p.given("Initial velocity") || p.get_mode() == Parameters::Mode::document)
      initial_velocity.add(p, "Initial velocity",
                           "velocity at the start, for motion with inertia; of a rigid body, of its pivot", "m/s",
                           false);
    if (rigid)
      return;
    std::vector<std::pair<std::string, unsigned int>> choices;
    for (unsigned int m = 0; m < materials.size(); ++m)
      choices.emplace_back(materials[m], m);
    p.add_choice<unsigned int>("Material", material, "what it is made of", choices);
  }

  template <int dim>
  void
  Body<dim>::add_resistance(Parameters &p)
  {
    p.add("Density", resistance.density, "of a rigid body that forces move with inertia: mass over volume", "kg/m^3",
          Range::non_negative());
    p.add("Mass", resistance.mass, "of a rigid body, instead of its density; in 2D for the scene's thickness", "kg",
          Range::non_negative());
    if (resistance.density > 0. && resistance.mass > 0.)
      throw UserError(p.where("Mass"), "a rigid body has either a 'Density' or a 'Mass'; remove one of them");
    p.add("Drag", resistance.drag,
          "c of the force -c v against the motion of a rigid body that forces move, spread evenly over its shape",
          "N*s/m", Range::non_negative());
    p.add("Largest approach", resistance.largest_approach,
          "way in a step of a rigid body that forces move without inertia while it touches nothing; 0: not given", "m",
          Range::non_negative());
  }

  template <int dim>
  bool
  Body<dim>::is_box() const
  {
    return dynamic_cast<const Shapes::Box<dim> *>(shape.get()) != nullptr;
  }

  template <int dim>
  bool
  Body<dim>::is_surface() const
  {
    const auto *const faceted = dynamic_cast<const Shapes::Faceted<dim> *>(shape.get());
    return faceted && faceted->is_of_file;
  }

  template <int dim>
  dealii::BoundingBox<dim>
  Body<dim>::bounding_box() const
  {
    if (shape)
      return shape->bounding_box();
    dealii::Point<dim> lower, upper;
    for (unsigned int d = 0; d < dim; ++d)
      {
        lower[d] = voxels.corner[d] + voxels.first[d] * voxels.voxel_size[d];
        upper[d] = voxels.corner[d] + voxels.past[d] * voxels.voxel_size[d];
      }
    return dealii::BoundingBox<dim>({lower, upper});
  }

  template <int dim>
  std::optional<unsigned int>
  Body<dim>::voxel_material(const dealii::Point<dim> &X) const
  {
    std::array<unsigned int, 3> index{{0, 0, 0}};
    for (unsigned int d = 0; d < dim; ++d)
      index[d] = std::clamp(static_cast<unsigned int>(std::max(0., (X[d] - voxels.corner[d]) / voxels.voxel_size[d])),
                            voxels.first[d], voxels.past[d] - 1);
    const auto found = voxels.at(index[0], index[1], index[2]);
    return found == VoxelMaterials::empty ? std::nullopt : std::optional<unsigned int>(found);
  }

  template <int dim>
  bool
  Body<dim>::contains(const dealii::Point<dim> &X) const
  {
    return shape ? shape->contains(X) : bounding_box().point_inside(X) && voxel_material(X);
  }

  template <int dim>
  std::optional<unsigned int>
  Body<dim>::material_at(const dealii::Point<dim> &X) const
  {
    if (rigid || !contains(X))
      return std::nullopt;
    return is_image() ? voxel_material(X) : std::optional<unsigned int>(material);
  }

  template class Body<2>;
  template class Body<3>;
} // namespace Stroma
