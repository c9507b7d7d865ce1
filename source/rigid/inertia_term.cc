#include <stroma/rigid/inertia_term.h>

#include <deal.II/base/mpi.h>

#include <cmath>
#include <limits>

namespace Stroma::Rigid
{
  template <int dim>
  InertiaTerm<dim>::InertiaTerm(const Scene<dim> &scene, const Unknowns<dim> &unknowns)
    : comm(scene.comm)
  {
    for (unsigned int r = 0; r < scene.rigid_bodies.size(); ++r)
      for (unsigned int c = 0; c < dim; ++c)
        if (const double mass = scene.rigid_bodies[r].resistance.mass; mass > 0. && !unknowns.is_prescribed(r, c))
          masses.push_back({unknowns.unknown(r, c), mass});
  }

  template <int dim>
  StepStatus
  InertiaTerm<dim>::add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &)
  {
    for (auto &[dof, mass, force] : masses)
      if (r.in_local_range(dof))
        {
          force = -mass * motion.a(dof);
          r(dof) += force;
        }
    return StepStatus::ok;
  }

  template <int dim>
  StepStatus
  InertiaTerm<dim>::add_tangent(Matrix &K, Vector &, const Solvers::Motion &, const Solvers::Stage &stage,
                                const Solvers::Constraints &)
  {
    add_mass(K, stage.a_factor);
    return StepStatus::ok;
  }

  template <int dim>
  void
  InertiaTerm<dim>::add_mass(Matrix &M, const double factor) const
  {
    for (const auto &[dof, mass, force] : masses)
      if (M.in_local_range(dof))
        M.add(dof, dof, factor * mass);
  }

  template <int dim>
  double
  InertiaTerm<dim>::round_off() const
  {
    double squares = 0.;
    for (const auto &mass : masses)
      squares += mass.force * mass.force;
    return std::numeric_limits<double>::epsilon() * std::sqrt(dealii::Utilities::MPI::sum(squares, comm));
  }

  template <int dim>
  double
  InertiaTerm<dim>::force(const dealii::types::global_dof_index dof) const
  {
    for (const auto &mass : masses)
      if (mass.dof == dof)
        return mass.force;
    return 0.;
  }

  template <int dim>
  double
  InertiaTerm<dim>::kinetic_energy(const Vector &v) const
  {
    double sum = 0.;
    for (const auto &[dof, mass, force] : masses)
      if (v.in_local_range(dof))
        sum += .5 * mass * v(dof) * v(dof);
    return dealii::Utilities::MPI::sum(sum, comm);
  }

  template class InertiaTerm<2>;
  template class InertiaTerm<3>;
} // namespace Stroma::Rigid
