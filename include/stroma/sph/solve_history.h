#pragma once

#include <stroma/output/archive.h>

#include <deal.II/base/tensor.h>

#include <deque>

namespace Stroma::Sph
{
  /**
   * The last solves of A v = f, from which the next one starts: v = sum c_k v_k with the c_k that minimise
   *   |f - sum c_k f_k|^2 + (e |f|)^2 |c|^2,
   * e the tolerance of those solves: more of a v_k would bring in more of its error than it takes away (after Fischer, Comput.
   * Methods Appl. Mech. Eng. 163 (1998) 193). A may change slowly, which the solve makes up for. No velocities may be imposed
   * but 0.
   */
  template <int dim>
  class SolveHistory
  {
  public:
    using Velocities = std::vector<dealii::Tensor<1, dim>>;

    explicit SolveHistory(MPI_Comm comm);

    /// A solve of velocities @p v, of which as many count as @p f has entries. @param order number of that in which the particles are.
    void add(const Velocities &v, const Velocities &f, unsigned int order);

    /// Sets the first entries of @p v to what the solves tell of @p f. Returns false, and leaves them, where there are none in this
    /// order. @param error e. Collective.
    bool guess(Velocities &v, const Velocities &f, double error, unsigned int order) const;

    /// Those in this order. Collective.
    void save(Output::ArchiveWriter &archive, unsigned int order) const;
    void restore(const Output::ArchiveReader &archive, unsigned int order);

  private:
    struct Solve
    {
      Velocities v, f;
    };

    const MPI_Comm    comm;
    std::deque<Solve> solves; ///< the newest one first
    unsigned int      order_of_solves = 0;
  };
} // namespace Stroma::Sph
