// Grid fields and results of StokesMethod.

#include <stroma/fem/stokes/method.h>
#include <stroma/output/grid_writer.h>

#include <deal.II/base/mpi.h>

#include <array>
#include <cmath>

namespace Stroma::Fem
{
  template <int dim>
  void
  StokesMethod<dim>::collect_scalars(const Vector &unbalanced)
  {
    const auto scope = timers.scope("scalars");
    scalars.clear();
    collect_reactions(unbalanced);
    std::array<double, dim + 1> sums{}; // volume integrals of v, dissipation
    system->for_each_point(flow, system->quadrature(), [&](const auto &, const Point &q) {
      for (unsigned int d = 0; d < dim; ++d)
        sums[d] += q.v[d] * q.JxW;
      sums[dim] += scalar_product(system->viscosity(q.material).stress(q.G), q.G) * q.JxW;
    });
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), dim + 1, MPI_DOUBLE, MPI_SUM, scene.comm);
    const auto box = scene.bounding_box();
    for (unsigned int d = 0; d < dim; ++d)
      scalars.emplace_back(std::string("flow_rate_") + "xyz"[d] + "_m3_per_s", sums[d] / box.side_length(d));
    scalars.emplace_back("max_speed_m_per_s", max_speed());
    scalars.emplace_back("dissipation_W", sums[dim]);
  }

  /// Forces by which supports and rigid bodies hold the fluid; those at a shared node count for the first in the file.
  template <int dim>
  void
  StokesMethod<dim>::collect_reactions(const Vector &unbalanced)
  {
    constexpr unsigned int n = 2 * dim; // of a holder: force, torque
    std::vector<double>    reactions(space->holders.size() * n);
    for (const auto &unknown : space->held)
      {
        const auto &holder = space->holders[unknown.holder];
        const auto  force  = -unbalanced[unknown.dof] * dealii::Point<dim>::unit_vector(unknown.component);
        reactions[unknown.holder * n + unknown.component] += force[unknown.component];
        if (holder.rigid < 0)
          continue;
        const auto torque = Rigid::moment<dim>(unknown.X - scene.rigid_bodies[holder.rigid].pivot, force);
        for (unsigned int k = 0; k < Rigid::n_rotations<dim>; ++k)
          reactions[unknown.holder * n + dim + k] += torque[k];
      }
    dealii::Utilities::MPI::sum(reactions, scene.comm, reactions);
    const auto twists = free_bodies->twists(of_bodies);
    for (unsigned int h = 0; h < space->holders.size(); ++h)
      {
        const auto &holder  = space->holders[h];
        const auto *support = holder.support < 0 ? nullptr : &scene.supports[holder.support];
        // A support of a body bears the load on it.
        const auto load = support && holder.rigid >= 0 ? scene.rigid_bodies[holder.rigid].drive.force(time) :
                                                         dealii::Tensor<1, dim>();
        for (unsigned int c = 0; c < dim; ++c)
          if (!support || support->holds(c))
            scalars.emplace_back("reaction_" + (support ? support->name : holder.name) + "_" + "xyz"[c] + "_N",
                                 reactions[h * n + c] - load[c]);
        if (holder.rigid < 0)
          continue;
        dealii::Tensor<1, dim> force;
        Rigid::Axial<dim>      torque;
        std::copy_n(&reactions[h * n], dim, force.begin_raw());
        std::copy_n(&reactions[h * n + dim], Rigid::n_rotations<dim>, torque.begin_raw());
        for (const auto &scalar : scene.rigid_bodies[holder.rigid].results(rigid[holder.rigid].pose(), force, torque))
          scalars.push_back(scalar);
        for (const auto &scalar : Rigid::velocity_results(scene.rigid_bodies[holder.rigid], twists[holder.rigid]))
          scalars.push_back(scalar);
      }
  }

  /// On a lattice of twice as many points as there are nodes along each axis.
  template <int dim>
  double
  StokesMethod<dim>::max_speed() const
  {
    double     largest = 0.;
    const auto points  = dealii::QIterated<dim>(dealii::QTrapezoid<1>(), 2 * settings.degree);
    system->for_each_point(flow, points,
                           [&](const auto &, const Point &q) { largest = std::max(largest, q.v.norm()); });
    return dealii::Utilities::MPI::max(largest, scene.comm);
  }

  template <int dim>
  std::string
  StokesMethod<dim>::write_grid(const Output::FieldRequest &request)
  {
    if (!request.grid_fields)
      return "";
    const auto means = Output::cell_means(*state(false), {dim, {"von_mises"}}, mesh->triangulation.n_active_cells());
    dealii::Vector<double> material(means.volume.size());
    for (const auto &cell : mesh->triangulation.active_cell_iterators())
      material[cell->active_cell_index()] = cell->material_id();
    Vector v(space->owned_velocity, space->relevant_velocity, scene.comm);
    Vector p(space->owned_pressure, space->relevant_pressure, scene.comm);
    v          = flow.v;
    p          = flow.p;
    auto cells = means.fields();
    cells.push_back({"material", "", &material});
    return Output::write_grid<dim>(request.grid_file("undeformed"), space->velocity_dofs, {{"velocity", "m_per_s", &v}},
                                   cells, {{"pressure", "Pa", &p, &space->pressure_dofs}});
  }

  template <int dim>
  void
  StokesMethod<dim>::describe(Output::Summary &summary)
  {
    summary.method    = "fem";
    summary.dimension = dim;
    summary.n_cells   = mesh->triangulation.n_global_active_cells();
    summary.n_dofs    = space->velocity_dofs.n_dofs() + space->pressure_dofs.n_dofs();

    const auto list = [&](const bool used, const std::string &part) {
      (used ? summary.used : summary.left_out).push_back(part);
    };
    list(true, "Taylor-Hood elements of degrees " + std::to_string(settings.degree) + " and " +
                 std::to_string(settings.degree - 1));
    list(system->has_inertia(), "inertia");
    list(system->is_compressible(), "compressibility");
    list(mesh->triangulation.has_hanging_nodes(), "hanging nodes");
    list(free_level, "mean pressure set to zero");
  }

  template class StokesMethod<2>;
  template class StokesMethod<3>;
} // namespace Stroma::Fem
