#pragma once

#include <stroma/sph/area_vectors.h>

#include <deal.II/base/mpi.h>

#include <vector>

namespace Stroma::Sph::Closing
{
  /**
   * What the area vectors of rigid bodies that material surrounds must fulfil: those of a closed surface sum up to 0, or a uniform
   * pressure would push the body, and its motion take up volume, where particles before it are closer to each other than behind it. Each
   * such body has an unknown y like the phi of particles,
   *   c_iw += -P dp/2 y,     y = (m + sum_i g_i x_i)/D,     m = dp/2 sum c_iw,  g_i = dp/2 sum_w P b_iw,  D = sum P dp^2/4,
   * with b what the area vector multiplies in the conditions of the row's particle, x their unknowns; it is eliminated from the equations of these.
   */
  template <int dim>
  class ClosedBodies
  {
  public:
    using Basis   = dealii::Tensor<1, dim + 1>;
    using Unknown = typename AreaVectors<dim>::Unknown;
    using Vectors = std::vector<dealii::Tensor<1, dim>>; ///< of movers

    /// @param closed movers that are such bodies @param basis(i, p) b of pair p of row i. Collective.
    template <typename OwnBasis>
    ClosedBodies(const Pairs<dim> &pairs, const ParticleSet<dim> &particles, const std::vector<bool> &closed,
                 const double spacing, const MPI_Comm comm, const OwnBasis &basis)
      : comm(comm)
      , weight(closed.size())
      , missing(closed.size())
    {
      if (none())
        return;
      for (unsigned int i = 0; i < pairs.n_rows() && i < particles.n_free; ++i)
        for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
          {
            const unsigned int m = pairs.mover(particles, p);
            if (!closed[m])
              continue;
            weight[m] += pairs.P[p] * spacing * spacing / 4.;
            missing[m] += spacing / 2. * pairs.c[p];
            entries.push_back({i, m, spacing / 2. * pairs.P[p] * basis(i, p)});
          }
      dealii::Utilities::MPI::sum(weight, comm, weight);
      sum_up(missing);
    }

    bool
    none() const
    {
      return weight.empty();
    }

    /// The part of y that unknowns @p x of owned particles make. Collective.
    Vectors
    response(const std::vector<Unknown> &x) const
    {
      Vectors y(weight.size());
      for (const Entry &e : entries)
        for (unsigned int k = 0; k < dim; ++k)
          y[e.mover][k] += e.g * x[e.row][k];
      sum_up(y);
      return over_weight(std::move(y));
    }

    /// The part that is there without them.
    Vectors
    start() const
    {
      return over_weight(missing);
    }

    /// Calls visit(i, what @p y is in the equations of row i).
    template <typename Visit>
    void
    visit_rows(const Vectors &y, const Visit &visit) const
    {
      for (const Entry &e : entries)
        {
          Unknown part;
          for (unsigned int k = 0; k < dim; ++k)
            part[k] = y[e.mover][k] * e.g;
          visit(e.row, part);
        }
    }

  private:
    struct Entry
    {
      unsigned int row, mover;
      Basis        g;
    };

    void
    sum_up(Vectors &y) const
    {
      for (auto &y_m : y)
        y_m = dealii::Utilities::MPI::sum(y_m, comm);
    }
    Vectors
    over_weight(Vectors y) const
    {
      for (unsigned int m = 0; m < y.size(); ++m)
        y[m] = weight[m] > 0. ? y[m] / weight[m] : dealii::Tensor<1, dim>();
      return y;
    }

    const MPI_Comm      comm;
    std::vector<Entry>  entries;
    std::vector<double> weight;  ///< D of movers
    Vectors             missing; ///< m of movers
  };
} // namespace Stroma::Sph::Closing
