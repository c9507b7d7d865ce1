#pragma once

#include <cstdint>
#include <vector>

namespace Stroma::Processes
{
  /**
   * A path of dX = -k X dt + sqrt(2 D) dW, X(0) = 0, (38) of Heck 2017, as a function of time alone: the same whatever the steps,
   * the ranks and the restarts are. Its random numbers are counted, not drawn one after another: each is a hash of the seed and of
   * its place in time. Between knots 1 s apart, 1/k if that is less, the exact transition is taken, in between the exact bridge, halving
   * the time down to 2^-20 of the distance of the knots, and then the straight line:
   *   X(t + h) given X(t):                  e^{-kh} X(t) + sqrt(D/k (1 - e^{-2kh})) N(0, 1)
   *   X(t + h) given X(t) and X(t + 2h):    (X(t) + X(t + 2h))/(2 cosh kh) + sqrt(D/k tanh kh) N(0, 1)
   */
  class OrnsteinUhlenbeck
  {
  public:
    /// @param rate k [1/s] @param diffusion D [1/s] @param seed @param component paths of one seed that are independent
    OrnsteinUhlenbeck(double rate, double diffusion, std::uint64_t seed, unsigned int component);

    /// X at time @p t >= 0 [s].
    double at(double t) const;

  private:
    double normal(unsigned int level, std::uint64_t place) const;
    double middle(double left, double right, double h, double number) const;

    double                      rate, diffusion;
    std::uint64_t               key;
    double                      distance; ///< of the knots [s]
    mutable std::vector<double> knots;    ///< as far as they were asked for: they are found one from the other
  };
} // namespace Stroma::Processes
