#include <stroma/base/parameters.h>

#include <stroma/materials/fluid.h>
#include <stroma/materials/hypoelastic.h>
#include <stroma/materials/linear_elastic.h>
#include <stroma/materials/neo_hookean.h>
#include <stroma/materials/ogden.h>
#include <stroma/materials/plane_stress.h>
#include <stroma/materials/prony.h>
#include <stroma/materials/table.h>

#include <cmath>
#include <limits>

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

    /// Bulk modulus of a fluid, infinite if it is not given.
    std::unique_ptr<Material>
    fluid(Parameters &p)
    {
      double bulk_modulus = std::nan("");
      if (p.given("Bulk modulus") || p.get_mode() == Parameters::Mode::document)
        p.add("Bulk modulus", bulk_modulus, "stiffness against change of volume, kappa; incompressible if not given",
              "Pa", Range::positive());
      return std::make_unique<Fluid>(std::isnan(bulk_modulus) ? std::numeric_limits<double>::infinity() : bulk_modulus);
    }

    std::unique_ptr<Material>
    prony(Parameters &p)
    {
      PronySeries series;
      series.add(p);
      return std::make_unique<Prony>(series);
    }

    /// The laws that a scene can choose; the first is the default.
    const std::vector<std::pair<std::string, Factory>> laws = {{"neo-Hookean", elastic<NeoHookean>},
                                                               {"linear elastic", elastic<LinearElastic>},
                                                               {"hypoelastic", elastic<Hypoelastic>},
                                                               {"fluid", fluid},
                                                               {"Prony", prony},
                                                               {"Ogden", Ogden::read}};
  } // namespace

  std::unique_ptr<Material>
  create(Parameters &p, const PlaneModel plane)
  {
    Factory factory = laws.front().second;
    p.add_choice(
      "Law", factory,
      "constitutive law. neo-Hookean: W = mu/2 (J^(-2/3) tr b - 3) + kappa/2 (ln J)^2; linear elastic: "
      "St. Venant-Kirchhoff, S = lambda tr E I + 2 mu E; hypoelastic (nsph, sph): Jaumann's rate of the "
      "deviatoric Cauchy stress is 2 mu dev D, which with viscosity comes to 2 mu dev ln V, pressure kappa (1/J - 1). With 'FEM/Kinematics = small' all "
      "three are Hooke's law of small strains",
      laws);
    auto law = factory(p);
    if (plane == PlaneModel::stress && factory == fluid)
      throw UserError(p.where("Law"), "a fluid has no plane stress; use 'Plane = strain'");
    if (plane == PlaneModel::stress && law->n_history() > 0)
      throw UserError(p.where("Law"),
                      "the law '" + law->name() + "' has a memory and no plane stress; use 'Plane = strain'");
    if (plane == PlaneModel::stress)
      return std::make_unique<PlaneStress>(std::move(law));
    return law;
  }
} // namespace Stroma::Materials
