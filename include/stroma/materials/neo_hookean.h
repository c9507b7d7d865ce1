#pragma once

#include <stroma/materials/elastic_constants.h>
#include <stroma/materials/material.h>

namespace Stroma::Materials
{
  /**
   * Uncoupled neo-Hookean law, Guilkey et al. 2006 eq (12) (after Simo & Hughes 1998):
   * W = kappa/2 (ln J)^2 + mu/2 (tr bbar - 3), bbar = J^(-2/3) F F^T, hence
   * tau = mu dev bbar + kappa ln J I.
   */
  class NeoHookean : public Material
  {
  public:
    explicit NeoHookean(const ElasticConstants &constants);

    StepStatus  evaluate(const MaterialInput &input, const MaterialOutput &output) const override;
    double      p_wave_modulus() const override;
    std::string name() const override;
    std::string meaning() const override;

  private:
    ElasticConstants constants;
  };
} // namespace Stroma::Materials
