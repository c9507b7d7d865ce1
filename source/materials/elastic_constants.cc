#include <stroma/base/parameters.h>

#include <stroma/materials/elastic_constants.h>

#include <array>
#include <cmath>
#include <string>

namespace Stroma::Materials
{
  namespace
  {
    constexpr double not_given = std::numeric_limits<double>::quiet_NaN();

    struct Modulus
    {
      std::string name, meaning, unit;
      Range       range;
      double      value = not_given;
    };

    enum Index
    {
      young,
      poisson,
      shear,
      bulk
    };

    using Moduli = std::array<Modulus, 4>;

    Moduli
    all_moduli()
    {
      const std::string two = "; give exactly two of the four elastic constants";
      return {{{"Young's modulus", "stiffness in uniaxial stress, E" + two, "Pa", Range::positive()},
               {"Poisson's ratio", "lateral contraction in uniaxial stress, nu" + two, "", Range::open(-1., .5)},
               {"Shear modulus", "stiffness against change of shape, mu" + two, "Pa", Range::positive()},
               {"Bulk modulus", "stiffness against change of volume, kappa" + two, "Pa", Range::positive()}}};
    }

    /// Names of the moduli that the section gives, separated by commas.
    std::string
    names_given(const Parameters &p, const Moduli &moduli)
    {
      std::string names;
      for (const auto &modulus : moduli)
        if (p.given(modulus.name))
          names += (names.empty() ? "" : ", ") + modulus.name;
      return names.empty() ? "none" : names;
    }

    /// mu and kappa [Pa] of one of the six pairs; the two that are not given are NaN.
    ElasticConstants
    convert(const double E, const double nu, const double mu, const double kappa)
    {
      const bool has_E = !std::isnan(E), has_nu = !std::isnan(nu), has_mu = !std::isnan(mu);
      if (has_E && has_nu)
        return {E / (2. * (1. + nu)), E / (3. * (1. - 2. * nu))};
      if (has_E && has_mu)
        return {mu, E * mu / (3. * (3. * mu - E))};
      if (has_E)
        return {3. * kappa * E / (9. * kappa - E), kappa};
      if (has_nu && has_mu)
        return {mu, 2. * mu * (1. + nu) / (3. * (1. - 2. * nu))};
      if (has_nu)
        return {3. * kappa * (1. - 2. * nu) / (2. * (1. + nu)), kappa};
      return {mu, kappa};
    }

    /// Young's modulus is bounded by the other modulus it is given with, or mu or kappa would not be positive.
    void
    check_young(const Parameters &p, const Moduli &moduli, const Index other, const double factor)
    {
      if (!(moduli[young].value >= factor * moduli[other].value))
        return;
      const std::string text = std::to_string(static_cast<int>(factor)) + " times '" + moduli[other].name + "'";
      throw UserError(p.where(moduli[young].name), "'" + moduli[young].name + "' and '" + moduli[other].name +
                                                     "' do not fit together: '" + moduli[young].name +
                                                     "' must be less than " + text + "; change one of them");
    }
  } // namespace

  void
  ElasticConstants::add(Parameters &p)
  {
    Moduli       moduli  = all_moduli();
    const bool   reading = p.get_mode() == Parameters::Mode::read;
    unsigned int n_given = 0;
    for (const auto &modulus : moduli)
      n_given += p.given(modulus.name);
    if (reading && n_given != 2)
      throw UserError(p.where_section(), "a material needs exactly two of: Young's modulus, Poisson's ratio, Shear "
                                         "modulus, Bulk modulus; given: " +
                                           names_given(p, moduli));
    for (auto &modulus : moduli)
      if (!reading || p.given(modulus.name))
        p.add(modulus.name, modulus.value, modulus.meaning, modulus.unit, modulus.range);
    check_young(p, moduli, shear, 3.);
    check_young(p, moduli, bulk, 9.);
    if (n_given == 2)
      *this = convert(moduli[young].value, moduli[poisson].value, moduli[shear].value, moduli[bulk].value);
  }
} // namespace Stroma::Materials
