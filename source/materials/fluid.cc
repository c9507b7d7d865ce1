#include <stroma/materials/fluid.h>

#include <deal.II/base/exceptions.h>

#include <cmath>

namespace Stroma::Materials
{
  Fluid::Fluid(const double bulk_modulus)
    : bulk_modulus(bulk_modulus)
  {}

  StepStatus
  Fluid::evaluate(const MaterialInput &input, const MaterialOutput &output) const
  {
    Assert(std::isfinite(bulk_modulus), dealii::ExcMessage("an incompressible fluid has no pressure of its own"));
    const auto I      = dealii::unit_symmetric_tensor<3>();
    StepStatus status = StepStatus::ok;
    for (std::size_t p = 0; p < input.F.size(); ++p)
      {
        const double J = determinant(input.F[p]);
        if (!(J > 0.) || !std::isfinite(J))
          {
            status = worse(status, J <= 0. ? StepStatus::inverted_point : StepStatus::not_finite);
            continue;
          }
        const double pressure = -bulk_modulus * std::log(J); // J times the Cauchy pressure
        if (output.tau.size() > 0)
          output.tau[p] = -pressure * I;
        if (output.Jc.size() > 0)
          output.Jc[p] = bulk_modulus * outer_product(I, I) + 2. * pressure * dealii::identity_tensor<3>();
        if (output.psi.size() > 0)
          output.psi[p] = .5 * bulk_modulus * std::log(J) * std::log(J);
        if (output.F33.size() > 0)
          output.F33[p] = input.F[p][2][2];
      }
    return status;
  }
} // namespace Stroma::Materials
