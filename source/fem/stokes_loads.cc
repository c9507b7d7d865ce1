// Loads of StokesSystem.

#include <stroma/fem/stokes_system.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Fem
{
  namespace
  {
    /// Force per volume or area of @p load at @p X [N/m^3 or N/m^2], with @p measure of the whole region.
    template <int dim>
    dealii::Tensor<1, dim>
    intensity(const Load<dim> &load, const dealii::Point<dim> &X, const double t, const double measure)
    {
      if (load.density.given())
        return load.density.value(X, t);
      return load.traction.given() ? load.traction.value(X, t) : load.total.value(X, t) / measure;
    }
  } // namespace

  template <int dim>
  void
  StokesSystem<dim>::check_load(const Load<dim> &load) const
  {
    using Kind = typename Region<dim>::Kind;
    if (load.region.kind == Kind::nearest)
      throw UserError(load.where, "load '" + load.name
                                    + "' acts on one point, where a fluid would move without bound; spread it over a ball");
    if (load.region.kind == Kind::body)
      throw UserError(load.where, "load '" + load.name + "' drives a rigid body; in a fluid by finite elements a support "
                                    + "with 'Type = velocity' moves it");
    if (load.region.kind == Kind::side && scene.periodic[load.region.axis])
      throw UserError(load.where, "load '" + load.name + "' acts on " + load.region.text
                                    + ", where the scene repeats; use 'Force density' on 'all'");
  }

  template <int dim>
  template <typename Act>
  void
  StokesSystem<dim>::for_loaded_faces(const Load<dim> &load, const Act &act) const
  {
    const auto                box = scene.bounding_box();
    dealii::FEFaceValues<dim> values(space.mesh.mapping(), space.velocity_element, face_quadrature,
                                     dealii::update_values | dealii::update_JxW_values
                                       | dealii::update_quadrature_points);
    for (const auto &cell : space.velocity_dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int f : cell->face_indices())
        {
          if (!cell->at_boundary(f) || cell->has_periodic_neighbor(f))
            continue;
          bool loaded = true;
          for (const unsigned int v : cell->face(f)->vertex_indices())
            loaded &= load.region.on_boundary(cell->face(f)->vertex(v), box, 1e-6 * cell->diameter());
          if (!loaded)
            continue;
          values.reinit(cell, f);
          act(cell, values);
        }
  }

  template <int dim>
  void
  StokesSystem<dim>::measure_loads()
  {
    load_measure.assign(scene.loads.size(), 0.);
    const StokesFlow rest{ space.new_velocity(), space.new_pressure() };
    for (unsigned int l = 0; l < scene.loads.size(); ++l)
    {
      const auto &load = scene.loads[l];
      check_load(load);
      if (load.region.is_boundary())
        for_loaded_faces(load, [&](const auto &, const dealii::FEFaceValues<dim> &values) {
          for (unsigned int q = 0; q < face_quadrature.size(); ++q)
            load_measure[l] += thickness * values.JxW(q);
        });
      else
      {
        const auto box = scene.bounding_box();
        for_each_point(rest, cell_quadrature, [&](const Iterator &, const Point &point) {
          if (load.region.contains(point.X, point.material, box))
            load_measure[l] += point.JxW;
        });
      }
    }
    dealii::Utilities::MPI::sum(load_measure, scene.comm, load_measure);
    for (unsigned int l = 0; l < scene.loads.size(); ++l)
      if (load_measure[l] == 0.)
        throw UserError(scene.loads[l].where, "load '" + scene.loads[l].name + "' (" + scene.loads[l].region.text
                                                + ") acts on no part of the mesh; enlarge it or move it into the bodies");
  }

  template <int dim>
  void
  StokesSystem<dim>::set_time(const double t)
  {
    external = 0.;
    add_volume_loads(t);
    add_boundary_loads(t);
    external.compress(dealii::VectorOperation::add);
  }

  template <int dim>
  void
  StokesSystem<dim>::add_volume_loads(const double t)
  {
    const auto             box = scene.bounding_box();
    StokesCell<dim>        values(space, cell_quadrature);
    dealii::Vector<double> local(values.v_dofs.size());
    for (const auto &cell : space.mesh.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
      {
        values.reinit(cell, space);
        local = 0.;
        for (unsigned int q = 0; q < cell_quadrature.size(); ++q)
        {
          const auto            &X = values.velocity.quadrature_point(q);
          dealii::Tensor<1, dim> b;
          for (unsigned int l = 0; l < scene.loads.size(); ++l)
            if (!scene.loads[l].region.is_boundary() && scene.loads[l].region.contains(X, material(cell, X), box))
              b += intensity(scene.loads[l], X, t, load_measure[l]);
          for (unsigned int i = 0; i < local.size(); ++i)
            local[i]
              += b[values.component[i]] * values.velocity.shape_value(i, q) * thickness * values.velocity.JxW(q);
        }
        space.tied_velocity.distribute_local_to_global(local, values.v_dofs, external);
      }
  }

  template <int dim>
  void
  StokesSystem<dim>::add_boundary_loads(const double t)
  {
    std::vector<dealii::types::global_dof_index> indices(space.velocity_element.n_dofs_per_cell());
    dealii::Vector<double>                       local(indices.size());
    for (unsigned int l = 0; l < scene.loads.size(); ++l)
      if (scene.loads[l].region.is_boundary())
        for_loaded_faces(scene.loads[l], [&](const auto &cell, const dealii::FEFaceValues<dim> &values) {
          cell->get_dof_indices(indices);
          local = 0.;
          for (unsigned int q = 0; q < face_quadrature.size(); ++q)
          {
            const auto force = intensity(scene.loads[l], values.quadrature_point(q), t, load_measure[l]);
            for (unsigned int i = 0; i < local.size(); ++i)
              local[i] += force[space.velocity_element.system_to_component_index(i).first] * values.shape_value(i, q)
                          * thickness * values.JxW(q);
          }
          space.tied_velocity.distribute_local_to_global(local, indices, external);
        });
  }

  template void StokesSystem<2>::measure_loads();
  template void StokesSystem<3>::measure_loads();
  template void StokesSystem<2>::set_time(double);
  template void StokesSystem<3>::set_time(double);
} // namespace Stroma::Fem
