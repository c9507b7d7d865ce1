#pragma once

#include <stroma/sph/constitution.h>
#include <stroma/sph/pairs.h>

namespace Stroma::Sph
{
  /**
   * Forces from stress, and how they change with a displacement: with the area vectors c_ij of the pairs
   *   L_i = 1/(2 V_i) sum_j (v_j - v_i) (x) c_ij,     f_i = 1/2 sum_j (sigma_i + sigma_j) c_ij,
   * each minus the adjoint of the other, so that K_el = G^T V C G is symmetric ((9) of Heck 2017 has c_ij = 2 V_i V_j nabla_i W).
   *
   * The gradient is smoothed, so modes of the size of the spacing are too soft, or not seen at all. They are held by
   *   E = 1/2 sum_ij a_i P_ij |d_ij|^2,   d_ij = v_j - v_i - L_i (x_j - x_i),   a_i = s 4d/3 G_i V_i / sum_j P_ij r^2,
   * which vanishes for linear velocities (after Ganzenmueller 2015). To leading order the smoothed energy of a wave of
   * number k is (1 - k^2 m/(d + 2)) too small, m = sum P r^4/sum P r^2; s = 1 adds just that much for shear, so the error
   * falls from second order with a large constant to one that compression alone leaves.
   *
   * Fixed particles without a row have neither stress nor gradient: their pairs act as pairs with a point of the wall.
   */
  template <int dim>
  class Elasticity
  {
  public:
    /// @param stabilisation s; 0: grid-scale modes are not held
    Elasticity(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours, const std::vector<Constitution> &constitutions,
               double stabilisation);

    /// For the pairs and the volumes as they are now: tangent moduli, a_i, and moments. @p particles with ghosts. Collective.
    void update(const Particles<dim> &particles);

    /// L_i of all rows from velocities @p v with ghosts [1/s].
    void velocity_gradient(std::vector<dealii::Tensor<2, dim>> &L, const std::vector<dealii::Tensor<1, dim>> &v) const;

    /// f += of stresses @p sigma, ghosts included, on free particles [N].
    void add_stress_force(std::vector<dealii::Tensor<1, dim>> &f,
                          const std::vector<dealii::SymmetricTensor<2, dim>> &sigma) const;

    /// What one increment of displacement @p u (ghosts included) does: f += elastic * (-K_el u) + (-K_hold u). Collective.
    void add_stiffness_force(std::vector<dealii::Tensor<1, dim>> &f, const std::vector<dealii::Tensor<1, dim>> &u,
                             bool elastic) const;

    /// After add_stiffness_force(): the part of pair @p p of row @p i in it, for reactions.
    dealii::Tensor<1, dim> hold_pair_force(unsigned int i, std::size_t p, const std::vector<dealii::Tensor<1, dim>> &u) const;

    /// Block of pair @p p of row @p i in a stiffness between neighbours alone that is like K_el + K_hold for smooth motions:
    /// (G - B) P + (d + 2) B P e (x) e, B = (K + G/3)/2, each at least 0.
    dealii::SymmetricTensor<2, dim> pair_block(unsigned int i, std::size_t p) const;

    /// Adds about the diagonal blocks of K_el + K_hold.
    void add_diagonal(std::vector<dealii::SymmetricTensor<2, dim>> &blocks, double factor) const;

    bool holds() const { return !a.empty(); }

  private:
    /// What a neighbour needs of a particle in the second sweep.
    struct Response
    {
      dealii::Tensor<2, dim> sigma; ///< of the increment, minus T/V of the held modes [Pa]
      dealii::Tensor<2, dim> aL;    ///< a_i L_i
    };

    const Pairs<dim>                &pairs;
    const Neighbours<dim>           &neighbours;
    const std::vector<Constitution> &constitutions;
    const double                     stabilisation;

    std::vector<double>                          volume;       ///< of rows [m^dim]
    std::vector<double>                          G, K;         ///< tangent moduli of rows [Pa]
    std::vector<double>                          a;            ///< ghosts included; empty where nothing is held
    mutable std::vector<Response>                response;     ///< ghosts included
    std::vector<dealii::SymmetricTensor<2, dim>> moment;       ///< sum_j P r (x) r of rows, walls where they are seen
  };
} // namespace Stroma::Sph
