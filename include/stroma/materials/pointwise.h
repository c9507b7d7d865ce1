#pragma once

#include <stroma/materials/material.h>

#include <cmath>

namespace Stroma::Materials
{
  /// b = F F^T.
  inline dealii::SymmetricTensor<2, 3>
  left_cauchy_green(const dealii::Tensor<2, 3> &F)
  {
    dealii::SymmetricTensor<2, 3> b;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = i; j < 3; ++j)
        b[i][j] = F[i][0] * F[j][0] + F[i][1] * F[j][1] + F[i][2] * F[j][2];
    return b;
  }

  /// Measures of strain between which a law stands.
  enum class Strain
  {
    finite,
    small ///< det F <= 0 is allowed
  };

  /**
   * Material::evaluate() of a law that answers point by point: here alone det F, finite numbers and outputs that nobody
   * wants are seen to.
   * @param respond called with (point, det F), where det F > 0 unless strains are small. Returns the response, with
   *   `double magnitude() const`, an estimate of the largest stress or stiffness [Pa] that is not finite if a result
   *   is not, `SymmetricTensor<2,3> tau() const`, `void fill(SymmetricTensor<4,3> &Jc) const` (all 36 entries) and
   *   `double psi() const`. It is asked for what is wanted only.
   */
  template <typename Respond>
  StepStatus
  evaluate_points(const MaterialInput &input, const MaterialOutput &output, const Respond &respond,
                  const Strain strain = Strain::finite)
  {
    StepStatus status = StepStatus::ok;
    for (std::size_t p = 0; p < input.F.size(); ++p)
      {
        const double J = determinant(input.F[p]);
        if (!(J > 0.) && strain == Strain::finite)
          {
            status = worse(status, J <= 0. ? StepStatus::inverted_point : StepStatus::not_finite);
            continue;
          }
        const auto point = respond(p, J);
        if (!std::isfinite(point.magnitude()))
          {
            status = StepStatus::not_finite;
            continue;
          }
        if (output.tau.size() > 0)
          output.tau[p] = point.tau();
        if (output.Jc.size() > 0)
          point.fill(output.Jc[p]);
        if (output.psi.size() > 0)
          output.psi[p] = point.psi();
        if (output.F33.size() > 0)
          output.F33[p] = input.F[p][2][2];
      }
    return status;
  }
} // namespace Stroma::Materials
