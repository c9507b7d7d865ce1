#include <stroma/materials/neo_hookean.h>
#include <stroma/materials/pointwise.h>

namespace Stroma::Materials
{
  namespace
  {
    class NeoHookeanPoint
    {
    public:
      NeoHookeanPoint(const ElasticConstants &constants, const double J, const dealii::SymmetricTensor<2, 3> &b)
        : kappa(constants.kappa)
        , mu(constants.mu)
        , ln_J(std::log(J))
        , to_bbar(std::exp(-2. / 3. * ln_J))
        , mu_trace(mu * to_bbar * trace(b))
        , s(mu * to_bbar * b)
      {
        for (unsigned int d = 0; d < 3; ++d)
          s[d][d] -= mu_trace / 3.;
      }

      double
      magnitude() const
      {
        return kappa * std::abs(ln_J) + mu_trace;
      }

      dealii::SymmetricTensor<2, 3>
      tau() const
      {
        dealii::SymmetricTensor<2, 3> tau = s;
        for (unsigned int d = 0; d < 3; ++d)
          tau[d][d] += kappa * ln_J;
        return tau;
      }

      /// Jc = (kappa - 2/9 mu tr bbar) I(x)I + (2/3 mu tr bbar - 2 kappa ln J) II - 2/3 (s(x)I + I(x)s).
      void
      fill(dealii::SymmetricTensor<4, 3> &Jc) const
      {
        const double  on_II = 2. / 3. * mu_trace - 2. * kappa * ln_J;
        const double  on_I  = kappa - 2. / 9. * mu_trace;
        const double *s_raw = s.begin_raw(); // 00 11 22 01 02 12
        double       *c     = Jc.begin_raw();
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            {
              c[6 * i + j]             = on_I - 2. / 3. * (s_raw[i] + s_raw[j]) + (i == j ? on_II : 0.);
              c[6 * i + 3 + j]         = -2. / 3. * s_raw[3 + j];
              c[6 * (3 + j) + i]       = -2. / 3. * s_raw[3 + j];
              c[6 * (3 + i) + (3 + j)] = i == j ? .5 * on_II : 0.;
            }
      }

      double
      psi() const
      {
        return .5 * kappa * ln_J * ln_J + .5 * (mu_trace - 3. * mu);
      }

    private:
      const double                  kappa, mu, ln_J, to_bbar, mu_trace;
      dealii::SymmetricTensor<2, 3> s; // mu dev bbar
    };
  } // namespace

  NeoHookean::NeoHookean(const ElasticConstants &constants)
    : constants(constants)
  {}

  StepStatus
  NeoHookean::evaluate(const MaterialInput &input, const MaterialOutput &output) const
  {
    return evaluate_points(input, output, [&](const std::size_t p, const double J) {
      return NeoHookeanPoint(constants, J, left_cauchy_green(input.F[p]));
    });
  }

  double
  NeoHookean::p_wave_modulus() const
  {
    return constants.p_wave_modulus();
  }

  std::string
  NeoHookean::name() const
  {
    return "neo-Hookean";
  }

  std::string
  NeoHookean::meaning() const
  {
    return "tau = mu dev(J^(-2/3) b) + kappa ln J I, W = mu/2 (J^(-2/3) tr b - 3) + kappa/2 (ln J)^2";
  }
} // namespace Stroma::Materials
