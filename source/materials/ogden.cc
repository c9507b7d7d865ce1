#include <stroma/base/parameters.h>
#include <stroma/base/text.h>
#include <stroma/materials/ogden.h>
#include <stroma/materials/pointwise.h>

#include <array>

namespace Stroma::Materials
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  /// The response at one point, in the principal axes of b.
  class Ogden::Point
  {
  public:
    Point(const Ogden &law, const double J, const SymmetricTensor<2, 3> &b)
    {
      energy = trace(b);
      if (!std::isfinite(energy)) // its axes would not be found, and eigenvectors() throws
        return;
      const auto   all   = dealii::eigenvectors(b, dealii::SymmetricTensorEigenvectorMethod::jacobi);
      const double log_J = std::log(J), third = 1. / 3.;
      energy = .5 * law.kappa * log_J * log_J;
      stress.fill(law.kappa * log_J);
      for (unsigned int a = 0; a < 3; ++a)
        {
          square[a] = all[a].first;
          axis[a]   = all[a].second;
          slope[a].fill(law.kappa);
        }
      for (const Term &term : law.terms)
        {
          std::array<double, 3> power; // l_a^alpha
          for (unsigned int a = 0; a < 3; ++a)
            power[a] = std::exp(.5 * term.alpha * std::log(square[a]) - third * term.alpha * log_J);
          const double sum = power[0] + power[1] + power[2];
          energy += term.mu / term.alpha * (sum - 3.);
          for (unsigned int a = 0; a < 3; ++a)
            {
              stress[a] += term.mu * (power[a] - third * sum);
              for (unsigned int c = 0; c < 3; ++c)
                slope[a][c] += term.mu * term.alpha * ((a == c) * power[a] - third * (power[a] + power[c]) + sum / 9.);
            }
        }
    }

    double
    magnitude() const
    {
      return energy;
    }
    double
    psi() const
    {
      return energy;
    }

    SymmetricTensor<2, 3>
    tau() const
    {
      SymmetricTensor<2, 3> result;
      for (unsigned int a = 0; a < 3; ++a)
        result += stress[a] * symmetrize(outer_product(axis[a], axis[a]));
      return result;
    }

    /// Simo & Hughes 1998, section 6.3 in principal axes:
    /// sum_ac (d tau_a/d ln lambda_c - 2 tau_a delta_ac) m_a m_c + sum_(a != c) w_ac (n_a n_c)(n_a n_c + n_c n_a).
    void
    fill(SymmetricTensor<4, 3> &Jc) const
    {
      Jc = 0.;
      for (unsigned int a = 0; a < 3; ++a)
        for (unsigned int c = 0; c < 3; ++c)
          {
            const auto m_a = symmetrize(outer_product(axis[a], axis[a])),
                       m_c = symmetrize(outer_product(axis[c], axis[c]));
            Jc += (slope[a][c] - (a == c ? 2. * stress[a] : 0.)) * outer_product(m_a, m_c);
            if (a == c)
              continue;
            const auto shear = symmetrize(outer_product(axis[a], axis[c]));
            Jc += 2. * shear_stiffness(a, c) * outer_product(shear, shear);
          }
    }

  private:
    /// w_ac = (tau_a lambda_c^2 - tau_c lambda_a^2)/(lambda_a^2 - lambda_c^2), in the limit where they are equal.
    double
    shear_stiffness(const unsigned int a, const unsigned int c) const
    {
      const double apart = square[a] - square[c];
      if (std::abs(apart) < 1e-6 * (square[a] + square[c]))
        return .25 * (slope[a][a] - slope[a][c] + slope[c][c] - slope[c][a]) - .5 * (stress[a] + stress[c]);
      return (stress[a] * square[c] - stress[c] * square[a]) / apart;
    }

    double                               energy;
    std::array<double, 3>                square, stress; ///< lambda_a^2, tau_a
    std::array<Tensor<1, 3>, 3>          axis;
    std::array<std::array<double, 3>, 3> slope; ///< d tau_a/d ln lambda_c
  };

  Ogden::Ogden(std::vector<Term> terms, const double kappa)
    : terms(std::move(terms))
    , kappa(kappa)
  {}

  std::unique_ptr<Material>
  Ogden::read(Parameters &p)
  {
    std::vector<double> mu{std::nan("")}, alpha{std::nan("")}; // must be given
    double              kappa = std::nan("");
    p.add("Ogden moduli", mu, "mu_p of the terms of Ogden's law", "Pa", Range::any());
    p.add("Ogden exponents", alpha, "alpha_p of the terms; mu_p alpha_p > 0", "", Range::any());
    p.add("Bulk modulus", kappa, "stiffness against change of volume, kappa", "Pa", Range::positive());
    if (p.get_mode() == Parameters::Mode::document)
      return std::make_unique<Ogden>(std::vector<Term>(), kappa);
    if (mu.size() != alpha.size())
      throw UserError(p.where("Ogden exponents"), "'Ogden exponents' has " + counted(alpha.size(), "number") +
                                                    " and 'Ogden moduli' has " + std::to_string(mu.size()) +
                                                    "; give one for each term");
    std::vector<Term> terms;
    for (std::size_t i = 0; i < mu.size(); ++i)
      {
        if (!(mu[i] * alpha[i] > 0.))
          throw UserError(p.where("Ogden moduli"), "term " + std::to_string(i + 1) + " of Ogden's law has modulus " +
                                                     brief(mu[i]) + " Pa and exponent " + brief(alpha[i]) +
                                                     "; their product must be positive, so give both the same sign");
        terms.push_back({mu[i], alpha[i]});
      }
    return std::make_unique<Ogden>(terms, kappa);
  }

  StepStatus
  Ogden::evaluate(const MaterialInput &input, const MaterialOutput &output) const
  {
    return evaluate_points(input, output, [&](const std::size_t p, const double J) {
      return Point(*this, J, left_cauchy_green(input.F[p]));
    });
  }

  double
  Ogden::p_wave_modulus() const
  {
    double mu = 0;
    for (const Term &term : terms)
      mu += .5 * term.mu * term.alpha;
    return kappa + 4. / 3. * mu;
  }

  std::string
  Ogden::meaning() const
  {
    return "W = sum_p mu_p/alpha_p (l_1^alpha_p + l_2^alpha_p + l_3^alpha_p - 3) + kappa/2 (ln J)^2, " +
           counted(terms.size(), "term");
  }
} // namespace Stroma::Materials
