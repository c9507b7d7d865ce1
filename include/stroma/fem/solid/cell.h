#pragma once

#include <stroma/fem/settings.h>
#include <stroma/materials/material_block.h>

#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/lac/full_matrix.h>

namespace Stroma::Fem
{
  /**
   * Momentum balance of one cell of a solid, its own quadrature loop, independent of the material points' kernel:
   *   f_a = int S grad N_a dV0 + int rho a N_a dV0,   S = tau + J sigma_v(L),
   * with spatial gradients, tau the law's Kirchhoff stress, sigma_v the viscous Cauchy stress and L the velocity
   * gradient; with small kinematics gradients are at undeformed places and J = 1.
   *
   * With the dilatation projected (F-bar in its symmetric form; Simo, Taylor & Pister 1985), the law sees
   * Fbar = (Jbar/J)^(1/3) F, Jbar = Pi J, and
   *   S = dev tau(Fbar) + pi J I,   pi = Pi [ tr tau(Fbar) / (3 Jbar) ],
   * the stress of the energy int psi(Fbar): Pi is the projection in the undeformed cell onto polynomials of one degree less
   * than the displacement's (constants for Q1, linear functions for Q2).
   */
  template <int dim>
  class SolidCell
  {
  public:
    /// Motion of the cell's unknowns; empty velocity or acceleration: not needed.
    struct Motion
    {
      std::vector<double> u, v, a;
      double              v_factor = 0., a_factor = 0.; ///< dv/du, da/du
      double              dt = 0.;                      ///< for laws with history [s]
    };

    SolidCell(const Scene<dim> &scene, const Settings<dim> &settings, const dealii::FESystem<dim> &fe,
              const dealii::Mapping<dim> &mapping);

    /// Goes to a cell. @param history n_history() numbers of each quadrature point, or nullptr
    void reinit(const typename dealii::DoFHandler<dim>::active_cell_iterator &cell, const double *history);

    /// f [N]; in two dimensions for the scene's thickness.
    StepStatus force(const Motion &motion, dealii::Vector<double> &f);

    /// Squared norm of the cell's forces before anything in them cancels [N^2], after force() at @p motion: of the moduli,
    /// since F = I + grad u is rounded to parts of I, of displacements and velocities whose differences make gradients, of
    /// the stress and of both parts of an acceleration. The round-off of force() is a part of that.
    double summed_force_square(const Motion &motion);

    /// K = df/du [N/m].
    StepStatus stiffness(const Motion &motion, dealii::FullMatrix<double> &K);

    /// Mass matrix [kg].
    void mass(dealii::FullMatrix<double> &M) const;

    /// Stress and deformation of the last force() or stiffness().
    const dealii::Tensor<2, 3> &
    deformation(const unsigned int q) const
    {
      return block.F[q];
    } ///< as given to the law
    double
    stretch_z(const unsigned int q) const
    {
      return thins ? block.F33[q] : 1.;
    }                                                                        ///< F_33 of plane scenes
    dealii::SymmetricTensor<2, 3> cauchy_stress(const unsigned int q) const; ///< viscous part included
    double                        strain_energy() const;                     ///< [J], elastic
    void                          new_history(const Motion &motion, double *history);

    unsigned int
    n_points() const
    {
      return n_q;
    }
    /// Numbers that each quadrature point remembers.
    unsigned int
    n_history() const
    {
      return block.n_history();
    }
    unsigned int
    material(const unsigned int q) const
    {
      return materials[q];
    }
    /// Undeformed volume of a quadrature point [m^3].
    double
    volume(const unsigned int q) const
    {
      return scene.thickness * fe_values.JxW(q);
    }
    const dealii::Point<dim> &
    place(const unsigned int q) const
    {
      return fe_values.quadrature_point(q);
    }
    const dealii::FEValues<dim> &
    values() const
    {
      return fe_values;
    }

    /// The law of material @p m for the scene's kinematics.
    const Materials::Material &
    law(const unsigned int m) const
    {
      return block.law(m);
    }

    /// Whether stiffness() is symmetric.
    bool
    symmetric() const
    {
      return block.has_symmetric_tangents() && (small || !viscous);
    }

  private:
    using Gradient = dealii::Tensor<1, dim>;

    void       find_kinematics(const Motion &motion);
    void       make_projection();
    StepStatus evaluate(unsigned int wanted, const Motion &motion);
    void       find_stress();
    void       project(std::vector<double> &values) const;
    void       stress_rate(const Motion &motion, unsigned int component, unsigned int node);

    const Scene<dim>                                  &scene;
    const Settings<dim>                               &settings;
    const dealii::FESystem<dim>                       &fe;
    dealii::FEValues<dim>                              fe_values;
    unsigned int                                       n_q, n_dofs, n_nodes;
    bool                                               small, projected, viscous;
    bool                                               thins;      ///< plane stress finds F33
    std::vector<std::unique_ptr<Materials::Material>>  small_laws; ///< with small kinematics
    Materials::MaterialBlock                           block;
    std::vector<std::pair<unsigned int, unsigned int>> place_of;  ///< component and node of an unknown
    std::vector<std::vector<double>>                   modes;     ///< [mode][q], orthonormal in the cell
    std::vector<double>                                W;         ///< weights [m^3]
    std::vector<unsigned int>                          materials; ///< at each point

    // At each quadrature point, of the last evaluation.
    std::vector<std::vector<Gradient>> g; ///< [q][node]
    std::vector<dealii::Tensor<2, 3>>  L, S;
    std::vector<double>                J, J_bar, pi; ///< pi: projected mean stress
    std::vector<dealii::Tensor<2, 3>>  rate;         ///< dS - S l^T of one unknown
    std::vector<double>                theta, mean_rate;
    std::vector<double>                summed; ///< at each node, see summed_force_square()
  };
} // namespace Stroma::Fem
