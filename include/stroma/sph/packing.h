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
   *   E = sum_i kappa_i V_i <s_i - 1>^3/(3 e),     <x> = max(x, 0),     kappa_i = strength |b_i| dp,
   * b the density of the loads on the particle, resists crowding alone; it is a function of places, so that no cycle of motions
   * gains from it, and a fluid in a vessel comes to rest. Its force comes from pairs,
   *   f_i = -sum_j (q_i + q_j) g_ij,   g_ij = V_i V_j F_ij (x_j - x_i)/s_0 = -g_ji,   q = kappa <s - 1>^2/e,  0 of walls,
   * and conserves momentum. (Kernel sums as densities, with forces from their energy: Monaghan 2005, Rep. Prog. Phys. 68, 1703,
   * section 3.) q is a part of the pressure; it is measured by what the loads leave unbalanced over a spacing, not by the bulk
   * modulus: particles that resist with that cannot pass each other, and a nearly incompressible fluid sets. On an undisturbed
   * lattice q and its tangent are 0, and with the spacing kappa vanishes: orders of convergence are those of the closed gradient.
   * Without loads nothing resists, and mean_excess() tells what is lost.
   */
  template <int dim>
  class Packing
  {
  public:
    static constexpr double strength      = 20.;
    static constexpr double e             = .01; ///< excess at which the tangent is 2 kappa
    static constexpr double largest_kappa = .25; ///< over the bulk modulus

    Packing(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours, const std::vector<Constitution> &constitutions,
            const Settings &settings);

    /// For pairs and volumes as they are now: finds particles.excess, too. @p particles with ghosts. Collective.
    void update(Particles<dim> &particles);

    /// Lets particles.excess follow the motion with velocities @p v (of all points) over @p dt, until the next update. Collective.
    void move(Particles<dim> &particles, const std::vector<dealii::Tensor<1, dim>> &v, double dt);

    /// kappa of the loads' @p forces on free particles [N]; then q. Collective.
    void set_loads(const std::vector<dealii::Tensor<1, dim>> &forces);

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
    void   set_pressures();
    void   add_pairs(std::vector<dealii::Tensor<1, dim>> &f, const std::vector<double> &pressures) const;

    const Pairs<dim>                &pairs;
    const Neighbours<dim>           &neighbours;
    const std::vector<Constitution> &constitutions;
    const Settings                   settings;
    double                           s_0 = 1.;

    std::vector<double>                 volume, kappa, K; ///< of rows [m^dim], [Pa], bulk modulus [Pa]
    std::vector<double>                 crowding;         ///< <s - 1> of rows
    std::vector<double>                 q;                ///< of all points, 0 of walls [Pa]
    mutable std::vector<double>         q_of_increment;
    std::vector<dealii::Tensor<1, dim>> g; ///< of pairs [m^(dim - 1)]
  };
} // namespace Stroma::Sph
