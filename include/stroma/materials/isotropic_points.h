#pragma once

#include <stroma/materials/elastic_constants.h>
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

  /**
   * Material::evaluate() of an elastic isotropic law, whose response at one point depends on b = F F^T alone.
   * @tparam Point the response at one point, constructed from (constants, J, b), with
   *   `double magnitude() const`, an estimate of the largest stress or stiffness [Pa] that is not finite if a result
   *   is not, `SymmetricTensor<2,3> tau() const`, `void fill(SymmetricTensor<4,3> &Jc) const` (all 36 entries) and
   *   `double psi() const`.
   */
  template <typename Point>
  StepStatus
  evaluate_points(const ElasticConstants &constants, const MaterialInput &input, const MaterialOutput &output)
  {
    StepStatus status = StepStatus::ok;
    for (std::size_t p = 0; p < input.F.size(); ++p)
      {
        const double J = determinant(input.F[p]);
        const Point  point(constants, J, left_cauchy_green(input.F[p]));
        if (!(J > 0.) || !std::isfinite(point.magnitude()))
          {
            status = worse(status, J <= 0. ? StepStatus::inverted_point : StepStatus::not_finite);
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
