#pragma once

#include <stroma/materials/elastic_constants.h>
#include <stroma/materials/material.h>

namespace Stroma::Materials
{
  /**
   * Hooke's law S = lambda tr E I + 2 mu E between the second Piola-Kirchhoff stress and the Green-Lagrange strain
   * E = (F^T F - I)/2 (St. Venant-Kirchhoff): W = lambda/2 (tr E)^2 + mu E:E. This is what finite-strain programs
   * call linear (isotropic) elastic. It equals small-strain elasticity to first order in the displacement gradient
   * and, unlike that law, does not strain under rotation. In spatial form, with e = (b - I)/2, b = F F^T:
   * tau = lambda tr e b + 2 mu b e, Jc_ijkl = lambda b_ij b_kl + mu (b_ik b_jl + b_il b_jk).
   * For small strains: it softens under strong compression (from F_11 = .58 in uniaxial strain) and then collapses.
   */
  class LinearElastic : public Material
  {
  public:
    explicit LinearElastic(const ElasticConstants &constants);

    StepStatus  evaluate(const MaterialInput &input, const MaterialOutput &output) const override;
    double      p_wave_modulus() const override;
    std::string name() const override;
    std::string meaning() const override;

  private:
    ElasticConstants constants;
  };
} // namespace Stroma::Materials
