#include <stroma/fem/stokes/space.h>
#include <stroma/fem/stokes/viscosity.h>

#include <deal.II/base/mpi.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_values.h>

#include <Eigen/Eigenvalues>

namespace Stroma::Fem
{
  namespace
  {
    /// Rigid-body motion @p mode at @p X, about @p centre: translations first, then rotations, with |v| = 1 at distance
    /// @p length.
    template <int dim>
    dealii::Tensor<1, dim>
    rigid_motion(const unsigned int mode, const dealii::Point<dim> &X, const dealii::Point<dim> &centre,
                 const double length)
    {
      dealii::Tensor<1, dim> v;
      if (mode < dim)
        {
          v[mode] = 1.;
          return v;
        }
      const auto r = (X - centre) / length;
      if constexpr (dim == 2)
        {
          v[0] = -r[1];
          v[1] = r[0];
        }
      else
        {
          v[(mode + 1) % 3] = -r[(mode + 2) % 3]; // mode - dim is the axis
          v[(mode + 2) % 3] = r[(mode + 1) % 3];
        }
      return v;
    }
  } // namespace

  template <int dim>
  StokesSpace<dim>::StokesSpace(const Mesh<dim> &mesh, const Scene<dim> &scene, const Settings<dim> &settings,
                                const double end_time)
    : mesh(mesh)
    , scene(scene)
    , velocity_element(dealii::FE_Q<dim>(settings.degree), dim)
    , pressure_element(settings.degree - 1)
    , velocity_dofs(mesh.triangulation)
    , pressure_dofs(mesh.triangulation)
  {
    distribute_unknowns();
    list_holders();
    find_held(end_time);
    close_constraints();
  }

  template <int dim>
  void
  StokesSpace<dim>::distribute_unknowns()
  {
    velocity_dofs.distribute_dofs(velocity_element);
    pressure_dofs.distribute_dofs(pressure_element);
    owned_velocity = velocity_dofs.locally_owned_dofs();
    owned_pressure = pressure_dofs.locally_owned_dofs();
    dealii::DoFTools::extract_locally_relevant_dofs(velocity_dofs, relevant_velocity);
    dealii::DoFTools::extract_locally_relevant_dofs(pressure_dofs, relevant_pressure);

    tie(velocity_dofs, relevant_velocity, tied_velocity);
    tied_velocity.close();
    tie(pressure_dofs, relevant_pressure, tied_pressure);
    tied_pressure.close();
  }

  template <int dim>
  void
  StokesSpace<dim>::tie(const dealii::DoFHandler<dim> &dofs, const dealii::IndexSet &relevant,
                        dealii::AffineConstraints<double> &constraints) const
  {
    constraints.reinit(relevant);
    dealii::DoFTools::make_hanging_node_constraints(dofs, constraints);
    mesh.make_periodic(dofs, constraints);
  }

  /// Each rank learns from the owners which unknowns of its neighbours are held.
  template <int dim>
  void
  StokesSpace<dim>::close_constraints()
  {
    Vector mark = new_velocity();
    for (const auto &unknown : held)
      mark[unknown.dof] = 1.;
    mark.compress(dealii::VectorOperation::insert);
    Vector relevant_mark(owned_velocity, relevant_velocity, scene.comm);
    relevant_mark = mark;

    tie(velocity_dofs, relevant_velocity, fixed_velocity);
    for (const auto dof : relevant_velocity)
      if (relevant_mark[dof] > 0.)
        fixed_velocity.add_line(dof);
    fixed_velocity.close();
  }

  template <int dim>
  void
  StokesSpace<dim>::impose(Vector &v, const double t) const
  {
    for (const auto &unknown : held)
      v[unknown.dof] = velocity_of(holders[unknown.holder], unknown.X, t)[unknown.component];
    v.compress(dealii::VectorOperation::insert);
    tied_velocity.distribute(v);
  }

  template <int dim>
  void
  StokesSpace<dim>::impose_rate(Vector &v, const double t, const double factor, const Vector &known,
                                const double h) const
  {
    for (const auto &unknown : held)
      {
        const auto given = [&](const double at) {
          return velocity_of(holders[unknown.holder], unknown.X, at)[unknown.component];
        };
        const double now  = given(t);
        const double rate = (4. * (now - given(t - h)) - (now - given(t - 2. * h))) / (2. * h);
        v[unknown.dof]    = (rate - known[unknown.dof]) / factor;
      }
    v.compress(dealii::VectorOperation::insert);
    tied_velocity.distribute(v);
  }

  template <int dim>
  std::vector<dealii::Point<dim>>
  StokesSpace<dim>::places(const dealii::DoFHandler<dim> &dofs) const
  {
    const auto                     &owned = dofs.locally_owned_dofs();
    std::vector<dealii::Point<dim>> places(owned.n_elements());
    dealii::FEValues<dim>           values(mesh.mapping(), dofs.get_fe(), dofs.get_fe().get_unit_support_points(),
                                           dealii::update_quadrature_points);
    std::vector<dealii::types::global_dof_index> indices(dofs.get_fe().n_dofs_per_cell());
    for (const auto &cell : dofs.active_cell_iterators())
      if (!cell->is_artificial())
        {
          values.reinit(cell);
          cell->get_dof_indices(indices);
          for (unsigned int i = 0; i < indices.size(); ++i)
            if (owned.is_element(indices[i]))
              places[owned.index_within_set(indices[i])] = values.quadrature_point(i);
        }
    return places;
  }

