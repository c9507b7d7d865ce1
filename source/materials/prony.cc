#include <stroma/base/parameters.h>
#include <stroma/base/text.h>

#include <stroma/materials/prony.h>

#include <numeric>

namespace Stroma::Materials
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  namespace
  {
    double
    sum(const std::vector<double> &parts)
    {
      return std::accumulate(parts.begin(), parts.end(), 0.);
    }

    /// 2 mu dev E + 3 kappa vol E.
    SymmetricTensor<2, 3>
    hooke(const ElasticConstants &moduli, const SymmetricTensor<2, 3> &E)
    {
      return 2. * moduli.mu * E + moduli.lambda() * trace(E) * dealii::unit_symmetric_tensor<3>();
    }

    /// Energy of a spring under stress h: dev h : dev h/(4 mu) + (tr h)^2/(18 kappa); a spring that is not there has
    /// none.
    double
    spring_energy(const ElasticConstants &moduli, const SymmetricTensor<2, 3> &h)
    {
      const auto   dev_h = deviator(h);
      const double shear = moduli.mu > 0. ? dev_h * dev_h / (4. * moduli.mu) : 0.;
      return shear + (moduli.kappa > 0. ? trace(h) * trace(h) / (18. * moduli.kappa) : 0.);
    }

    SymmetricTensor<2, 3>
    read_tensor(const double *const numbers)
    {
      SymmetricTensor<2, 3> tensor;
      for (unsigned int m = 0; m < 6; ++m)
        tensor.access_raw_entry(m) = numbers[m];
      return tensor;
    }

    void
    write_tensor(double *const numbers, const SymmetricTensor<2, 3> &tensor)
    {
      for (unsigned int m = 0; m < 6; ++m)
        numbers[m] = tensor.access_raw_entry(m);
    }

    /// lambda b_ij b_kl + mu (b_ik b_jl + b_il b_jk), the push-forward of Hooke's tensor.
    SymmetricTensor<4, 3>
    push_forward(const ElasticConstants &moduli, const SymmetricTensor<2, 3> &b)
    {
      SymmetricTensor<4, 3> Jc;
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = i; j < 3; ++j)
          for (unsigned int k = 0; k < 3; ++k)
            for (unsigned int l = k; l < 3; ++l)
              Jc[i][j][k][l] = moduli.lambda() * b[i][j] * b[k][l] +
                               moduli.mu * (b[i][k] * b[j][l] + b[i][l] * b[j][k]);
      return Jc;
    }

    /// The parts of one modulus: as many as times, none negative, less than the whole together.
    void
    add_parts(Parameters &p, const std::string &name, std::vector<double> &parts, const std::string &meaning,
              const std::size_t n_times)
    {
      parts = {std::nan("")}; // must be given
      p.add(name, parts, meaning, "", Range::non_negative());
      if (p.get_mode() == Parameters::Mode::document)
        return;
      if (parts.size() != n_times)
        throw UserError(p.where(name), "'" + name + "' has " + counted(parts.size(), "number") +
                                         " and 'Relaxation times' has " + std::to_string(n_times) +
                                         "; give one for each time");
      if (!(sum(parts) < 1.))
        throw UserError(p.where(name), "'" + name + "' add up to " + shortest(sum(parts)) +
                                         "; they must add up to less than 1 to leave a solid; make them smaller");
    }
  } // namespace

  PronySeries
  PronySeries::kelvin_voigt(const ElasticConstants &relaxed, const double viscosity, const double delta)
  {
    const double tau_K = 5. / 3. * viscosity / relaxed.kappa, tau_G = viscosity / relaxed.mu; // (50), (51)
    return {relaxed, {tau_K * delta, tau_G * delta}, {delta, 1. - 2. * delta}, {1. - 2. * delta, delta}};
  }

  void
  PronySeries::add(Parameters &p)
  {
    const std::string viscosity_name = "Kelvin-Voigt viscosity", times_name = "Relaxation times";
    const bool        documenting  = p.get_mode() == Parameters::Mode::document;
    const bool        by_viscosity = p.given(viscosity_name), by_times = p.given(times_name);
    relaxed.add(p);
    if (!documenting && by_viscosity == by_times)
      throw UserError(by_times ? p.where(times_name) : p.where_section(),
                      "the law 'Prony' needs either '" + viscosity_name + "' or '" + times_name +
                        "' with 'Shear parts g' and 'Bulk parts k'; " + (by_times ? "both were" : "none was") +
                        " given; give one of the two");
    if (by_viscosity || documenting)
      {
        double viscosity = std::nan(""), delta = .1;
        p.add(
          viscosity_name, viscosity,
          "shear viscosity of the Kelvin-Voigt solid that two terms stand for, Heck et al. 2017 (62)-(69); its bulk "
          "viscosity is 5/3 of this",
          "Pa*s", Range::positive());
        p.add("Delta", delta, "relaxed over instantaneous moduli of these terms; exact Kelvin-Voigt in the limit 0", "",
              Range::open(0., .5));
        *this = kelvin_voigt(relaxed, viscosity, delta);
      }
    if (by_times || documenting)
      {
        times = {std::nan("")}; // must be given
        p.add(times_name, times, "times tau_i of the terms of the Prony series", "s", Range::positive());
        add_parts(
          p, "Shear parts g", shear_parts,
          "parts g_i of the instantaneous shear modulus that relax; the moduli given are the relaxed ones, 1 - sum g_i "
          "of the instantaneous",
          times.size());
        add_parts(
          p, "Bulk parts k", bulk_parts,
          "parts k_i of the instantaneous bulk modulus that relax; that given is the relaxed one, 1 - sum k_i of it",
          times.size());
      }
  }

  Prony::Prony(const PronySeries &series, const Strain strain)
    : relaxed(series.relaxed)
    , strain(strain)
  {
    const double G_0 = relaxed.mu / (1. - sum(series.shear_parts)), K_0 = relaxed.kappa / (1. - sum(series.bulk_parts));
    for (std::size_t i = 0; i < series.times.size(); ++i)
      terms.push_back({series.times[i], {G_0 * series.shear_parts[i], K_0 * series.bulk_parts[i]}});
  }

  /// The response at one point: strain, stress between the strain's own measure, moduli of the algorithmic tangent.
  class Prony::Point
  {
  public:
    Point(const Prony &law, const Tensor<2, 3> &F)
      : law(law)
      , F(F)
      , E(law.strain == Strain::finite ? .5 * (symmetrize(transpose(F) * F) - dealii::unit_symmetric_tensor<3>()) :
                                         symmetrize(F) - dealii::unit_symmetric_tensor<3>())
      , tangent(law.relaxed)
      , S(hooke(law.relaxed, E))
      , energy(.5 * (S * E))
    {}

    /// Takes the step of all terms.
    /// @param before history at the start of the step; @p after at its end, may be the same place or null
    void
    step(const double *before, double *after, const double dt)
    {
      const SymmetricTensor<2, 3> increment = E - read_tensor(before);
      if (after != nullptr)
        write_tensor(after, E);
      for (std::size_t i = 0; i < law.terms.size(); ++i)
        {
          const Term                 &term   = law.terms[i];
          const double                x      = dt / term.time;
          const double                factor = x > 0. ? -std::expm1(-x) / x : 1.;
          const SymmetricTensor<2, 3> h      = std::exp(-x) * read_tensor(before + 6 * (i + 1)) +
                                          factor * hooke(term.moduli, increment);
          S += h;
          energy += spring_energy(term.moduli, h);
          tangent.mu += factor * term.moduli.mu;
          tangent.kappa += factor * term.moduli.kappa;
          if (after != nullptr)
            write_tensor(after + 6 * (i + 1), h);
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
      return law.strain == Strain::finite ? symmetrize(F * Tensor<2, 3>(S) * transpose(F)) : S;
    }

    void
    fill(SymmetricTensor<4, 3> &Jc) const
    {
      Jc = push_forward(tangent,
                        law.strain == Strain::finite ? left_cauchy_green(F) : dealii::unit_symmetric_tensor<3>());
    }

  private:
    const Prony                &law;
    const Tensor<2, 3>         &F;
    const SymmetricTensor<2, 3> E;
    ElasticConstants            tangent;
    SymmetricTensor<2, 3>       S;
    double                      energy;
  };

  StepStatus
  Prony::evaluate(const MaterialInput &input, const MaterialOutput &output) const
  {
    AssertDimension(input.history.size(), n_history() * input.F.size());
    const auto respond = [&](const std::size_t p, double) {
      Point point(*this, input.F[p]);
      point.step(&input.history[p * n_history()],
                 output.history.size() > 0 ? &output.history[p * n_history()] : nullptr, input.dt);
      return point;
    };
    return evaluate_points(input, output, respond, strain);
  }

  std::unique_ptr<Material>
  Prony::small_strain() const
  {
    auto law    = std::make_unique<Prony>(*this);
    law->strain = Strain::small;
    return law;
  }

  double
  Prony::p_wave_modulus() const
  {
    double modulus = relaxed.p_wave_modulus();
    for (const Term &term : terms)
      modulus += term.moduli.p_wave_modulus();
    return modulus;
  }
} // namespace Stroma::Materials
