#include <stroma/base/parameters.h>

#include <stroma/materials/linear_elastic.h>
#include <stroma/materials/neo_hookean.h>
#include <stroma/materials/plane_stress.h>
#include <stroma/materials/table.h>

namespace Stroma::Materials
{
  namespace
  {
    using Factory = std::unique_ptr<Material> (*)(Parameters &);

    /// A law with nothing but elastic constants.
    template <typename Law>
    std::unique_ptr<Material>
    elastic(Parameters &p)
    {
      ElasticConstants constants;
      constants.add(p);
      return std::make_unique<Law>(constants);
    }

    /// The laws that a scene can choose; the first is the default.
    const std::vector<std::pair<std::string, Factory>> laws
        = { { "neo-Hookean", elastic<NeoHookean> }, { "linear elastic", elastic<LinearElastic> } };
  } // namespace

  std::unique_ptr<Material>
  create(Parameters &p, const PlaneModel plane)
  {
    Factory factory = laws.front().second;
    p.add_choice("Law", factory, "constitutive law", laws);
    auto law = factory(p);
    if (plane == PlaneModel::stress)
      return std::make_unique<PlaneStress>(std::move(law));
    return law;
  }
} // namespace Stroma::Materials
