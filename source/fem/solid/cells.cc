#include <stroma/fem/solid/cells.h>

#include <deal.II/base/mpi.h>

#include <limits>

namespace Stroma::Fem
{
  template <int dim>
  SolidCells<dim>::SolidCells(const Scene<dim> &scene, const Settings<dim> &settings, const Mesh<dim> &mesh,
                              const Unknowns<dim> &unknowns)
    : unknowns(unknowns)
    , comm(scene.comm)
    , integrals(scene, settings, unknowns.fe, mesh.mapping())
  {
    history.assign(std::size_t(mesh.triangulation.n_locally_owned_active_cells()) * integrals.n_points() *
                     integrals.n_history(),
                   0.);
  }

  template <int dim>
  void
  SolidCells<dim>::add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const
  {
    Dofs dofs(unknowns.fe.n_dofs_per_cell());
    for (const auto &cell : unknowns.dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          cell->get_dof_indices(dofs);
          constraints.add_entries_local_to_global(dofs, pattern, false);
        }
  }

  template <int dim>
  void
  SolidCells<dim>::gather(const Dofs &dofs, const Solvers::Motion &motion, const Solvers::Stage &stage)
  {
    const auto extract = [&](const Vector &from, std::vector<double> &to) {
      to.resize(from.size() > 0 ? dofs.size() : 0);
      if (from.size() > 0)
        from.extract_subvector_to(dofs, to);
    };
    extract(motion.u, of_cell.u);
    extract(motion.v, of_cell.v);
    extract(motion.a, of_cell.a);
    of_cell.v_factor = stage.v_factor;
    of_cell.a_factor = stage.a_factor;
    of_cell.dt       = stage.dt;
  }

  template <int dim>
  StepStatus
  SolidCells<dim>::add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage)
  {
    energy = squares = 0.;
    dealii::Vector<double> f(unknowns.fe.n_dofs_per_cell());
    return for_owned_cells(motion, stage, [&](const auto &, const Dofs &dofs) {
      const StepStatus status = integrals.force(of_cell, f);
      if (status == StepStatus::ok)
        {
          energy += integrals.strain_energy();
          squares += integrals.summed_force_square(of_cell);
          f *= -1.;
          unknowns.mesh_ties.distribute_local_to_global(f, dofs, r);
        }
      return status;
    });
  }

  template <int dim>
  StepStatus
  SolidCells<dim>::add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage,
                               const Solvers::Constraints &constraints)
  {
    dealii::FullMatrix<double> K_cell(unknowns.fe.n_dofs_per_cell());
    dealii::Vector<double>     zero(K_cell.m());
    return for_owned_cells(motion, stage, [&](const auto &, const Dofs &dofs) {
      const StepStatus status = integrals.stiffness(of_cell, K_cell);
      if (status == StepStatus::ok)
        constraints.distribute_local_to_global(K_cell, zero, dofs, K, r, true);
      return status;
    });
  }

  template <int dim>
  double
  SolidCells<dim>::round_off() const
  {
    return 2. * std::numeric_limits<double>::epsilon() * std::sqrt(dealii::Utilities::MPI::sum(squares, comm));
  }

  template <int dim>
  void
  SolidCells<dim>::commit(const Solvers::Motion &motion, const Solvers::Stage &stage)
  {
    if (integrals.n_history() == 0)
      return;
    std::vector<double> next(history.size());
    std::size_t         place = 0;
    for_each_cell(motion, stage, [&](const auto &, SolidCell<dim> &, const Motion &m) {
      integrals.new_history(m, next.data() + place);
      place += integrals.n_points() * integrals.n_history();
    });
    history = next;
  }

  /// Calls visit(unknowns, mass matrix) for owned cells.
  template <int dim>
  template <typename Visit>
  void
  SolidCells<dim>::for_mass_matrices(const Visit &visit)
  {
    dealii::FullMatrix<double> M_cell(unknowns.fe.n_dofs_per_cell());
    Dofs                       dofs(M_cell.m());
    for (const auto &cell : unknowns.dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          cell->get_dof_indices(dofs);
          integrals.reinit(cell, nullptr);
          integrals.mass(M_cell);
          visit(dofs, M_cell);
        }
  }

  template <int dim>
  void
  SolidCells<dim>::add_mass(Matrix &M, Vector &r, const Solvers::Constraints &constraints)
  {
    dealii::Vector<double> zero(unknowns.fe.n_dofs_per_cell());
    for_mass_matrices([&](const Dofs &dofs, const dealii::FullMatrix<double> &M_cell) {
      constraints.distribute_local_to_global(M_cell, zero, dofs, M, r, true);
    });
  }

  template <int dim>
  double
  SolidCells<dim>::strain_energy() const
  {
    return dealii::Utilities::MPI::sum(energy, comm);
  }

  template <int dim>
  double
  SolidCells<dim>::kinetic_energy(const Vector &v)
  {
    double                 sum = 0;
    dealii::Vector<double> values(unknowns.fe.n_dofs_per_cell());
    for_mass_matrices([&](const Dofs &dofs, const dealii::FullMatrix<double> &M_cell) {
      v.extract_subvector_to(dofs.begin(), dofs.end(), values.begin());
      sum += .5 * M_cell.matrix_norm_square(values);
    });
    return dealii::Utilities::MPI::sum(sum, comm);
  }

  template class SolidCells<2>;
  template class SolidCells<3>;
} // namespace Stroma::Fem
