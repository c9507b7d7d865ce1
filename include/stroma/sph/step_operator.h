#pragma once

#include <stroma/solvers/operator.h>
#include <stroma/sph/islands.h>

#include <optional>

namespace Stroma::Sph
{
  /**
   * What NSPH solves with: Gamma + dt (K_el + K_hg) on the velocities of free particles, or Gamma alone with explicit
   * stresses; and behind these the unknowns of the rigid bodies that the balance of forces moves (BodyBalance), on the last rank.
   * Held components are left alone. Between projections on motions in which no island (Islands) moves as a whole. Matrix-free, from the pairs as they are.
   */
  template <int dim>
  class StepOperator : public Solvers::Operator
  {
  public:
    using Velocities = typename System<dim>::Velocities;

    /// @param islands of the system; null: it has none
    explicit StepOperator(const System<dim> &system, const Islands<dim> *islands = nullptr);

    /// Length of the step [s], 0: explicit stresses. To be called whenever the pairs have changed.
    void set_step(double dt);

    /// f = -A v of all particles' velocities @p v, ghosts and places of walls included, on free ones [N]. Collective.
    void force(Velocities &f, const Velocities &v) const;
    /// The same on the unknowns of bodies, of pairs alone; after force(f, v). Collective.
    std::vector<double> force_on_bodies(const Velocities &v) const;

    void                       vmult(Vector &y, const Vector &x) const override;
    void                       diagonal(Vector &d) const override;
    const Matrix              &approximation() override;
    const Solvers::SparseRows &own_block() override;
    bool
    has_border() const override
    {
      return system.bodies != nullptr;
    }
    dealii::FullMatrix<double> border() const override;

    /// The approximation, or the own block, that was asked for last, row by row; empty if none was. And those made of such rows.
    Solvers::SparseRows        matrix_rows() const;
    const Matrix              &restore_approximation(const Solvers::SparseRows &rows);
    const Solvers::SparseRows &restore_own_block(Solvers::SparseRows &&rows);

    /// A vector of all unknowns, zero.
    Vector new_vector() const;
    /// Those of bodies in @p x, on all ranks. Collective.
    std::vector<double> of_bodies(const Vector &x) const;
    /// Sets them. Local.
    void set_bodies(Vector &x, const std::vector<double> &q) const;

    /// What multigrid must represent on coarse grids, 0 on held components: rigid motions of the free particles, or one
    /// constant where components do not meet.
    std::vector<Vector> near_null_space() const;

  private:
    dealii::IndexSet owned(unsigned int n_last) const;
    bool             is_last() const;

    bool
    is_in_island(const unsigned int i) const
    {
      return islands && islands->has(i);
    }

    /// Bit c of each particle, ghosts included: whether component c is held.
    std::vector<std::uint8_t> held_components() const;

    /// What the approximation holds between the particles of pair @p p of row @p i.
    dealii::SymmetricTensor<2, dim> pair_block(unsigned int i, std::size_t p) const;

    bool
    is_stiff() const
    {
      return dt > 0. || system.is_smooth;
    } ///< not friction of pairs alone
    bool
    couples_components() const
    {
      return is_stiff() || !system.friction->is_isotropic();
    }

    const System<dim>    &system;
    const Islands<dim>   *islands;
    double                dt = 0.;
    mutable Velocities    v, f;
    std::optional<Matrix> compact;
    Solvers::SparseRows   own; ///< block
  };
} // namespace Stroma::Sph
