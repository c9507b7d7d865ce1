#include <stroma/fem/solid/contact_points.h>

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace Stroma::Fem
{
  namespace
  {
    using Dof = dealii::types::global_dof_index;

    /// The node's place, in millionths of the smallest cell.
    template <int dim>
    std::uint64_t
    name_of_node(const dealii::Point<dim> &X, const double grain)
    {
      std::uint64_t name = 1469598103934665603ull;
      for (unsigned int d = 0; d < dim; ++d)
        name = (name ^ static_cast<std::uint64_t>(std::llround(X[d] / grain))) * 1099511628211ull;
      return name;
    }

    /// Takes the owned nodes of a cell's face that follow no others, by their first unknown.
    template <int dim>
    void
    take_nodes(const Mesh<dim> &mesh, const double grain, const Unknowns<dim> &unknowns,
               const typename dealii::DoFHandler<dim>::active_cell_iterator &cell, const unsigned int face,
               const std::vector<Dof> &dofs, std::map<Dof, Rigid::ContactPoint<dim>> &found)
    {
      const auto &fe = unknowns.fe;
      for (unsigned int a = 0; a < dofs.size(); ++a)
        if (const auto [c, i] = fe.system_to_component_index(a); c == 0 && fe.has_support_on_face(a, face) &&
                                                                 unknowns.owned.is_element(dofs[a]) &&
                                                                 !unknowns.ties.is_constrained(dofs[a]))
          {
            Rigid::ContactPoint<dim> point;
            point.X = mesh.mapping().transform_unit_to_real_cell(cell, fe.base_element(0).get_unit_support_points()[i]);
            point.name = name_of_node<dim>(point.X, grain);
            point.nodes.resize(1);
            point.nodes[0].weight = 1.;
            for (unsigned int d = 0; d < dim; ++d)
              point.nodes[0].dofs[d] = dofs[fe.component_to_system_index(d, i)];
            found.emplace(dofs[a], point);
          }
    }
  } // namespace

  template <int dim>
  std::vector<Rigid::ContactPoint<dim>>
  contact_points(const Scene<dim> &scene, const Settings<dim> &settings, const Mesh<dim> &mesh,
                 const Unknowns<dim> &unknowns)
  {
    const double                            grain = 1e-6 * mesh.smallest_cell(); // collective
    Vector                                  area(unknowns.owned, scene.comm);
    const auto                             &fe = unknowns.fe;
    dealii::FEFaceValues<dim>               values(mesh.mapping(), fe, dealii::QGauss<dim - 1>(settings.degree + 1),
                                                   dealii::update_values | dealii::update_JxW_values);
    dealii::Vector<double>                  w(fe.n_dofs_per_cell());
    std::vector<Dof>                        dofs(fe.n_dofs_per_cell());
    std::map<Dof, Rigid::ContactPoint<dim>> found; // by first unknown
    for (const auto &cell : unknowns.dofs.active_cell_iterators())
      for (const unsigned int f : cell->face_indices())
        if (!cell->is_artificial() && cell->face(f)->at_boundary() && !cell->has_periodic_neighbor(f))
          {
            values.reinit(cell, f);
            cell->get_dof_indices(dofs);
            w = 0.;
            for (unsigned int a = 0; a < w.size(); ++a)
              if (fe.has_support_on_face(a, f))
                for (unsigned int q = 0; q < values.n_quadrature_points; ++q)
                  w(a) += scene.thickness * values.JxW(q) * values.shape_value(a, q);
            if (cell->is_locally_owned())
              unknowns.ties.distribute_local_to_global(w, dofs, area);
            take_nodes(mesh, grain, unknowns, cell, f, dofs, found);
          }
    area.compress(dealii::VectorOperation::add);
    std::vector<Rigid::ContactPoint<dim>> points;
    for (auto &[dof, point] : found)
      {
        const auto  &of_node = point.nodes[0].dofs;
        unsigned int n_held  = 0;
        for (const auto &held : unknowns.held)
          n_held += std::count(of_node.begin(), of_node.end(), held.dof);
        point.area = area(dof);
        if (n_held < dim && point.area > 0)
          points.push_back(point);
      }
    return points;
  }

  template std::vector<Rigid::ContactPoint<2>> contact_points(const Scene<2> &, const Settings<2> &, const Mesh<2> &,
                                                              const Unknowns<2> &);
  template std::vector<Rigid::ContactPoint<3>> contact_points(const Scene<3> &, const Settings<3> &, const Mesh<3> &,
                                                              const Unknowns<3> &);
} // namespace Stroma::Fem
