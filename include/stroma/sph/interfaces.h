#pragma once

#include <stroma/sph/constitution.h>
#include <stroma/sph/pairs.h>

#include <map>

namespace Stroma::Sph
{
  /**
   * Where solid materials of different moduli meet, the velocity gradient jumps, and its mean over both materials, taken times the
   * modulus of one of them, is no stress. So the pairs across such an interface are taken out of the sums over pairs: L_i, the
   * correction B_i and hourglass control are those of the own material alone. In their place comes the jump
   *   J_ij = v_j - v_i - (theta L_i + (1 - theta) L_j) r,    theta the part of r that lies in the material of i,
   * which is 0 for velocities that are linear on either side and go through the interface without a break. It is lifted into the
   * gradient (Bassi & Rebay 1997; weights of the stiffness after Burman & Zunino 2006, so that the stiff side hardly feels it),
   *   G_i = L_i + 1/V_i sum_across w_ij J_ij (x) c_ij,       w_ij = G_j/(G_i + G_j),
   * and resisted by E = 1/2 sum_across k P |J|^2, k = s 4/3 2 G_i G_j/(G_i + G_j), which is hourglass control across.
   * Forces are minus the adjoint of G: momentum and symmetry are as without interfaces. With area vectors that are closed with
   * their faces on the interface (Pairs::face) a uniform stress leaves no force.
   *
   * A particle with too few neighbours of its own material to tell a gradient (layers of one row) has no pairs across; there
   * the gradient is the mean of both materials.
   */
  template <int dim>
  class Interfaces
  {
  public:
    using Vectors = std::vector<dealii::Tensor<1, dim>>;
    using Tensors = std::vector<dealii::Tensor<2, dim>>;

    /// @param stabilisation s
    Interfaces(const Scene<dim> &scene, const std::vector<Constitution> &constitutions,
               const Neighbours<dim> &neighbours, double stabilisation);

    /// Whether materials of a scene are such that there are any.
    static bool exist_among(const std::vector<Constitution> &constitutions);

    /// Of pairs before their area vectors are closed: finds those across, and sets pairs.face. Collective.
    void find(Pairs<dim> &pairs, const ParticleSet<dim> &particles);
    /// Then, of closed ones: takes the pairs across out of @p pairs, whose P and c are 0 from here on.
    void take(Pairs<dim> &pairs, const ParticleSet<dim> &particles);

    /// Whether row @p i has pairs across.
    bool
    touches(const unsigned int i) const
    {
      return first[i + 1] > first[i];
    }

    /// Moduli of what follows: @p elastic times the elastic ones and @p viscous times viscosities.
    void combine(double elastic, double viscous) const;

    /// L_i -> G_i of velocities @p v with ghosts, and keeps their jumps. Collective.
    void lift(Tensors &L, const Vectors &v) const;

    /// Forces of the pairs across: of stresses @p sigma with ghosts, if given, and of the jumps of the last lift(), if asked for.
    void set_forces(const Tensors *sigma, bool of_jumps) const;
    /// T_i += what those forces do through L_i, as if it were a stress of row i.
    void add_moments(Tensors &T) const;
    /// f += those forces, on free particles.
    void add_forces(Vectors &f) const;

    /// As Elasticity::pair_block(), of pair @p p of row @p i, if that is one across; else 0.
    dealii::SymmetricTensor<2, dim> pair_block(unsigned int i, std::size_t p) const;
    /// Adds about the diagonal blocks of the pairs across.
    void add_diagonal(std::vector<dealii::SymmetricTensor<2, dim>> &blocks) const;

    /// A pair across: number p of row i.
    struct Pair
    {
      unsigned int           i, p, j;
      double                 theta = .5;
      double                 P     = 0.;
      double                 weight; ///< w_ij
      double                 G, K;   ///< harmonic means [Pa],
      double                 mu;     ///< and of viscosities [Pa s]
      dealii::Tensor<1, dim> r, c;

      dealii::Tensor<1, dim> jump, force; ///< as found last
    };
    /// Of this rank, row by row.
    const std::vector<Pair> &
    pairs_across() const
    {
      return across;
    }
    /// k P of the elastic moduli [N/m].
    double
    hourglass_stiffness(const Pair &pair) const
    {
      return stabilisation * 4. / 3. * pair.G * pair.P;
    }

  private:
    bool   differ(unsigned int material, unsigned int other) const;
    double share(const ParticleSet<dim> &particles, unsigned int i, unsigned int j);
    Pair   new_pair(const Pairs<dim> &pairs, const ParticleSet<dim> &particles, unsigned int i, unsigned int p);
    double
    modulus(const Pair &pair) const
    {
      return elastic_now * pair.G + viscous_now * pair.mu;
    }
    dealii::SymmetricTensor<2, dim> block_of(const Pair &pair) const;

    const Scene<dim>                &scene;
    const std::vector<Constitution> &constitutions;
    const Neighbours<dim>           &neighbours;
    const double                     stabilisation;

    std::map<std::pair<std::uint64_t, std::uint64_t>, double> shares; ///< by ids, of all pairs met so far
    std::vector<double>                                       volume; ///< of rows [m^dim]
    mutable std::vector<Pair>                                 across; ///< row by row
    std::vector<std::size_t>                                  first;  ///< of each row
    mutable double                                            elastic_now = 1., viscous_now = 0.;
    mutable Tensors                                           one_sided; ///< L, ghosts included
  };
} // namespace Stroma::Sph
