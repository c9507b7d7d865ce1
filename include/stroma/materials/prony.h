#pragma once

#include <stroma/materials/elastic_constants.h>
#include <stroma/materials/pointwise.h>

#include <vector>

namespace Stroma
{
  class Parameters;
}

namespace Stroma::Materials
{
  /// Relaxation of a linear viscoelastic solid: G(t) = G_0 (1 - sum_i g_i (1 - exp(-t/tau_i))), and K(t) from K_0 and
  /// k_i likewise.
  struct PronySeries
  {
    ElasticConstants    relaxed;     ///< G and K after a long time: G_0 (1 - sum g_i), K_0 (1 - sum k_i)
    std::vector<double> times;       ///< tau_i [s], > 0
    std::vector<double> shear_parts; ///< g_i >= 0 of G_0, together less than 1
    std::vector<double> bulk_parts;  ///< k_i >= 0 of K_0, together less than 1

    /// The two terms that stand for a Kelvin-Voigt solid of shear viscosity @p viscosity [Pa s] and bulk viscosity 5/3
    /// of it, Heck et al. 2017, eqs. (62)-(69).
    /// @param delta relaxed over instantaneous moduli, in (0, 1/2)
    static PronySeries kelvin_voigt(const ElasticConstants &relaxed, double viscosity, double delta);

    /// Declares and reads the entries of the current section: the elastic constants, and the terms either one by one
    /// or as those of a Kelvin-Voigt solid. Throws UserError.
    void add(Parameters &p);
  };

  /**
   * Linear viscoelasticity with a Prony series, S(t) = int 2 G(t-s) dev E'(s) + 3 K(t-s) vol E'(s) ds between the
   * second Piola-Kirchhoff stress and the Green-Lagrange strain E = (F^T F - I)/2, vol E = tr E/3 I; tau = F S F^T.
   * Each term keeps its stress h_i, h_i' = C_i : E' - h_i/tau_i with C_i = 2 G_0 g_i dev + 3 K_0 k_i vol, and takes a
   * step as h_i <- exp(-x) h_i + (1 - exp(-x))/x C_i : dE, x = dt/tau_i (Taylor, Pister & Goudreau 1970; Simo & Hughes
   * 1998, section 10.3): of order 2, and exact where E is linear in time within the step. dt = 0 is an instantaneous
   * response. psi is the energy of all springs; what the dashpots took is gone.
   *
   * History of a point: E at the start of the step, then h_i [Pa], six numbers each in the order of SymmetricTensor.
   */
  class Prony : public Material
  {
  public:
    /// @param strain finite: between S and E, tau = F S F^T; small: between tau and eps = sym F - I
    explicit Prony(const PronySeries &series, Strain strain = Strain::finite);

    StepStatus evaluate(const MaterialInput &input, const MaterialOutput &output) const override;
    unsigned int
    n_history() const override
    {
      return 6 * (1 + terms.size());
    }
    std::unique_ptr<Material> small_strain() const override;
    /// K_0 + 4/3 G_0, of waves that leave no time to relax.
    double p_wave_modulus() const override;
    std::string
    name() const override
    {
      return "Prony";
    }
    std::string
    meaning() const override
    {
      return std::string("stress relaxes from Hooke's law by a Prony series of ") +
             (strain == Strain::small ? "sigma and eps" : "S and the Green-Lagrange strain E");
    }

  private:
    struct Term
    {
      double           time;   ///< tau_i [s]
      ElasticConstants moduli; ///< G_0 g_i, K_0 k_i [Pa]
    };
    class Point;

    ElasticConstants  relaxed;
    std::vector<Term> terms;
    Strain            strain;
  };
} // namespace Stroma::Materials
