#include <stroma/fem/stokes/free_bodies.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Fem
{
  template <int dim>
  FreeBodies<dim>::FreeBodies(const StokesSpace<dim> &space)
    : space(space)
  {
    const auto &bodies = space.scene.rigid_bodies;
    for (unsigned int r = 0; r < bodies.size(); ++r)
      {
        const auto &drive = bodies[r].drive;
        for (unsigned int k = 0; k < dim + Rigid::n_rotations<dim>; ++k)
          if (Rigid::is_by_balance(k < dim ? drive.translation[k] : drive.rotation[k - dim]))
            unknowns.push_back({r, k});
      }
  }

  template <int dim>
  std::vector<Rigid::Twist<dim>>
  FreeBodies<dim>::twists(const std::vector<double> &q) const
  {
    std::vector<Rigid::Twist<dim>> all(space.scene.rigid_bodies.size());
    for (unsigned int u = 0; u < size(); ++u)
      {
        const auto [r, k]                                                 = unknowns[u];
        (k < dim ? all[r].velocity[k] : all[r].angular_velocity[k - dim]) = q[u];
      }
    return all;
  }

  template <int dim>
  dealii::Tensor<1, dim>
  FreeBodies<dim>::velocity(const unsigned int u, const dealii::Point<dim> &X) const
  {
    const auto [r, k] = unknowns[u];
    Rigid::Twist<dim> twist;
    (k < dim ? twist.velocity[k] : twist.angular_velocity[k - dim]) = 1.;
    return twist.at(X - space.scene.rigid_bodies[r].pivot); // the mesh stays where it is
  }

  template <int dim>
  void
  FreeBodies<dim>::impose(Vector &v, const unsigned int u) const
  {
    for (const auto &held : space.held)
      if (space.holders[held.holder].rigid == static_cast<int>(unknowns[u].rigid))
        v[held.dof] = velocity(u, held.X)[held.component];
    v.compress(dealii::VectorOperation::insert);
    space.tied_velocity.distribute(v);
  }

  template <int dim>
  std::vector<double>
  FreeBodies<dim>::forces(const Vector &unbalanced) const
  {
    std::vector<double> forces(size());
    for (const auto &held : space.held)
      for (unsigned int u = 0; u < size(); ++u)
        if (space.holders[held.holder].rigid == static_cast<int>(unknowns[u].rigid))
          forces[u] += unbalanced[held.dof] * velocity(u, held.X)[held.component];
    dealii::Utilities::MPI::sum(forces, space.scene.comm, forces);
    return forces;
  }

  template <int dim>
  std::vector<double>
  FreeBodies<dim>::loads(const double t) const
  {
    std::vector<double> forces;
    for (const auto &[r, k] : unknowns)
      {
        const auto &drive = space.scene.rigid_bodies[r].drive;
        forces.push_back(k < dim ? drive.force(t)[k] : drive.torque(t)[k - dim]);
      }
    return forces;
  }

  template class FreeBodies<2>;
  template class FreeBodies<3>;
} // namespace Stroma::Fem
