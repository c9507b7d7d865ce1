// Which displacements supports and rigid bodies hold, and what holds and drives the pieces of the mesh.

#include <stroma/fem/unknowns.h>
#include <stroma/output/collective.h>
#include <stroma/scene/consistency.h>

namespace Stroma::Fem
{
  template <int dim>
  void
  Unknowns<dim>::hold(const HeldUnknown<dim> &unknown, const double end_time, std::string &contradiction)
  {
    int &place = held_place[relevant.index_within_set(unknown.dof)];
    if (place < 0)
      {
        place = held.size();
        held.push_back(unknown);
      }
    else if (contradiction.empty())
      try
        {
          check_agreement(scene, {held[place].support, held[place].X}, {unknown.support, unknown.X}, unknown.component,
                          end_time);
        }
      catch (const UserError &error)
        {
          contradiction = error.what();
        }
  }

  template <int dim>
  void
  Unknowns<dim>::find_held(const double end_time)
  {
    using Kind             = typename Region<dim>::Kind;
    const auto   bodies    = scene.bounding_box();
    const double tolerance = 1e-6 * mesh.smallest_cell();
    held_place.assign(relevant.n_elements(), -1);
    std::vector<dealii::Point<dim>> nearest(scene.supports.size());
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      if (scene.supports[s].region.kind == Kind::nearest)
        nearest[s] = nearest_node(scene.supports[s].region.first);
    std::vector<unsigned long long>    count(scene.supports.size(), 0);
    std::vector<std::array<double, 6>> of_bodies; // at whose surfaces a support is: unknown, support, component, place
    std::string                        contradiction;
    for_each_node([&](const dealii::Point<dim> &X_node, const auto &node, const bool outer) {
      for (unsigned int s = 0; s < scene.supports.size(); ++s)
        for (const auto &X : mesh.images(X_node, tolerance))
          {
            const auto &support = scene.supports[s];
            const auto  kind    = support.region.kind;
            const bool  chosen  = support.region.is_boundary() ?
                                    outer && support.region.on_boundary(X, bodies, tolerance) :
                                  kind == Kind::nearest ?
                                    X.distance(nearest[s]) < tolerance :
                                    support.region.contains(X, scene.material_at(X).value_or(0), bodies);
            if (!chosen)
              continue;
            for (unsigned int c = 0; c < dim; ++c)
              if (support.holds(c))
                {
                  count[s] += !hangs(node[c]);
                  if (!ties.is_constrained(node[c]))
                    hold({node[c], s, c, X, -1}, end_time, contradiction);
                  else if (const int r = inclusions.body_of(node[c]); r >= 0)
                    of_bodies.push_back(
                      {{double(inclusions.unknown(r, c)), double(s), double(c), X[0], X[1], X[dim - 1]}});
                }
          }
    });
    Output::throw_if_any(contradiction, scene.comm);
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      if (scene.supports[s].region.kind != Kind::body && dealii::Utilities::MPI::sum(count[s], scene.comm) == 0)
        throw UserError(scene.supports[s].where, "support '" + scene.supports[s].name + "' (" +
                                                   scene.supports[s].region.text +
                                                   ") holds no node of the mesh; enlarge it or use more 'FEM/Cells'");
    std::vector<HeldUnknown<dim>> at_surfaces;
    for (const auto &[dof, s, c, x, y, z] : Output::gather_all(of_bodies, scene.comm))
      {
        dealii::Point<dim> X;
        X[dim - 1] = z;
        X[0]       = x;
        X[1]       = y;
        at_surfaces.push_back({dealii::types::global_dof_index(dof), unsigned(s), unsigned(c), X, -1});
      }
    hold_bodies(at_surfaces, end_time);
  }

  template <int dim>
  void
  Unknowns<dim>::hold_bodies(const std::vector<HeldUnknown<dim>> &at_surfaces, const double end_time)
  {
    std::string contradiction;
    for (unsigned int r = 0; r < scene.rigid_bodies.size(); ++r)
      {
        const auto        &rigid   = scene.rigid_bodies[r];
        const unsigned int support = rigid.drive.support < 0 ? scene.supports.size() : rigid.drive.support;
        for (unsigned int c = 0; c < inclusions.per_body; ++c)
          if (inclusions.is_prescribed(r, c))
            hold({inclusions.unknown(r, c), support, c, rigid.pivot, static_cast<int>(r)}, end_time, contradiction);
      }
    for (const auto &unknown : at_surfaces)
      {
        const auto &rigid = scene.rigid_bodies[(unknown.dof - dofs.n_dofs()) / inclusions.per_body];
        if (rigid.drive.turns())
          throw UserError(scene.supports[unknown.support].where, "support '" + scene.supports[unknown.support].name +
                                                                   "' reaches the surface of rigid body '" +
                                                                   rigid.name + "', which turns; let it not reach it");
        hold(unknown, end_time, contradiction);
      }
    if (!contradiction.empty())
      throw UserError(contradiction);
  }

  template <int dim>
  void
  Unknowns<dim>::hold(RigidMotions<dim> &motions, const ConnectedParts<dim> &parts) const
  {
    const auto is_held = [&](const dealii::types::global_dof_index dof) {
      return held_place[relevant.index_within_set(dof)] >= 0;
    };
    const auto                                  &nodes = fe.base_element(0).get_unit_support_points();
    std::vector<dealii::types::global_dof_index> cell_dofs(fe.n_dofs_per_cell());
    for (const auto &cell : dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          cell->get_dof_indices(cell_dofs);
          for (unsigned int a = 0; a < cell_dofs.size(); ++a)
            {
              const auto [c, i] = fe.system_to_component_index(a);
              const int r       = inclusions.body_of(cell_dofs[a]);
              if (r < 0 && !is_held(cell_dofs[a]))
                continue;
              const auto X = mesh.mapping().transform_unit_to_real_cell(cell, nodes[i]);
              if (r >= 0)
                motions.join(parts.piece_of(cell), parts.size() + r, X, c);
              else
                motions.hold(parts.piece_of(cell), X, c);
            }
        }
    inclusions.hold(motions, parts.size(), is_held);
  }

  template <int dim>
  void
  Unknowns<dim>::visit_forces(const Vector &force, const ConnectedParts<dim> &parts,
                              const typename FreeParts<dim>::AddForce &add) const
  {
    const auto                                  &nodes = fe.base_element(0).get_unit_support_points();
    std::vector<dealii::types::global_dof_index> cell_dofs(fe.n_dofs_per_cell());
    std::vector<bool>                            seen(owned.n_elements(), false);
    for (const auto &cell : dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          cell->get_dof_indices(cell_dofs);
          for (unsigned int a = 0; a < cell_dofs.size(); ++a)
            if (const auto dof = cell_dofs[a];
                owned.is_element(dof) && force(dof) != 0. && !seen[owned.index_within_set(dof)])
              {
                seen[owned.index_within_set(dof)] = true;
                const auto [c, i]                 = fe.system_to_component_index(a);
                add(parts.piece_of(cell), mesh.mapping().transform_unit_to_real_cell(cell, nodes[i]),
                    force(dof) * dealii::Point<dim>::unit_vector(c));
              }
        }
    for (unsigned int r = 0; r < scene.rigid_bodies.size(); ++r)
      for (unsigned int c = 0; c < dim; ++c)
        if (const auto dof = inclusions.unknown(r, c); owned.is_element(dof))
          add(parts.size() + r, scene.rigid_bodies[r].pivot, force(dof) * dealii::Point<dim>::unit_vector(c));
  }

  template class Unknowns<2>;
  template class Unknowns<3>;
} // namespace Stroma::Fem
