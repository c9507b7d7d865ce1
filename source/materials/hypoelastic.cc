#include <stroma/materials/hypoelastic.h>

#include <cmath>

namespace Stroma::Materials
{
  using dealii::SymmetricTensor;

  Hypoelastic::Hypoelastic(const ElasticConstants &constants)
    : constants(constants)
  {}

  StepStatus
  Hypoelastic::evaluate(const MaterialInput &input, const MaterialOutput &output) const
  {
    const auto                  I = dealii::unit_symmetric_tensor<3>();
    const SymmetricTensor<4, 3> C = constants.lambda() * outer_product(I, I) +
                                    2. * constants.mu * dealii::identity_tensor<3>();
    StepStatus status = StepStatus::ok;
    for (std::size_t p = 0; p < input.F.size(); ++p)
      {
        const SymmetricTensor<2, 3> eps   = symmetrize(input.F[p]) - I;
        const SymmetricTensor<2, 3> sigma = C * eps;
        if (!std::isfinite(eps * sigma))
          status = StepStatus::not_finite;
        if (output.tau.size() > 0)
          output.tau[p] = sigma;
        if (output.Jc.size() > 0)
          output.Jc[p] = C;
        if (output.psi.size() > 0)
          output.psi[p] = .5 * (eps * sigma);
        if (output.F33.size() > 0)
          output.F33[p] = input.F[p][2][2];
      }
    return status;
  }

  double
  Hypoelastic::p_wave_modulus() const
  {
    return constants.p_wave_modulus();
  }

  std::string
  Hypoelastic::name() const
  {
    return "hypoelastic";
  }

  std::string
  Hypoelastic::meaning() const
  {
    return "sigma = S - p I, Jaumann's rate of S is 2 mu dev D (with viscosity S comes to 2 mu dev ln V), p = kappa (1/J - 1)";
  }
} // namespace Stroma::Materials
