#include <stroma/materials/reference_tangent.h>
#include <stroma/sph/constitution.h>

#include <cmath>

namespace Stroma::Sph
{
  double
  Constitution::pressure(const double J) const
  {
    return xi == 1. ? K * (1. / J - 1.) : K / xi * (std::pow(J, -xi) - 1.);
  }

  double
  Constitution::bulk_tangent(const double J) const
  {
    return K * std::pow(J, -xi);
  }

  namespace
  {
    /// Moduli of a solid law at the undeformed state.
    void
    set_moduli(Constitution &constants, const Materials::Material &law)
    {
      const auto C = Materials::reference_tangent(law);
      constants.G  = C[0][1][0][1];
      constants.K  = C[0][0][0][0] - 4. / 3. * constants.G;
    }

    template <int dim>
    void
    check(const Scene<dim> &scene, const unsigned int m, const std::string &method, const bool may_be_inviscid)
    {
      const auto       &medium = scene.media[m];
      const std::string where  = scene.of_material(m);
      if (medium.is_fluid && !std::isfinite(medium.bulk_modulus))
        throw UserError(where,
                        "'Method = " + method +
                          "' needs a 'Bulk modulus' of the fluid: particles are nearly, not fully, incompressible");
      if (!medium.is_viscous() && !may_be_inviscid)
        throw UserError(
          where, "'Viscosity' is missing or 0, but without inertia friction is all that determines the velocity");
      if (medium.is_viscous() && medium.viscous_operator == Materials::ViscousOperator::deviatoric)
        throw UserError(where,
                        "'Viscous operator = deviatoric' has no pairwise form; particles take 'central' or 'morris'");
      if (medium.viscous_operator != scene.media.front().viscous_operator)
        throw UserError(where, "particles take one 'Viscous operator' for all materials; '" +
                                 scene.material_names.front() + "' has another one");
    }
  } // namespace

  template <int dim>
  std::vector<Constitution>
  constitutions_of(const Scene<dim> &scene, const std::string &method, const bool published, const bool may_be_inviscid)
  {
    if (scene.plane == Materials::PlaneModel::stress)
      throw UserError("'Plane'", "'Method = " + method + "' solves plane strain; 'Plane = stress' is for mpm and fem");
    std::vector<Constitution> all;
    for (unsigned int m = 0; m < scene.materials.size(); ++m)
      {
        check(scene, m, method, may_be_inviscid);
        const auto  &medium = scene.media[m];
        Constitution constants;
        constants.mu  = medium.viscosity;
        constants.rho = medium.density > 0. ? medium.density : 0.;
        if (medium.is_fluid)
          {
            constants.xi = 7.;
            constants.K  = medium.bulk_modulus * (published ? constants.xi : 1.);
          }
        else
          set_moduli(constants, *scene.materials[m]);
        all.push_back(constants);
      }
    return all;
  }

  template std::vector<Constitution> constitutions_of(const Scene<2> &, const std::string &, bool, bool);
  template std::vector<Constitution> constitutions_of(const Scene<3> &, const std::string &, bool, bool);
} // namespace Stroma::Sph
