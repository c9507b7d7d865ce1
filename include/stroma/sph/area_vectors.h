#pragma once

#include <stroma/sph/pairs.h>

namespace Stroma::Sph
{
  /**
   * Corrects the area vectors c_ij of the pairs such that, on any arrangement of particles,
   *   sum_j c_ij = 0 (half weight for walls): a uniform stress leaves no force on a particle inside the material,
   *   sum_j r_ij (x) c_ij = 2 V_i I:          the gradient of a linear velocity is exact,
   * and c_ij = -c_ji stays. With L_i = 1/(2 V_i) sum_j (v_j - v_i) (x) c_ij and f_i = 1/2 sum_j (sigma_i + sigma_j) c_ij, each
   * minus the adjoint of the other, momentum is conserved, stiffness is symmetric and linear patch tests pass also on
   * disordered particles, where the kernel's own area vectors 2 V_i V_j nabla_i W fail (they are the start and, on a lattice, all
   * there is). The idea is that of conservative meshless schemes (Chiu, Wang, Hu, Jameson 2012); the least change in the norm
   * sum |change|^2/P is
   *   c_ij = P [2 r + phi_i - phi_j + (Psi_i + Psi_j) r],
   * with a vector phi and a tensor Psi a particle from a sparse symmetric system, solved by conjugate gradients. Its large
   * scales do not matter: a residual of tolerance is enough. Particles at a free surface, where areas need not close, have
   * phi = 0; those with hardly a neighbour keep the kernel's area vectors. Where pairs cross an interface between materials, the
   * second condition is that of their faces there, sum_j 2 theta r (x) c_ij, with Pairs::face theta.
   *
   * Where something degrades (particles.open is given), free surfaces are those of the start, particles beside which there was a gap when areas
   * were closed first, with their neighbours. A gap that opens elsewhere is one of places alone, in the wake of a body which draws a fluid
   * along: the law of pressure, K (1/J - 1), bears any tension, and nothing lets matter tear. Particles beside it are closed like
   * those inside, by pairs across it.
   *
   * Rigid bodies that material surrounds (closed) have area vectors that sum up to 0, like any closed surface (Closing::ClosedBodies).
   *
   * Of a fluid, a particle at a free surface has half of its volume below its place. That half is a cell whose area above is the
   * surface's,
   *   sum_j c_ij = -V_i/dp n_i,   sum_j r_ij (x) c_ij = V_i I,   L_i = 1/V_i sum_j (v_j - v_i) (x) c_ij,
   * n the normal; the other half moves as the place does. Then a pressure that falls linearly to 0 at the surface, half a spacing
   * above the places, balances a weight everywhere, and a liquid at rest stays so. (Full volumes have no such balance: then
   * particles would need the gradient of a whole cell and the area of a half one.) The area is what a surface at rest has: where
   * the surface is stretched it may give (softness), or liquid would be pushed to where it wells up already.
   */
  template <int dim>
  class AreaVectors
  {
  public:
    static constexpr double tolerance =
      1e-4; ///< of the two sums, over 2 V_i, root mean square; 1e-3 leaves rows at walls off
    /// The same of fluids, whose particles move past each other: the last digits of such a solve, which depend on the order of sums on
    /// several ranks, grow with the disorder (vortices, 15 steps of .2 spacings: 1e-5 of the stresses with 1e-4).
    static constexpr double       tolerance_of_fluids = 1e-9;
    static constexpr unsigned int max_iterations      = 1000;

    /// The same from scratch. The many iterations of such a solve let round-off grow, and with it the order of sums on several
    /// ranks, up to a tenth of the tolerance (cylinder array, 16^2 particles: 6e-6 of the flow); a third more leave 1e-10.
    static constexpr double       tolerance_from_scratch      = 1e-10;
    static constexpr unsigned int max_iterations_from_scratch = 2000;

    /// Unknowns of a particle; part k belongs to component k of c: phi_k over the spacing, then Psi_kl.
    using Unknown = std::array<dealii::Tensor<1, dim + 1>, dim>;

    /// @param spacing [m]
    /// @param is_fluid whether free surfaces are those of a fluid
    /// @param tolerance_asked instead of tolerance or tolerance_of_fluids; 0: these
    /// @param closed for each mover, whether it is a rigid body that material surrounds; empty: none is
    AreaVectors(const Neighbours<dim> &neighbours, double spacing, bool is_fluid, double tolerance_asked,
                std::vector<bool> closed, MPI_Comm comm);

    /// Corrects pairs.c, and sets pairs.volume_share of a fluid, starting from the last solution in @p particles.closure (0 at first), where the new one is left,
    /// ghosts included. Returns not_finite or not_closed, and leaves the pairs alone, where the
    /// particles are lost or the conditions cannot be met. Collective.
    /// @param from_scratch whether the start is no solution for places nearby
    StepStatus close(Pairs<dim> &pairs, ParticleSet<dim> &particles, bool from_scratch = false) const;

    /// The same with the solution that is known, @p particles.closure, of which owned entries count. Collective.
    void apply(Pairs<dim> &pairs, ParticleSet<dim> &particles) const;

    static constexpr std::uint8_t not_found = 2; ///< particles.open before the first closing

  private:
    void find_free_surface(const Pairs<dim> &pairs, ParticleSet<dim> &particles) const;
    void correct(Pairs<dim> &pairs, ParticleSet<dim> &particles,
                 const std::vector<dealii::Tensor<1, dim>> &of_bodies) const;

    const Neighbours<dim> &neighbours;
    double                 spacing;
    bool                   is_fluid;
    double                 tolerance_asked; ///< what counts
    std::vector<bool>      closed;          ///< movers
    MPI_Comm               comm;
  };
} // namespace Stroma::Sph
