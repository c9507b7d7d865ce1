#pragma once

#include <stroma/sph/pairs.h>

namespace Stroma::Sph
{
  /**
   * Shear stress where a solid is degraded: pairs bear it in proportion to f_i f_j (Heck 2017, below (36)), f the factor of each
   * particle, 1 of walls, so that what has become a fluid neither strains nor pulls at what is solid. Friction and the mean stress are
   * those of the whole. In rows with a neighbour, or a particle, that is degraded
   *   L^d_i = f_i/(2 V_i) sum_j f_j (v_j - v_i) (x) c_ij B^d_i,     dS_i/dt = 2 G dev L^d_i + spin,
   *   f_i += 1/2 sum_j f_i f_j (S_i B^d_i^T + S_j B^d_j^T) c_ij,
   * each minus the adjoint of the other. With M_i = 1/(2 V_i) sum_j f_j r (x) c, B^d_i = f_i M_i^-1: L^d = f_i^2 times the gradient of
   * linear motions, also of a solid beside a fluid. (As printed, B = I, a rotation strains the last row of the solid.)
   *
   * Where f falls, S falls in proportion: the exact solution of dS/dt = S dlnf/dt, which (36) means.
   */
  template <int dim>
  class DegradedShear
  {
  public:
    using Vectors = std::vector<dealii::Tensor<1, dim>>;
    using Tensors = std::vector<dealii::Tensor<2, dim>>;

    /// @param degrading whether each mover is a body that degrades
    DegradedShear(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours, const ParticleSet<dim> &particles,
                  std::vector<bool> degrading);

    /// For the pairs and factors as they are now, ghosts included. @param volume of rows [m^dim]. Local.
    void update(const std::vector<double> &volume);

    /// Rows that are not whole.
    const std::vector<unsigned int> &
    rows() const
    {
      return touched;
    }
    bool
    touches(const unsigned int i) const
    {
      return number[i] != none;
    }
    /// The least f around row @p i, itself included, 0 beside a body that degrades: hourglass control of a row goes with it, as it
    /// reaches all of these.
    double
    least(const unsigned int i) const
    {
      return touches(i) ? least_of[number[i]] : 1.;
    }
    /// Share of a row's shear modulus in its stiffness.
    double
    share(const unsigned int i) const
    {
      return touches(i) ? share_of[number[i]] : 1.;
    }

    /// L^d_i of velocities @p v [1/s], of one of rows().
    dealii::Tensor<2, dim> gradient(unsigned int i, const Vectors &v) const;
    /// Finds those of all rows().
    void set_gradients(const Vectors &v);
    /// That of set_gradients(), of one of rows().
    const dealii::Tensor<2, dim> &
    gradient(const unsigned int i) const
    {
      return L[number[i]];
    }

    /// What the shear stress @p S of one of rows() is in the sums of forces, S B^d^T, which it keeps for them.
    dealii::Tensor<2, dim> set_stress(unsigned int i, const dealii::SymmetricTensor<2, dim> &S) const;
    /// Of ghosts; after set_stress() of all rows(). Collective.
    void exchange_stresses() const;
    /// f -= what sums over pairs without f_i f_j have too much.
    void add_force(Vectors &f) const;
    /// The same of pair @p p of row @p i.
    dealii::Tensor<1, dim> pair_force(unsigned int i, std::size_t p) const;

  private:
    static constexpr unsigned int none = static_cast<unsigned int>(-1);

    double
    factor(const unsigned int j) const
    {
      return j < particles.size() && !particles.is_fixed(j) ? particles.intact[j] : 1.;
    }
    double find_least(unsigned int i) const;
    void   set_row(unsigned int i, double volume);

    const Pairs<dim>       &pairs;
    const Neighbours<dim>  &neighbours;
    const ParticleSet<dim> &particles;
    const std::vector<bool> degrading;

    std::vector<unsigned int> touched;
    std::vector<unsigned int> number;             ///< of each row in `touched`
    std::vector<double>       least_of, share_of; ///< of `touched`
    Tensors                   correction;         ///< f_i B^d_i/(2 V_i) of `touched` [1/m^dim]
    Tensors                   conjugate;          ///< B^d_i of `touched`
    Tensors                   L;                  ///< of `touched` [1/s]
    mutable Tensors           stress;             ///< S B^d^T of points, 0 where they are not touched [Pa]
  };
} // namespace Stroma::Sph
