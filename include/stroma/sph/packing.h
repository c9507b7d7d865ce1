#pragma once

#include <stroma/sph/constitution.h>
#include <stroma/sph/pairs.h>

namespace Stroma::Sph
{
  /**
   * Keeps the places of a fluid's particles and their volumes together. Volumes are integrated along the motion with the
   * closed gradient, dJ/dt = J tr L, and nothing ties them to places: motions that this gradient does not see (grid-scale ones)
   * move particles together at no cost, a body force finds them, and a tank's level sinks although each particle keeps its
   * volume. What the particles take up where they stand, over what they hold, is
   *   s_i = sum_j V_j W_ij / s_0,     j = i and walls included, s_0 the sum of the undisturbed lattice,
   * 1 at rest, less at free surfaces, more where they are crowded. The energy
   *   E = 1/2 sum_i kappa_i V_i <s_i - 1>^2,     <x> = max(x, 0),    kappa = strength times the bulk modulus,
   * resists crowding alone; it is a function of places, so that no cycle of motions gains from it, and a fluid in a vessel comes
   * to rest. Its force comes from pairs,
   *   f_i = -sum_j (q_i + q_j) g_ij,   g_ij = V_i V_j F_ij (x_j - x_i)/s_0 = -g_ji,   q = kappa <s - 1>,  0 of walls,
   * and conserves momentum. q is a part of the pressure. (Kernel sums as densities, with forces from their energy: Monaghan 2005,
   * Rep. Prog. Phys. 68, 1703, section 3.) On an undisturbed lattice, and for small motions of it, all this is 0 to first order
   * in the motion: convergence with the spacing is that of the closed gradient.
   */
  template <int dim>
  class Packing
  {
  public:
    static constexpr double strength = .25; ///< kappa over the bulk modulus

    Packing(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours, const std::vector<Constitution> &constitutions,
            const Settings &settings);

    /// For pairs and volumes as they are now: finds particles.excess, too. @p particles with ghosts. Collective.
    void update(Particles<dim> &particles);

    /// Lets particles.excess follow the motion with velocities @p v (of all points) over @p dt, until the next update. Collective.
    void move(Particles<dim> &particles, const std::vector<dealii::Tensor<1, dim>> &v, double dt);

    /// q of particles.excess. Collective.
    void set_pressures(const Particles<dim> &particles);

    /// f += the forces on free particles [N].
    void add_force(std::vector<dealii::Tensor<1, dim>> &f) const;
    /// The part of pair @p p of row @p i in it.
    dealii::Tensor<1, dim> pair_force(unsigned int i, std::size_t p) const;

    /// f += @p factor times the change of the forces with an increment of displacement @p u (of all points). Collective.
    void add_stiffness_force(std::vector<dealii::Tensor<1, dim>> &f, const std::vector<dealii::Tensor<1, dim>> &u,
                             double factor) const;

    /// q of row @p i [Pa].
    double pressure(const unsigned int i) const { return q[i]; }

    /// E [J, per metre in 2D]. Of this rank.
    double energy() const;

    /// Mean of <s_i - 1>, weighted by volume: how far places and volumes have drifted apart. Collective.
    double mean_excess() const;

  private:
    template <typename KernelType>
    void   add_rows(Particles<dim> &particles, const KernelType &kernel);
    double rate(unsigned int i, const std::vector<dealii::Tensor<1, dim>> &v) const; ///< ds_i/dt
    void   add_pairs(std::vector<dealii::Tensor<1, dim>> &f, const std::vector<double> &pressures) const;

    const Pairs<dim>                &pairs;
    const Neighbours<dim>           &neighbours;
    const std::vector<Constitution> &constitutions;
    const Settings                   settings;
    double                           s_0 = 1.;

    std::vector<double>                 volume, kappa; ///< of rows [m^dim], [Pa]
    std::vector<std::uint8_t>           is_crowded;    ///< or about to be; of rows
    std::vector<double>                 q;             ///< of all points, 0 of walls [Pa]
    mutable std::vector<double>         q_of_increment;
    std::vector<dealii::Tensor<1, dim>> g; ///< of pairs [m^(dim - 1)]
  };
} // namespace Stroma::Sph
