#include <stroma/materials/reference_tangent.h>
#include <stroma/materials/small_strain.h>

#include <cmath>

namespace Stroma::Materials
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  namespace
  {
    /// eps_33 over eps_11 + eps_22: -nu/(1 - nu) in plane stress, where C_1111 = E/(1 - nu^2), C_1122 = nu C_1111.
    double
    contraction(const SymmetricTensor<4, 3> &C)
    {
      return -C[0][0][1][1] / (C[0][0][0][0] - C[0][0][1][1]);
    }
  } // namespace

  std::unique_ptr<Material>
  Material::small_strain() const
  {
    Assert(n_history() == 0, dealii::ExcMessage("a law with history must bring its own small_strain()"));
    return std::make_unique<SmallStrain>(*this);
  }

  SmallStrain::SmallStrain(const Material &law)
    : C(reference_tangent(law))
    , modulus(law.p_wave_modulus())
    , plane_stress(C[2][2][2][2] == 0.)
    , F33_per_strain(plane_stress ? contraction(C) : 0.)
    , law_name(law.name())
  {}

  StepStatus
  SmallStrain::evaluate(const MaterialInput &input, const MaterialOutput &output) const
  {
    StepStatus status = StepStatus::ok;
    for (std::size_t p = 0; p < input.F.size(); ++p)
      {
        const auto   eps   = symmetrize(input.F[p]) - dealii::unit_symmetric_tensor<3>();
        const auto   sigma = C * eps;
        const double psi   = .5 * (eps * sigma);
        if (!std::isfinite(psi))
          {
            status = StepStatus::not_finite;
            continue;
          }
        if (output.tau.size() > 0)
          output.tau[p] = sigma;
        if (output.Jc.size() > 0)
          output.Jc[p] = C;
        if (output.psi.size() > 0)
          output.psi[p] = psi;
        if (output.F33.size() > 0)
          output.F33[p] = plane_stress ? 1. + F33_per_strain * (eps[0][0] + eps[1][1]) : input.F[p][2][2];
      }
    return status;
  }
} // namespace Stroma::Materials
