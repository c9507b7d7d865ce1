#include <stroma/materials/linear_elastic.h>
#include <stroma/materials/pointwise.h>

namespace Stroma::Materials
{
  namespace
  {
    class LinearElasticPoint
    {
    public:
      LinearElasticPoint(const ElasticConstants &constants, const double, const dealii::SymmetricTensor<2, 3> &b)
        : lambda(constants.lambda())
        , mu(constants.mu)
        , b(b)
        , trace_e(.5 * (trace(b) - 3.))
      {}

      double
      magnitude() const
      {
        const double size = 2. * trace_e + 4.; // 1 + tr b
        return (std::abs(lambda) + mu) * size * size;
      }

      /// tau = (lambda tr e - mu) b + mu b b.
      dealii::SymmetricTensor<2, 3>
      tau() const
      {
        dealii::SymmetricTensor<2, 3> tau;
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = i; j < 3; ++j)
            tau[i][j] = (lambda * trace_e - mu) * b[i][j] +
                        mu * (b[i][0] * b[0][j] + b[i][1] * b[1][j] + b[i][2] * b[2][j]);
        return tau;
      }

      void
      fill(dealii::SymmetricTensor<4, 3> &Jc) const
      {
        constexpr unsigned int first[] = {0, 1, 2, 0, 0, 1}, second[] = {0, 1, 2, 1, 2, 2}; // of the raw indices
        double                *c = Jc.begin_raw();
        for (unsigned int m = 0; m < 6; ++m)
          for (unsigned int n = m; n < 6; ++n)
            {
              const unsigned int i = first[m], j = second[m], k = first[n], l = second[n];
              c[6 * m + n] = c[6 * n + m] = lambda * b[i][j] * b[k][l] + mu * (b[i][k] * b[j][l] + b[i][l] * b[j][k]);
            }
      }

      /// E:E = e:e with e = (b - I)/2.
      double
      psi() const
      {
        double e_e = 0.;
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            {
              const double e_ij = .5 * (b[i][j] - (i == j ? 1. : 0.));
              e_e += e_ij * e_ij;
            }
        return .5 * lambda * trace_e * trace_e + mu * e_e;
      }

    private:
      const double               lambda, mu;
      const dealii::Tensor<2, 3> b;       // all nine entries: quicker to index than a SymmetricTensor
      const double               trace_e; // = tr E
    };
  } // namespace

  LinearElastic::LinearElastic(const ElasticConstants &constants)
    : constants(constants)
  {}

  StepStatus
  LinearElastic::evaluate(const MaterialInput &input, const MaterialOutput &output) const
  {
    return evaluate_points(input, output, [&](const std::size_t p, const double J) {
      return LinearElasticPoint(constants, J, left_cauchy_green(input.F[p]));
    });
  }

  double
  LinearElastic::p_wave_modulus() const
  {
    return constants.p_wave_modulus();
  }

  std::string
  LinearElastic::name() const
  {
    return "linear elastic";
  }

  std::string
  LinearElastic::meaning() const
  {
    return "St. Venant-Kirchhoff, S = lambda tr E I + 2 mu E with the Green-Lagrange strain E";
  }
} // namespace Stroma::Materials
