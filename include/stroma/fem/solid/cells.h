#pragma once

#include <stroma/fem/solid/cell.h>
#include <stroma/fem/unknowns.h>
#include <stroma/solvers/term.h>

namespace Stroma::Fem
{
  /// Internal and inertial forces of a solid, cell by cell of its mesh.
  template <int dim>
  class SolidCells : public Solvers::Term
  {
  public:
    SolidCells(const Scene<dim> &scene, const Settings<dim> &settings, const Mesh<dim> &mesh,
               const Unknowns<dim> &unknowns);

    void       add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const override;
    StepStatus add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage) override;
    StepStatus add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage,
                           const Solvers::Constraints &constraints) override;
    bool
    symmetric() const override
    {
      return integrals.symmetric();
    }
    double round_off() const override;
    /// Keeps the state of laws with history.
    void commit(const Solvers::Motion &motion, const Solvers::Stage &stage) override;

    /// Adds the mass matrix to @p M, and what held accelerations do to @p r.
    void add_mass(Matrix &M, Vector &r, const Solvers::Constraints &constraints);

    /// Strain energy at the last add_force() [J]. Collective.
    double strain_energy() const;
    /// Kinetic energy at velocity @p v (relevant unknowns) [J]. Collective.
    double kinetic_energy(const Vector &v);

    /// Calls visit(cell, integrals with F and stress at the motion, motion of the cell) for every owned cell.
    /// @return the worst status on this rank
    template <typename Visit>
    StepStatus for_each_cell(const Solvers::Motion &motion, const Solvers::Stage &stage, const Visit &visit);

    const SolidCell<dim> &
    cell() const
    {
      return integrals;
    }

    /// History of each owned quadrature point, in the order of owned cells, for a checkpoint.
    std::vector<double> history;

  private:
    using Motion = typename SolidCell<dim>::Motion;
    using Dofs   = std::vector<dealii::types::global_dof_index>;

    /// Calls visit(cell, its unknowns) for owned cells, with the integrals there and their motion gathered, until one fails.
    template <typename Visit>
    StepStatus for_owned_cells(const Solvers::Motion &motion, const Solvers::Stage &stage, const Visit &visit);
    void       gather(const Dofs &dofs, const Solvers::Motion &motion, const Solvers::Stage &stage);
    template <typename Visit>
    void for_mass_matrices(const Visit &visit);

    const Unknowns<dim> &unknowns;
    MPI_Comm             comm;
    SolidCell<dim>       integrals;
    Motion               of_cell;                   ///< motion of a cell
    double               energy = 0., squares = 0.; ///< this rank, last add_force()
  };

  template <int dim>
  template <typename Visit>
  StepStatus
  SolidCells<dim>::for_owned_cells(const Solvers::Motion &motion, const Solvers::Stage &stage, const Visit &visit)
  {
    Dofs        dofs(unknowns.fe.n_dofs_per_cell());
    std::size_t place = 0;
    for (const auto &cell : unknowns.dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          cell->get_dof_indices(dofs);
          gather(dofs, motion, stage);
          integrals.reinit(cell, history.data() + place);
          place += integrals.n_points() * integrals.n_history();
          const StepStatus status = visit(cell, dofs);
          if (status != StepStatus::ok)
            return status;
        }
    return StepStatus::ok;
  }

  template <int dim>
  template <typename Visit>
  StepStatus
  SolidCells<dim>::for_each_cell(const Solvers::Motion &motion, const Solvers::Stage &stage, const Visit &visit)
  {
    dealii::Vector<double> f(unknowns.fe.n_dofs_per_cell());
    return for_owned_cells(motion, stage, [&](const auto &cell, const Dofs &) {
      of_cell.a.clear();
      const StepStatus status = integrals.force(of_cell, f);
      visit(cell, integrals, of_cell);
      return status;
    });
  }
} // namespace Stroma::Fem
