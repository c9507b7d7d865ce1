#include <stroma/base/text.h>
#include <stroma/scene/scene.h>
#include <stroma/studies/scene_geometry.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Studies
{
  namespace
  {
    std::string
    corner(const Place &X, const unsigned int dimension)
    {
      std::vector<std::string> parts;
      for (unsigned int d = 0; d < dimension; ++d)
        parts.push_back(brief(X[d]));
      return "(" + join(parts, ", ") + ")";
    }

    template <int dim>
    class Geometry : public SceneGeometry
    {
    public:
      explicit Geometry(const Scene<dim> &scene)
        : scene(scene)
        , box(scene.bounding_box())
      {
        frame.title     = scene.title;
        frame.dimension = dim;
        frame.materials = scene.material_names;
        if (dim == 2)
          frame.thickness = scene.thickness;
        for (unsigned int d = 0; d < dim; ++d)
          {
            frame.lower[d] = box.lower_bound(d);
            frame.upper[d] = box.upper_bound(d);
          }
      }

      std::optional<unsigned int>
      material_at(const Place &X) const override
      {
        return scene.material_at(Output::point_of<dim>(X));
      }

      Region
      region(const std::string &text) const override
      {
        using Kind = typename Stroma::Region<dim>::Kind;
        Stroma::Region<dim> region;
        const auto          file = ParameterFile::parse("set Where = " + text, "--region");
        try
          {
            Parameters p(file);
            region.add(p, {scene.material_names, scene.body_names});
          }
        catch (const UserError &error)
          {
            const std::string message = error.what();
            throw UserError("--region", message.substr(message.find("'Where'")));
          }
        if (region.is_boundary() || region.kind == Kind::nearest || region.kind == Kind::body)
          throw UserError("--region", "'" + text + "' holds no material; give a layer, box, ball, material or all");
        return [this, region](const Place &X, const unsigned int material) {
          return region.contains(Output::point_of<dim>(X), material, box);
        };
      }

    private:
      const Scene<dim>        &scene;
      dealii::BoundingBox<dim> box;
    };
  } // namespace

  std::string
  SceneFrame::difference_from(const SceneFrame &other) const
  {
    if (dimension != other.dimension)
      return "has dimension " + std::to_string(dimension) + " instead of " + std::to_string(other.dimension);
    if (materials != other.materials)
      return "has the materials " + join(materials, ", ") + " instead of " + join(other.materials, ", ");
    double size = 0., apart = 0.;
    for (unsigned int d = 0; d < dimension; ++d)
      {
        size  = std::max(size, upper[d] - lower[d]);
        apart = std::max({apart, std::abs(upper[d] - other.upper[d]), std::abs(lower[d] - other.lower[d])});
      }
    if (apart > 1e-6 * size)
      return "has bodies from " + corner(lower, dimension) + " to " + corner(upper, dimension) + " m instead of " +
             corner(other.lower, dimension) + " to " + corner(other.upper, dimension) + " m";
    return "";
  }

  std::unique_ptr<SceneGeometry>
  SceneGeometry::of(const SavedRun &run)
  {
    if (run.dimension() == 2)
      return std::make_unique<Geometry<2>>(run.scene<2>());
    return std::make_unique<Geometry<3>>(run.scene<3>());
  }
} // namespace Stroma::Studies
