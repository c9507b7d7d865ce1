#pragma once

#include <stroma/sph/pairs.h>

namespace Stroma::Sph
{
  /**
   * Friction, rate of deformation times 2 mu and 5/3 mu, where a fluid meets the solid that it was. A solid that bears what the fluid does
   * to it stands still, so velocities have a kink at the interface, half way between the last particles of either. A gradient over both sides
   * puts it at the solid's particles (half a spacing too far out) and smears it. With w_ij = max(f_i - f_j, 0), by how much i is more of
   * a solid than j, the solid has the gradient of its own side, and the fluid's pairs with it end half way, so that what they see
   * counts twice:
   *   N_i = 1/(2 V_i) sum_j (1 - w_ij) (v_j - v_i) (x) c_ij B^N_i,
   *   L_i = N_i + 1/(2 V_i) sum_j w_ji (v_j - v_i - N_j r_ij) (x) c_ij B_i,     tau_i = 2 mu dev D + 5/3 mu tr D I of L_i.
   * B^N makes N exact for linear velocities; so is L. Forces are minus the adjoint: of a pair whose j is more of a solid
   *   w_ji/2 (tau_i B_i^T - Q_j) c_ij on i, its opposite on j, besides 1/2 (Q_i + Q_j) c_ij of every pair,
   *   Q_i = (tau_i - 1/(2 V_i) sum_j w_ij tau_j B_j^T c_ij (x) r_ij) B^N_i^T.
   * In a plane shear flow along rows of a lattice the velocity then falls to 0 within .001 spacings of the interface, .44 beyond it with
   * gradients over both sides. Hourglass control leaves such pairs out, by the same share (weights()).
   */
  template <int dim>
  class DegradedFriction
  {
  public:
    using Vectors = std::vector<dealii::Tensor<1, dim>>;
    using Tensors = std::vector<dealii::Tensor<2, dim>>;

    /// @param mu viscosity [Pa s]
    DegradedFriction(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours, const ParticleSet<dim> &particles,
                     double mu);

    /// For the pairs and factors as they are now, ghosts included. @param volume of rows [m^dim] @param correction B. Collective.
    void update(const std::vector<double> &volume, const Tensors &correction);

    /// Rows with a neighbour of another factor.
    const std::vector<unsigned int> &
    rows() const
    {
      return touched;
    }

    /// P (1 - |f_i - f_j|) of all pairs, what hourglass control goes by.
    const std::vector<double> &
    weights() const
    {
      return weight;
    }

    /// tau_i of velocities @p v, @p viscous times: finds them, and adds Q_i to @p stress, of which rows() are then right. Collective.
    void add_responses(Tensors &stress, const Vectors &v, double viscous) const;
    /// L_i of add_responses(), of number @p k of rows().
    const dealii::Tensor<2, dim> &
    gradient(const unsigned int k) const
    {
      return L[k];
    }

    /// After it, what 1/2 (Q_i + Q_j) c_ij leaves out: f += the forces. Local.
    void add_force(Vectors &f) const;
    /// The same of pair @p p of row @p i.
    dealii::Tensor<1, dim> pair_force(unsigned int i, std::size_t p) const;

  private:
    /// f_j - f_i; 0 where the pair ends at a wall, and of solids that are too few to tell a gradient.
    double
    difference(const unsigned int i, const std::size_t p) const
    {
      const unsigned int j = pairs.j[p];
      return j < particles.size() && !particles.is_fixed(j) && !lone[i] && !lone[j] ?
               particles.intact[j] - particles.intact[i] :
               0.;
    }
    void                   find_lone(const std::vector<double> &volumes);
    bool                   is_more_solid(unsigned int i) const;
    dealii::Tensor<2, dim> own_moment(unsigned int i, double V) const;
    void                   add_row(unsigned int i, double V, const dealii::Tensor<2, dim> &B);
    dealii::Tensor<2, dim> own_gradient(unsigned int k, const Vectors &v) const;
    dealii::Tensor<2, dim> beyond_interface(unsigned int k, const Vectors &v) const;
    dealii::Tensor<2, dim> moment(unsigned int k) const;

    const Pairs<dim>       &pairs;
    const Neighbours<dim>  &neighbours;
    const ParticleSet<dim> &particles;
    const double            mu;

    std::vector<std::uint8_t> lone;           ///< of points, ghosts included: solids among fluid that belong to it
    std::vector<double>       weight;         ///< of pairs [m^(dim - 2)]
    std::vector<unsigned int> touched;        ///< rows
    std::vector<double>       volume;         ///< of these [m^dim]
    Tensors                   own, whole;     ///< B^N and B of these
    mutable Tensors           L, tau;         ///< of these [1/s], [Pa]
    mutable Tensors           N, traction, Q; ///< of points, ghosts included; traction: tau B^T [Pa]
  };
} // namespace Stroma::Sph
