#include <stroma/rigid/turning_term.h>

#include <deal.II/base/mpi.h>

#include <cmath>
#include <limits>

namespace Stroma::Rigid
{
  template <int dim>
  TurningTerm<dim>::TurningTerm(const Scene<dim> &scene, const Unknowns<dim> &unknowns)
    : scene(scene)
    , unknowns(unknowns)
  {}

  /// Whether the balance of forces turns rigid body @p b.
  template <int dim>
  bool
  TurningTerm<dim>::turns_freely(const unsigned int b) const
  {
    const auto kind = scene.rigid_bodies[b].drive.rotation.front();
    return kind == DrivenBy::force || kind == DrivenBy::free;
  }

  template <int dim>
  Axial<dim>
  TurningTerm<dim>::rotation(const unsigned int b, const Vector &u) const
  {
    Axial<dim> theta;
    for (unsigned int k = 0; k < n_rotations<dim>; ++k)
      theta[k] = u(unknowns.unknown(b, dim + k)) / unknowns.length(b);
    return theta;
  }

  template <int dim>
  std::vector<dealii::types::global_dof_index>
  TurningTerm<dim>::dofs(const unsigned int b) const
  {
    std::vector<dealii::types::global_dof_index> dofs;
    for (unsigned int k = 0; k < n_rotations<dim>; ++k)
      dofs.push_back(unknowns.unknown(b, dim + k));
    return dofs;
  }

  template <int dim>
  void
  TurningTerm<dim>::add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const
  {
    for (unsigned int b = 0; b < scene.rigid_bodies.size(); ++b)
      if (turns_freely(b))
        constraints.add_entries_local_to_global(dofs(b), pattern, false);
  }

  template <int dim>
  StepStatus
  TurningTerm<dim>::add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage)
  {
    last.assign(unknowns.size(), 0.);
    for (unsigned int b = 0; b < scene.rigid_bodies.size(); ++b)
      if (const auto &drive = scene.rigid_bodies[b].drive; !drive.torques.empty())
        {
          const auto forces = unknowns.conjugate(b, rotation(b, motion.u), {}, drive.torque(stage.t));
          const auto rows   = dofs(b);
          for (unsigned int k = 0; k < rows.size(); ++k)
            if (r.in_local_range(rows[k]))
              {
                r(rows[k]) += forces[k];
                last[rows[k] - unknowns.unknown(0, 0)] = forces[k];
              }
        }
    return StepStatus::ok;
  }

  template <int dim>
  StepStatus
  TurningTerm<dim>::add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage,
                                const Solvers::Constraints &constraints)
  {
    constexpr unsigned int n = n_rotations<dim>;
    constexpr double       h = 1e-5; // [rad], of differences
    for (unsigned int b = 0; b < scene.rigid_bodies.size(); ++b)
      if (turns_freely(b) && r.in_local_range(unknowns.unknown(b, dim)))
        {
          const auto theta  = rotation(b, motion.u);
          const auto torque = scene.rigid_bodies[b].drive.torque(stage.t);
          const auto at     = [&](const unsigned int l, const double step) {
            auto other = theta;
            other[l] += step;
            return unknowns.conjugate(b, other, b < virials.size() ? virials[b] : dealii::Tensor<2, dim>(), torque);
          };
          dealii::FullMatrix<double> k(n);
          for (unsigned int l = 0; l < n; ++l)
            {
              const auto change = (at(l, h) - at(l, -h)) / (2. * h * unknowns.length(b));
              for (unsigned int i = 0; i < n; ++i)
                k(i, l) = -change[i];
            }
          dealii::Vector<double> zero(n);
          constraints.distribute_local_to_global(k, zero, dofs(b), K, r, true);
        }
    return StepStatus::ok;
  }

  template <int dim>
  bool
  TurningTerm<dim>::symmetric() const
  {
    for (unsigned int b = 0; b < scene.rigid_bodies.size(); ++b)
      if (dim == 3 && turns_freely(b) && !scene.rigid_bodies[b].drive.torques.empty())
        return false;
    return true;
  }

  template <int dim>
  double
  TurningTerm<dim>::round_off() const
  {
    double squares = 0.;
    for (const double force : last)
      squares += force * force;
    return std::numeric_limits<double>::epsilon() * std::sqrt(dealii::Utilities::MPI::sum(squares, scene.comm));
  }

  template class TurningTerm<2>;
  template class TurningTerm<3>;
} // namespace Stroma::Rigid
