#pragma once

#include <stroma/materials/material.h>

namespace Stroma::Materials
{
  /**
   * A fluid at rest: a pressure and no shear stress, tau = K ln J I. K is infinite for an incompressible fluid, whose
   * pressure is an unknown of its own; evaluate() must not be called then. The viscosity is in the material's Medium.
   */
  class Fluid : public Material
  {
  public:
    explicit Fluid(double bulk_modulus);

    StepStatus evaluate(const MaterialInput &input, const MaterialOutput &output) const override;
    double
    p_wave_modulus() const override
    {
      return bulk_modulus;
    }
    std::string
    name() const override
    {
      return "fluid";
    }
    std::string
    meaning() const override
    {
      return "Newtonian fluid";
    }

  private:
    double bulk_modulus; ///< [Pa]
  };
} // namespace Stroma::Materials
