#pragma once

#include <stroma/fem/stokes/space.h>

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

namespace Stroma::Fem
{
  /// Shape functions and unknowns of one cell of a StokesSpace, at the points of a quadrature.
  template <int dim>
  struct StokesCell
  {
    StokesCell(const StokesSpace<dim> &space, const dealii::Quadrature<dim> &quadrature)
      : velocity(space.mesh.mapping(), space.velocity_element, quadrature,
                 dealii::update_values | dealii::update_gradients | dealii::update_JxW_values |
                   dealii::update_quadrature_points)
      , pressure(space.mesh.mapping(), space.pressure_element, quadrature,
                 dealii::update_values | dealii::update_gradients)
      , v_dofs(space.velocity_element.n_dofs_per_cell())
      , p_dofs(space.pressure_element.n_dofs_per_cell())
      , component(v_dofs.size())
    {
      for (unsigned int i = 0; i < component.size(); ++i)
        component[i] = space.velocity_element.system_to_component_index(i).first;
    }

    void
    reinit(const typename dealii::Triangulation<dim>::active_cell_iterator &cell, const StokesSpace<dim> &space)
    {
      using DofCell = typename dealii::DoFHandler<dim>::active_cell_iterator;
      const DofCell v_cell(&space.mesh.triangulation, cell->level(), cell->index(), &space.velocity_dofs);
      const DofCell p_cell(&space.mesh.triangulation, cell->level(), cell->index(), &space.pressure_dofs);
      velocity.reinit(v_cell);
      pressure.reinit(p_cell);
      v_cell->get_dof_indices(v_dofs);
      p_cell->get_dof_indices(p_dofs);
    }

    dealii::FEValues<dim>                        velocity, pressure;
    std::vector<dealii::types::global_dof_index> v_dofs, p_dofs;
    std::vector<unsigned int>                    component; ///< of each velocity unknown
  };
} // namespace Stroma::Fem
