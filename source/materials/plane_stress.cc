#include <stroma/materials/plane_stress.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace Stroma::Materials
{
  using dealii::ArrayView;
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  namespace
  {
    constexpr std::size_t  block_size     = 32;
    constexpr unsigned int max_iterations = 60;
    constexpr double       tolerance      = 1e-13; // of the step in ln F33

    /// Local Newton iteration of one point for F33, kept inside the interval where tau_33 changes sign.
    class OutOfPlaneStretch
    {
    public:
      void
      start(const double guess)
      {
        F33       = guess;
        lower     = 0.;
        upper     = std::numeric_limits<double>::infinity();
        converged = false;
      }

      /// One step from the response at F33. With F_13 = F_23 = 0, d tau_33 / d ln F33 = Jc_3333 + 2 tau_33.
      void
      update(const double tau_33, const double Jc_3333)
      {
        const double slope = Jc_3333 + 2. * tau_33;
        if (converged || (converged = slope > 0. && std::abs(tau_33) <= tolerance * slope))
          return;
        (tau_33 > 0. ? upper : lower) = F33;
        const double newton           = slope > 0. ? -tau_33 / slope : (tau_33 > 0. ? -.5 : 1.);
        const double next             = F33 * (1. + std::clamp(newton, -.5, 1.));
        F33                           = next > lower && next < upper ? next : .5 * (lower + upper);
      }

      double F33;
      bool   converged;

    private:
      double lower, upper;
    };

    /// The part of @p view that belongs to the block, or an empty view.
    template <typename T>
    ArrayView<T>
    part(const ArrayView<T> &view, const std::size_t begin, const std::size_t size)
    {
      return view.size() == 0 ? view : ArrayView<T>(view.data() + begin, size);
    }

    /// @p wanted, or @p scratch where the caller wants none.
    template <typename T>
    ArrayView<T>
    or_scratch(const ArrayView<T> &wanted, std::array<T, block_size> &scratch, const std::size_t size)
    {
      return wanted.size() == 0 ? ArrayView<T>(scratch.data(), size) : wanted;
    }

    void
    condense(SymmetricTensor<4, 3> &Jc)
    {
      constexpr std::array<unsigned int, 3> in_plane = {{0, 1, 3}}; // raw indices of 11, 22, 12
      constexpr unsigned int                normal   = 2;           // raw index of 33
      const SymmetricTensor<4, 3>           full     = Jc;
      const double                         *c        = full.begin_raw();
      Jc                                             = 0.;
      for (const unsigned int m : in_plane)
        for (const unsigned int n : in_plane)
          Jc.begin_raw()[6 * m + n] = c[6 * m + n] - c[6 * m + normal] * c[6 * normal + n] / c[6 * normal + normal];
    }

    void
    project(SymmetricTensor<2, 3> &tau)
    {
      for (unsigned int d = 0; d < 3; ++d)
        tau[d][2] = 0.;
    }

    /// The last, tiny step of F33 to first order: what is left of tau_33 would be noise of the stress in the plane.
    void
    relax(SymmetricTensor<2, 3> &tau, const SymmetricTensor<4, 3> &Jc)
    {
      const double step = -tau[2][2] / (Jc[2][2][2][2] + 2. * tau[2][2]); // of ln F33
      tau[0][0] += step * Jc[0][0][2][2];
      tau[1][1] += step * Jc[1][1][2][2];
      tau[0][1] += step * Jc[0][1][2][2];
    }

    /// The points that are iterated together, one call of the law an iteration.
    class Block
    {
    public:
      Block(const ArrayView<const Tensor<2, 3>> &F_in_plane, const double contraction)
        : size(F_in_plane.size())
      {
        for (std::size_t p = 0; p < size; ++p)
          {
            for (unsigned int i = 0; i < 2; ++i)
              for (unsigned int j = 0; j < 2; ++j)
                F[p][i][j] = F_in_plane[p][i][j];
            const double area = F[p][0][0] * F[p][1][1] - F[p][0][1] * F[p][1][0];
            points[p].start(area > 0. ? std::pow(area, -contraction) : 1.);
          }
      }

      /// Finds F33 of all points; leaves the law's response there in @p output, whose tau and Jc are not empty.
      StepStatus
      solve(const Material &law, const MaterialOutput &output)
      {
        for (unsigned int iteration = 0; iteration < max_iterations; ++iteration)
          {
            for (std::size_t p = 0; p < size; ++p)
              F[p][2][2] = points[p].F33;
            const StepStatus status = law.evaluate({ArrayView<const Tensor<2, 3>>(F.data(), size), {}, 0.}, output);
            if (status != StepStatus::ok)
              return status;
            bool all_converged = true;
            for (std::size_t p = 0; p < size; ++p)
              {
                points[p].update(output.tau[p][2][2], output.Jc[p][2][2][2][2]);
                all_converged = all_converged && points[p].converged;
              }
            if (all_converged)
              {
                for (std::size_t p = 0; p < size; ++p)
                  relax(output.tau[p], output.Jc[p]);
                return StepStatus::ok;
              }
          }
        return StepStatus::diverged;
      }

    private:
      std::size_t                               size;
      std::array<Tensor<2, 3>, block_size>      F;
      std::array<OutOfPlaneStretch, block_size> points;
    };
  } // namespace

  PlaneStress::PlaneStress(std::unique_ptr<const Material> law_)
    : law(std::move(law_))
  {
    const Tensor<2, 3>    identity(dealii::unit_symmetric_tensor<3>());
    SymmetricTensor<4, 3> C;
    MaterialOutput        output;
    output.Jc = ArrayView<SymmetricTensor<4, 3>>(&C, 1);
    law->evaluate({ArrayView<const Tensor<2, 3>>(&identity, 1), {}, 0.}, output);
    contraction = .5 * (C[0][0][2][2] + C[1][1][2][2]) / C[2][2][2][2];
    condense(C);
    modulus = C[0][0][0][0];
  }

  StepStatus
  PlaneStress::evaluate(const MaterialInput &input, const MaterialOutput &output) const
  {
    std::array<SymmetricTensor<2, 3>, block_size> tau;
    std::array<SymmetricTensor<4, 3>, block_size> Jc;
    StepStatus                                    status = StepStatus::ok;
    for (std::size_t begin = 0; begin < input.F.size(); begin += block_size)
      {
        const std::size_t size = std::min(block_size, input.F.size() - begin);
        Block             block(part(input.F, begin, size), contraction);
        MaterialOutput    response;
        response.tau = or_scratch(part(output.tau, begin, size), tau, size);
        response.Jc  = or_scratch(part(output.Jc, begin, size), Jc, size);
        response.psi = part(output.psi, begin, size);
        response.F33 = part(output.F33, begin, size);
        status       = worse(status, block.solve(*law, response));
      }
    if (status != StepStatus::ok)
      return status;
    std::for_each(output.tau.begin(), output.tau.end(), project);
    std::for_each(output.Jc.begin(), output.Jc.end(), condense);
    return StepStatus::ok;
  }

  double
  PlaneStress::p_wave_modulus() const
  {
    return modulus;
  }

  std::string
  PlaneStress::name() const
  {
    return law->name();
  }

  std::string
  PlaneStress::meaning() const
  {
    return law->meaning() + ", plane stress";
  }

  bool
  PlaneStress::is_rate_form() const
  {
    return law->is_rate_form();
  }
} // namespace Stroma::Materials
