#pragma once

#include <stroma/materials/elastic_constants.h>
#include <stroma/materials/material.h>

#include <deal.II/base/tensor.h>

#include <cmath>
#include <random>
#include <vector>

/// Deformation gradients to test with, and a law's whole answer to them.
namespace Points
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;
  using Stroma::StepStatus;
  using Stroma::Materials::ElasticConstants;
  using Stroma::Materials::Material;

  /// The collagen of Guilkey et al. 2006.
  constexpr ElasticConstants collagen{520.8, 1041.6};

  const auto I = dealii::unit_symmetric_tensor<3>();

  constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

  struct Response
  {
    StepStatus                         status;
    std::vector<SymmetricTensor<2, 3>> tau;
    std::vector<SymmetricTensor<4, 3>> Jc;
    std::vector<double>                psi, F33;
  };

  inline Response
  respond(const Material &law, const std::vector<Tensor<2, 3>> &F)
  {
    const auto n = F.size();
    Response   r{StepStatus::ok, std::vector<SymmetricTensor<2, 3>>(n), std::vector<SymmetricTensor<4, 3>>(n),
               std::vector<double>(n), std::vector<double>(n)};
    r.status = law.evaluate({dealii::make_array_view(F), {}, 0.}, {dealii::make_array_view(r.tau),
                                                                   dealii::make_array_view(r.Jc),
                                                                   dealii::make_array_view(r.psi),
                                                                   dealii::make_array_view(r.F33),
                                                                   {}});
    return r;
  }

  inline Tensor<2, 3>
  diagonal(const double F11, const double F22, const double F33)
  {
    Tensor<2, 3> F;
    F[0][0] = F11;
    F[1][1] = F22;
    F[2][2] = F33;
    return F;
  }

  /// @p n deformation gradients I + random entries up to @p size, with det F > 0.2.
  inline std::vector<Tensor<2, 3>>
  random(const unsigned int n, const double size)
  {
    std::mt19937                           generator(7);
    std::uniform_real_distribution<double> entry(-size, size);
    std::vector<Tensor<2, 3>>              all;
    while (all.size() < n)
      {
        Tensor<2, 3> F = diagonal(1., 1., 1.);
        for (unsigned int i = 0; i < 9; ++i)
          F[i / 3][i % 3] += entry(generator);
        if (determinant(F) > .2)
          all.push_back(F);
      }
    return all;
  }

  /// The same without out-of-plane shear and with F33 = 1.
  inline std::vector<Tensor<2, 3>>
  random_in_plane(const unsigned int n, const double size)
  {
    std::vector<Tensor<2, 3>> all;
    for (Tensor<2, 3> F : random(4 * n, size))
      {
        for (unsigned int d = 0; d < 3; ++d)
          F[d][2] = F[2][d] = d == 2 ? 1. : 0.;
        if (determinant(F) > .2 && all.size() < n)
          all.push_back(F);
      }
    return all;
  }

  /// Some rotation about no particular axis.
  inline Tensor<2, 3>
  rotation()
  {
    const double       c = std::cos(.7), s = std::sin(.7), d = std::cos(2.1), t = std::sin(2.1);
    const Tensor<2, 3> about_z({{c, -s, 0.}, {s, c, 0.}, {0., 0., 1.}});
    const Tensor<2, 3> about_x({{1., 0., 0.}, {0., d, -t}, {0., t, d}});
    return about_z * about_x;
  }
} // namespace Points
