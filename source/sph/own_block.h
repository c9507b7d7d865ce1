#pragma once

#include <stroma/solvers/operator.h>
#include <stroma/sph/islands.h>

namespace Stroma::Sph
{
  /**
   * StepOperator as a matrix between the unknowns of this rank: of stress and hourglass control row by row, with the vectors of
   * each pair that they are sums of,
   *   K_ab = 1/(4V) (G g_a.g_b I + G g_b (x) g_a + (K - 2/3 G) g_a (x) g_b) + a (P_ab - p_a.M^-1 p_b) I,    g = B^T c, p = P r,
   * the particle's own being minus the sum of those of its pairs; and of friction and what meets across interfaces pair by pair.
   * Shear that is degraded has the share that is left of its modulus, without f_i f_j, and walls are bonded: it preconditions.
   */
  template <int dim>
  class OwnBlock
  {
  public:
    /// @param has_bodies whether those of bodies are on this rank
    /// @param held_components bit c of each particle: whether component c is held
    /// @param islands of the system, whose blocks are shifted; null: it has none
    OwnBlock(const System<dim> &system, bool is_stiff, bool has_bodies,
             const std::vector<std::uint8_t> &held_components, const Islands<dim> *islands);

    /// Upper triangle; bodies behind the particles on the last rank. Collective.
    Solvers::SparseRows upper();

  private:
    /// End number e of a row, its particle itself behind the pairs.
    struct End
    {
      dealii::Tensor<1, dim> g, p; ///< area vector, weighted distance
      double                 P = 0.;
    };
    /// Of a row that sees a body: what unknown u = 1 of it does to the velocity at an end.
    struct Moved
    {
      unsigned int           e, u;
      dealii::Tensor<1, dim> velocity;
    };
    using Block = dealii::Tensor<2, dim>;

    void set_ends(unsigned int k);
    void set_moved();
    bool is_across(unsigned int k, std::size_t p) const;

    unsigned int
    size(const unsigned int k) const
    {
      return pairs.row_start[k + 1] - pairs.row_start[k];
    }
    const End &
    end(const unsigned int k, const unsigned int e) const
    {
      return ends[pairs.row_start[k] + k + e];
    }
    unsigned int
    particle(const unsigned int k, const unsigned int e) const
    {
      return e < size(k) ? pairs.j[pairs.row_start[k] + e] : k;
    }
    /// Number of particle @p i among the ends of row @p k; behind all if it is not there.
    unsigned int                    find(unsigned int k, unsigned int i) const;
    Block                           block(unsigned int k, unsigned int a, unsigned int b) const;
    dealii::SymmetricTensor<2, dim> pair_block(unsigned int k, std::size_t p) const;

    void                       gather(unsigned int i);
    void                       gather_row(unsigned int i, unsigned int k, unsigned int a);
    void                       gather_pairs(unsigned int i);
    Block                     &at(unsigned int j);
    void                       write(Solvers::SparseRows &rows, unsigned int i);
    dealii::FullMatrix<double> sum_of_bodies() const;

    const System<dim>              &system;
    const Pairs<dim>               &pairs;
    const bool                      is_stiff, has_bodies;
    const std::vector<std::uint8_t> held;
    const Islands<dim> *const       islands;
    const unsigned int              n, n_bodies; ///< particles, and unknowns of bodies, of this rank

    std::vector<typename Elasticity<dim>::Row> rows_of; ///< as combined
    std::vector<End>                           ends;
    std::vector<std::vector<Moved>>            moved; ///< by rows; empty where there are no bodies

    // Of the particle that is looked at.
    std::vector<Block>                  blocks;
    std::vector<unsigned int>           columns;   ///< particles, of these
    std::vector<int>                    place;     ///< of each particle in them, -1: none
    std::vector<dealii::Tensor<1, dim>> of_bodies; ///< by unknowns
  };
} // namespace Stroma::Sph
