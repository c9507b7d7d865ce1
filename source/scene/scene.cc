#include <stroma/materials/table.h>
#include <stroma/scene/scene.h>

namespace Stroma
{
  namespace
  {
    /// Names of the subsections here; an example name when documenting.
    std::vector<std::string>
    names_or_example(const Parameters &p, const std::string &example)
    {
      auto names = p.subsections();
      if (names.empty() && p.get_mode() == Parameters::Mode::document)
        names.push_back(example);
      return names;
    }
  } // namespace

  template <int dim>
  Scene<dim>::Scene(Parameters &p, const MPI_Comm comm)
    : comm(comm)
  {
    p.add("Title", title, "what the scene is, for people");
    if (dim == 2)
      {
        p.add("Thickness", thickness, "thickness of the plane scene; forces are for this thickness", "m",
              Range::positive());
        p.add_choice<Materials::PlaneModel>("Plane", plane, "third direction: plane strain, or plane stress at the point",
                                            {{"strain", Materials::PlaneModel::strain},
                                             {"stress", Materials::PlaneModel::stress}});
      }
    {
      const auto section = p.section("Materials", "one subsection a material, named as you like");
      material_names     = names_or_example(p, "tissue");
      if (material_names.empty())
        throw UserError(p.where_section(), "no material; add a subsection with a 'Law' to section Materials");
      if (material_names.size() >= VoxelMaterials::empty)
        throw UserError(p.where_section(), "at most 254 materials");
      for (const auto &name : material_names)
        {
          const auto subsection = p.section(name);
          materials.push_back(Materials::create(p, plane));
        }
    }
    {
      const auto section = p.section("Bodies", "one subsection a body; where bodies overlap the later one wins");
      const auto names   = names_or_example(p, "specimen");
      if (names.empty())
        throw UserError(p.where_section(), "no body; add a subsection with a 'Shape' to section Bodies");
      for (const auto &name : names)
        {
          const auto subsection = p.section(name);
          bodies.emplace_back();
          bodies.back().add(p, name, material_names, comm);
        }
    }
    {
      const auto section = p.section("Supports", "one subsection a support: prescribed displacements");
      for (const auto &name : names_or_example(p, "bottom"))
        {
          const auto subsection = p.section(name);
          supports.emplace_back();
          supports.back().name = name;
          supports.back().add(p, material_names);
        }
    }
    {
      const auto section = p.section("Loads", "one subsection a load: dead forces on material");
      for (const auto &name : names_or_example(p, "weight"))
        {
          const auto subsection = p.section(name);
          loads.emplace_back();
          loads.back().name = name;
          loads.back().add(p, material_names);
        }
    }
    {
      const auto section = p.section("Exact solution", "known solution, for error norms");
      exact_displacement.add(p, "Displacement", "displacement of the point that was at x, y, z", "m", false);
    }
  }

  template <int dim>
  dealii::BoundingBox<dim>
  Scene<dim>::bounding_box() const
  {
    auto box = bodies.front().bounding_box();
    for (const auto &body : bodies)
      box.merge_with(body.bounding_box());
    return box;
  }

  template <int dim>
  bool
  Scene<dim>::covered_by_later_body(const unsigned int b, const dealii::Point<dim> &X) const
  {
    for (unsigned int later = b + 1; later < bodies.size(); ++later)
      if (bodies[later].material_at(X))
        return true;
    return false;
  }

  template class Scene<2>;
  template class Scene<3>;
} // namespace Stroma
