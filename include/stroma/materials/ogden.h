#pragma once

#include <stroma/materials/elastic_constants.h>
#include <stroma/materials/material.h>

#include <vector>

namespace Stroma
{
  class Parameters;
}

namespace Stroma::Materials
{
  /**
   * Ogden's law (Ogden, Proc. R. Soc. Lond. A 326 (1972) 565) of nearly incompressible rubber and tissue, in the principal
   * stretches lambda_a with their isochoric parts l_a = J^(-1/3) lambda_a:
   *   W = sum_p mu_p/alpha_p (l_1^alpha_p + l_2^alpha_p + l_3^alpha_p - 3) + kappa/2 (ln J)^2,
   * with shear modulus mu = 1/2 sum_p mu_p alpha_p at rest. One term of alpha = 2 is the neo-Hookean law of mu = mu_1.
   * Principal Kirchhoff stresses: tau_a = sum_p mu_p (l_a^alpha_p - 1/3 sum_b l_b^alpha_p) + kappa ln J.
   */
  class Ogden : public Material
  {
  public:
    struct Term
    {
      double mu;    ///< [Pa]
      double alpha; ///< mu alpha > 0
    };

    Ogden(std::vector<Term> terms, double kappa);

    /// Declares and reads the entries of the current section. Throws UserError.
    static std::unique_ptr<Material> read(Parameters &p);

    StepStatus evaluate(const MaterialInput &input, const MaterialOutput &output) const override;
    double     p_wave_modulus() const override;
    std::string
    name() const override
    {
      return "Ogden";
    }
    std::string meaning() const override;

  private:
    class Point;

    std::vector<Term> terms;
    double            kappa; ///< [Pa]
  };
} // namespace Stroma::Materials
