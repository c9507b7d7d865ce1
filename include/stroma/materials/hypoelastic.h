#pragma once

#include <stroma/materials/elastic_constants.h>
#include <stroma/materials/material.h>

namespace Stroma::Materials
{
  /**
   * Hooke's law in rates, which the particle methods integrate in time: with the Cauchy stress sigma = S - p I, rate of
   * deformation D, spin W and J = rho_0/rho,
   *   dS/dt = 2 mu dev D + W S - S W (Jaumann's rate; Heck et al. 2017, (26)),   p = kappa (1/J - 1) (linear in density).
   * S is no function of F and has no energy; of viscous solids it comes to 2 mu dev ln V (Sph::System). At small strains this is Hooke's law, which evaluate() gives:
   * sigma = kappa tr eps I + 2 mu dev eps, eps = sym F - I.
   * A stretch lambda with the sides held has sigma = kappa (1 - 1/lambda) + 4/3 mu ln lambda.
   */
  class Hypoelastic : public Material
  {
  public:
    explicit Hypoelastic(const ElasticConstants &constants);

    /// Of small strains; see is_rate_form().
    StepStatus evaluate(const MaterialInput &input, const MaterialOutput &output) const override;
    bool
    is_rate_form() const override
    {
      return true;
    }
    double      p_wave_modulus() const override;
    std::string name() const override;
    std::string meaning() const override;

  private:
    ElasticConstants constants;
  };
} // namespace Stroma::Materials
