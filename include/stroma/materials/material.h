#pragma once

#include <stroma/base/step_status.h>

#include <deal.II/base/array_view.h>
#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

#include <memory>
#include <string>

namespace Stroma
{
  class Parameters;
}

namespace Stroma::Materials
{
  /// What a law is given for a block of points. In 2D the third row and column of F are those of plane strain.
  struct MaterialInput
  {
    dealii::ArrayView<const dealii::Tensor<2, 3>> F;       ///< deformation gradient, one a point
    dealii::ArrayView<const double>               history; ///< n_history() numbers a point, at the start of the step
    double                                        dt = 0.; ///< length of the step [s]; only laws with history use it
  };

  /// What a law is asked for; an empty view is not wanted and costs nothing.
  struct MaterialOutput
  {
    dealii::ArrayView<dealii::SymmetricTensor<2, 3>> tau;     ///< Kirchhoff stress [Pa]
    dealii::ArrayView<dealii::SymmetricTensor<4, 3>> Jc;      ///< J times the spatial elasticity tensor [Pa]
    dealii::ArrayView<double>                        psi;     ///< strain energy per reference volume [J/m^3]
    dealii::ArrayView<double>                        F33;     ///< out-of-plane stretch (1 unless plane stress finds it)
    dealii::ArrayView<double>                        history; ///< n_history() numbers a point, at the end of the step
  };

  /// How a two-dimensional scene treats the third direction.
  enum class PlaneModel
  {
    strain, ///< F33 = 1
    stress  ///< F33 such that tau_33 = 0 at the point
  };

  /**
   * A constitutive law. One virtual call serves a block of points. A law is two files and a line in table.cc.
   */
  class Material
  {
  public:
    virtual ~Material() = default;

    /// Stress, tangent and energy of a block of points. Returns inverted_point if some det F <= 0, not_finite if a
    /// result is not finite, diverged if plane stress finds no F33; the outputs are then undefined. Local to the rank.
    /// The tangent is that of the Lie derivative: L_v tau = Jc : d; dP_iJ/dF_kL F_jJ F_lL = Jc_ijkl + delta_ik tau_jl.
    virtual StepStatus evaluate(const MaterialInput &input, const MaterialOutput &output) const = 0;

    /// Numbers that a point must remember from step to step; zero at the start.
    virtual unsigned int
    n_history() const
    {
      return 0;
    }

    /// The law of small strains that this law tends to, see SmallStrain: what an elastic law gives by default.
    virtual std::unique_ptr<Material> small_strain() const;

    /// Modulus of longitudinal waves at the reference state [Pa], the stiffness scale for penalties and step limits:
    /// kappa + 4/3 mu, or E/(1 - nu^2) in plane stress.
    virtual double p_wave_modulus() const = 0;

    /// Name of the law as written in the parameter file.
    virtual std::string name() const = 0;

    /// Its equations, in a line for people.
    virtual std::string meaning() const = 0;

    /// Whether Jc has the major symmetry of a law with an energy: the stiffness is symmetric then.
    virtual bool
    has_symmetric_tangent() const
    {
      return true;
    }

    /// Whether the stress is found from rates, step by step, and evaluate() gives that of small strains only: what the
    /// particle methods solve, and no other method at finite strains.
    virtual bool
    is_rate_form() const
    {
      return false;
    }
  };
} // namespace Stroma::Materials
