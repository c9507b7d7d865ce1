#pragma once

#include <stroma/materials/material.h>

#include <memory>

namespace Stroma::Materials
{
  /**
   * Turns any law into plane stress: takes F_11, F_12, F_21, F_22 of a point (the rest of F is ignored and taken as
   * zero), finds F33 > 0 with tau_33 = 0 and condenses the tangent,
   * Jc_ijkl - Jc_ij33 Jc_33kl / Jc_3333, i, j, k, l in the plane. It is the push-forward of the condensed material
   * tangent, in which F33 cancels, and needs no further terms since tau_33 = 0. Entries of tau and Jc with an index 3
   * are zero. The law must be symmetric about the plane (no in-plane deformation gives tau_13 or tau_23).
   *
   * evaluate() also returns diverged if no F33 with a stable response (Jc_3333 > 0) is found.
   */
  class PlaneStress : public Material
  {
  public:
    explicit PlaneStress(std::unique_ptr<const Material> law);

    StepStatus evaluate(const MaterialInput &input, const MaterialOutput &output) const override;

    /// E/(1 - nu^2) of the law at the reference state [Pa]: the modulus of longitudinal waves in the plane.
    double p_wave_modulus() const override;

    /// Name and meaning of the law.
    std::string name() const override;
    std::string meaning() const override;
    bool        is_rate_form() const override;
    bool
    has_symmetric_tangent() const override
    {
      return law->has_symmetric_tangent();
    }

  private:
    std::unique_ptr<const Material> law;
    double                          modulus;     // E/(1 - nu^2)
    double                          contraction; // -d ln F33 / d ln(in-plane area) at the reference state
  };
} // namespace Stroma::Materials