  template <int dim>
  std::vector<unsigned int>
  StokesSpace<dim>::components() const
  {
    std::vector<unsigned int>                    components(owned_velocity.n_elements());
    std::vector<dealii::types::global_dof_index> indices(velocity_element.n_dofs_per_cell());
    for (const auto &cell : velocity_dofs.active_cell_iterators())
      if (!cell->is_artificial())
        {
          cell->get_dof_indices(indices);
          for (unsigned int i = 0; i < indices.size(); ++i)
            if (owned_velocity.is_element(indices[i]))
              components[owned_velocity.index_within_set(indices[i])] = velocity_element.system_to_component_index(i)
                                                                          .first;
        }
    return components;
  }

  template <int dim>
  bool
  StokesSpace<dim>::rotations_are_free(const unsigned int axis) const
  {
    for (unsigned int d = 0; d < dim; ++d)
      if (scene.periodic[d] && d != axis)
        return false;
    for (const auto &medium : scene.media)
      if (!StokesViscosity(medium).is_objective())
        return false;
    return true;
  }

  template <int dim>
  std::vector<Vector>
  StokesSpace<dim>::free_motions() const
  {
    const auto          box    = scene.bounding_box();
    const double        length = box.side_length(0);
    const auto          X      = places(velocity_dofs);
    const auto          c      = components();
    std::vector<Vector> motions;
    for (unsigned int mode = 0; mode < (dim == 2 ? 3 : 6); ++mode)
      if (mode < dim || rotations_are_free(dim == 2 ? 2 : mode - dim))
        {
          motions.push_back(new_velocity());
          for (unsigned int i = 0; i < X.size(); ++i)
            motions.back().begin()[i] = rigid_motion<dim>(mode, X[i], box.center(), length)[c[i]];
          fixed_velocity.set_zero(motions.back());
        }
    return motions;
  }

  template <int dim>
  void
  StokesSpace<dim>::check_determined() const
  {
    // Gram matrix of the free motions seen by what is given: velocities that are held, and of the bodies that the balance of
    // forces moves the components at the pivot.
    const auto                box = scene.bounding_box();
    std::vector<unsigned int> modes;
    for (unsigned int mode = 0; mode < (dim == 2 ? 3 : 6); ++mode)
      if (mode < dim || rotations_are_free(dim == 2 ? 2 : mode - dim))
        modes.push_back(mode);
    Eigen::MatrixXd gram      = Eigen::MatrixXd::Zero(modes.size(), modes.size());
    const auto      add_given = [&](const dealii::Point<dim> &X, const unsigned int component) {
      Eigen::VectorXd row(modes.size());
      for (unsigned int m = 0; m < modes.size(); ++m)
        row(m) = rigid_motion<dim>(modes[m], X, box.center(), box.side_length(0))[component];
      gram += row * row.transpose();
    };
    for (const auto &unknown : held)
      {
        const int rigid = holders[unknown.holder].rigid;
        if (rigid >= 0 && scene.rigid_bodies[rigid].drive.is_by_balance())
          continue; // holds nothing by itself
        add_given(unknown.X, unknown.component);
      }
    MPI_Allreduce(MPI_IN_PLACE, gram.data(), gram.size(), MPI_DOUBLE, MPI_SUM, scene.comm);
    for (const auto &rigid : scene.rigid_bodies)
      if (rigid.drive.is_by_balance())
        {
          for (unsigned int c = 0; c < dim; ++c)
            if (!Rigid::is_by_balance(rigid.drive.translation[c]))
              add_given(rigid.pivot, c);
          for (unsigned int m = 0; m < modes.size(); ++m)
            if (modes[m] >= dim && !Rigid::is_by_balance(rigid.drive.rotation[modes[m] - dim]))
              gram(m, m) += 1.;
        }

    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);
    if (eigen.eigenvalues()(0) > 1e-10 * std::max(1., eigen.eigenvalues()(modes.size() - 1)))
      return;
    Eigen::Index most;
    eigen.eigenvectors().col(0).cwiseAbs().maxCoeff(&most);
    const unsigned int mode   = modes[most];
    const std::string  motion = mode < dim ? std::string("along ") + "xyz"[mode] :
                                dim == 2   ? std::string("of a rotation in the plane") :
                                             std::string("of a rotation about ") + "xyz"[mode - dim];
    throw UserError(scene.bodies.front().where, "nothing determines the fluid's velocity " + motion +
                                                  "; hold a side or a rigid body there, or set 'FEM/Inertia = true'");
  }

  template class StokesSpace<2>;
  template class StokesSpace<3>;
} // namespace Stroma::Fem
