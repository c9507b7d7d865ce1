#pragma once

#include <stroma/materials/material.h>

namespace Stroma::Materials
{
  /**
   * The small-strain limit of an isotropic elastic law: sigma = C : eps with eps = sym F - I and C the law's tangent
   * at F = I (condensed, in plane stress). To be used with gradients at undeformed places and no geometric stiffness;
   * tau is then the Cauchy stress, and psi the energy eps : C : eps / 2. It does not mind det F <= 0.
   */
  class SmallStrain : public Material
  {
  public:
    /// @param law isotropic, elastic, without history; its stress at F = I must be zero
    explicit SmallStrain(const Material &law);

    StepStatus evaluate(const MaterialInput &input, const MaterialOutput &output) const override;
    double
    p_wave_modulus() const override
    {
      return modulus;
    }
    std::string
    name() const override
    {
      return law_name;
    }
    std::string
    meaning() const override
    {
      return "Hooke's law of small strains, sigma = lambda tr eps I + 2 mu eps";
    }
    std::unique_ptr<Material>
    small_strain() const override
    {
      return std::make_unique<SmallStrain>(*this);
    }

  private:
    dealii::SymmetricTensor<4, 3> C;       ///< [Pa]
    double                        modulus; ///< [Pa]
    bool                          plane_stress;
    double                        F33_per_strain; ///< out-of-plane strain over the in-plane trace, in plane stress
    std::string                   law_name;
  };
} // namespace Stroma::Materials
