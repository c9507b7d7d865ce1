#pragma once

#include <stroma/output/archive.h>

#include <deal.II/base/tensor.h>

#include <vector>

namespace Stroma::Sph
{
  /**
   * Velocities at the ends of the last steps of NSPH, and where a solve for the next ones begins: with the polynomial in time through
   * the last of them, of the degree that would have told those of the last step best. Smooth motions are so told to a few digits; what
   * jumps is taken as it was. Polynomials that steps of very different lengths make blow up errors of the solves are not taken.
   */
  template <int dim>
  class VelocityHistory
  {
  public:
    using Velocities = std::vector<dealii::Tensor<1, dim>>; ///< one a particle, of which the first n_free count

    /// Velocities @p ahead of now [s]. @param v now, made those. @param order number of that in which the particles are
    void extrapolate(Velocities &v, unsigned int n_free, double ahead, unsigned int order) const;

    /// After a step of length @p dt [s] from velocities @p v to @p next. Those that the first step starts with are in no balance, and tell
    /// nothing. @param order number of that in which the particles are. Collective.
    void add(Velocities &&v, const Velocities &next, unsigned int n_free, double dt, unsigned int order, MPI_Comm comm);

    /// @param n_owned particles of this rank
    void save(Output::ArchiveWriter &archive, unsigned int n_owned, unsigned int order) const;
    /// For particles in the same order as then, which is number @p order now.
    void restore(const Output::ArchiveReader &archive, unsigned int order);

  private:
    /// Of the polynomial of degree @p n through now and the states before, @p ahead of now.
    std::vector<double> weights(unsigned int n, double ahead) const;
    unsigned int        best_degree(const Velocities &v, const Velocities &next, unsigned int n_free, double dt,
                                    MPI_Comm comm) const;

    struct State
    {
      Velocities v;    ///< [m/s]
      double     step; ///< from there to the next state [s]
    };
    std::vector<State> past;               ///< the last one first
    unsigned int       order      = 0;     ///< of the particles in it
    unsigned int       degree     = 1;     ///< the best one of the last step
    bool               in_balance = false; ///< whether a step has been made
  };
} // namespace Stroma::Sph
