// Which velocities the scene's supports and rigid bodies hold.

#include <stroma/base/text.h>
#include <stroma/fem/stokes/space.h>
#include <stroma/output/collective.h>
#include <stroma/scene/consistency.h>

#include <deal.II/base/mpi.h>
#include <deal.II/fe/fe_values.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Fem
{
  /// What this rank has found.
  template <int dim>
  struct StokesSpace<dim>::Found
  {
    std::map<dealii::types::global_dof_index, HeldUnknown> unknowns; ///< owned; of several holders, the first
    std::vector<unsigned long long>                        count;    ///< of each holder, on this rank
    std::string                                            contradiction;
    const StokesSpace                                     &space;
    double                                                 end_time;

    void
    hold(const dealii::types::global_dof_index dof, const unsigned int holder, const unsigned int component,
         const dealii::Point<dim> &X)
    {
      if (!space.owned_velocity.is_element(dof) || space.tied_velocity.is_constrained(dof))
        return;
      ++count[holder];
      const HeldUnknown unknown{dof, holder, component, X};
      const auto [known, is_new] = unknowns.emplace(dof, unknown);
      check_rest(unknown);
      if (is_new)
        return;
      const HeldUnknown first = std::min(known->second, unknown), second = std::max(known->second, unknown);
      known->second = first;
      if (first.holder == second.holder) // seen from two cells
        return;
      check_apart(first, second);
      check_apart(second, first);
      check_agreement(first, second);
    }

    /// A support by displacement holds a fluid only at rest.
    void
    check_rest(const HeldUnknown &unknown)
    {
      const Holder &holder = space.holders[unknown.holder];
      if (holder.support < 0 || space.scene.supports[holder.support].velocity.given())
        return;
      const auto &support = space.scene.supports[holder.support];
      bool        moves   = holder.rigid >= 0 && space.scene.rigid_bodies[holder.rigid].drive.moves();
      for (const double t : sample_times(end_time))
        moves |= holder.rigid < 0 && support.displacement.value(unknown.X, t, unknown.component) != 0.;
      if (moves && contradiction.empty())
        contradiction = support.where + ": support '" + support.name +
                        "' displaces a fluid; use 'Type = velocity' with 'Velocity', or 'Type = clamp'";
    }

    /// Where the balance of forces moves a body, another holder would hold it too, and nobody could tell whose the forces are.
    void
    check_apart(const HeldUnknown &of_body, const HeldUnknown &other)
    {
      const Holder &holder = space.holders[of_body.holder];
      if (holder.rigid < 0 || of_body.holder == other.holder || !contradiction.empty())
        return;
      const auto &rigid = space.scene.rigid_bodies[holder.rigid];
      if (Rigid::is_by_balance(rigid.drive.translation[of_body.component]) ||
          Rigid::is_by_balance(rigid.drive.rotation.front()))
        contradiction = rigid.where + ": the balance of forces moves rigid body '" + rigid.name +
                        "', which shares nodes with '" + space.holders[other.holder].name +
                        "' that it would move; leave a cell of fluid between them, or give the body's motion by a " +
                        "support on 'body " + rigid.name + "'";
    }

    void
    check_agreement(const HeldUnknown &a, const HeldUnknown &b)
    {
      for (const double t : sample_times(end_time))
        {
          const double first  = space.velocity_of(space.holders[a.holder], a.X, t)[a.component];
          const double second = space.velocity_of(space.holders[b.holder], b.X, t)[b.component];
          if (contradiction.empty() && std::abs(first - second) > 1e-9 * (std::abs(first) + std::abs(second)))
            {
              const auto &[name, s, r] = space.holders[b.holder];
              contradiction = (s >= 0 ? space.scene.supports[s].where : space.scene.rigid_bodies[r].where) + ": '" +
                              space.holders[a.holder].name + "' and '" + space.holders[b.holder].name +
                              "' contradict each other: at t = " + brief(t) + " s one moves a shared node with " +
                              brief(first) + " m/s along " + "xyz"[a.component] + ", the other with " + brief(second) +
                              " m/s; make them agree or free one of them";
            }
        }
    }
  };

  template <int dim>
  void
  StokesSpace<dim>::list_holders()
  {
    using Kind = typename Region<dim>::Kind;
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      {
        const auto &support = scene.supports[s];
        const auto &region  = support.region;
        if (region.kind == Kind::nearest)
          throw UserError(support.where, "support '" + support.name +
                                           "' holds one point, which a fluid does not feel; hold a side, box or ball");
        if (region.kind != Kind::body)
          holders.push_back({support.name, static_cast<int>(s), -1});
      }
    for (unsigned int r = 0; r < scene.rigid_bodies.size(); ++r)
      holders.push_back({scene.rigid_bodies[r].name, scene.rigid_bodies[r].drive.support, static_cast<int>(r)});
  }

  template <int dim>
  dealii::Tensor<1, dim>
  StokesSpace<dim>::velocity_of(const Holder &holder, const dealii::Point<dim> &X, const double t) const
  {
    if (holder.rigid < 0)
      return scene.supports[holder.support].velocity.given() ? scene.supports[holder.support].velocity.value(X, t) :
                                                               dealii::Tensor<1, dim>();
    const auto       &rigid = scene.rigid_bodies[holder.rigid];
    Rigid::Twist<dim> twist;
    if (rigid.drive.velocity.given())
      twist.velocity = rigid.drive.velocity.value(X, t);
    if (rigid.drive.spin.given())
      twist.angular_velocity = rigid.drive.spin.value(X, t);
    return twist.at(X - rigid.pivot); // the mesh stays where it is
  }

  template <int dim>
  bool
  StokesSpace<dim>::is_held_by(const Cell &cell, const unsigned int face, const Holder &holder) const
  {
    if (holder.rigid >= 0)
      return mesh.body_behind(cell, face) == static_cast<int>(scene.rigid_bodies[holder.rigid].body);
    const auto &region = scene.supports[holder.support].region;
    if (!region.is_boundary())
      return false;
    const auto box = scene.bounding_box();
    for (const unsigned int v : cell->face(face)->vertex_indices())
      if (!region.on_boundary(cell->face(face)->vertex(v), box, 1e-6 * cell->diameter()))
        return false;
    return true;
  }

  template <int dim>
  void
  StokesSpace<dim>::find_on_boundary(const Cell &cell, Found &found) const
  {
    std::vector<dealii::types::global_dof_index> indices(velocity_element.n_dofs_per_face());
    for (const unsigned int face : cell->face_indices())
      if (cell->at_boundary(face) && !cell->has_periodic_neighbor(face))
        for (unsigned int h = 0; h < holders.size(); ++h)
          if (is_held_by(cell, face, holders[h]))
            {
              dealii::FEFaceValues<dim> values(mesh.mapping(), velocity_element,
                                               dealii::Quadrature<dim - 1>(
                                                 velocity_element.get_unit_face_support_points()),
                                               dealii::update_quadrature_points);
              values.reinit(cell, face);
              cell->face(face)->get_dof_indices(indices);
              for (unsigned int i = 0; i < indices.size(); ++i)
                {
                  const unsigned int c = velocity_element.face_system_to_component_index(i).first;
                  if (holders[h].rigid >= 0 || scene.supports[holders[h].support].holds(c))
                    found.hold(indices[i], h, c, values.quadrature_point(i));
                }
            }
  }

  template <int dim>
  void
  StokesSpace<dim>::find_inside(const Cell &cell, Found &found) const
  {
    dealii::FEValues<dim> values(mesh.mapping(), velocity_element, velocity_element.get_unit_support_points(),
                                 dealii::update_quadrature_points);
    values.reinit(cell);
    const auto                                   box       = scene.bounding_box();
    const double                                 tolerance = 1e-6 * cell->minimum_vertex_distance();
    std::vector<dealii::types::global_dof_index> indices(velocity_element.n_dofs_per_cell());
    cell->get_dof_indices(indices);
    for (unsigned int h = 0; h < holders.size(); ++h)
      if (holders[h].rigid < 0)
        {
          const auto &support = scene.supports[holders[h].support];
          for (unsigned int i = 0; i < indices.size(); ++i)
            {
              const unsigned int c = velocity_element.system_to_component_index(i).first;
              for (const auto &X : mesh.images(values.quadrature_point(i), tolerance))
                if (support.holds(c) &&
                    support.region.contains(X, scene.material_at(X).value_or(cell->material_id()), box))
                  found.hold(indices[i], h, c, X);
            }
        }
  }

  template <int dim>
  void
  StokesSpace<dim>::find_held(const double end_time)
  {
    bool any_inside = false;
    for (const auto &holder : holders)
      any_inside |= holder.rigid < 0 && !scene.supports[holder.support].region.is_boundary();
    Found found{{}, std::vector<unsigned long long>(holders.size()), "", *this, end_time};
    for (const auto &cell : velocity_dofs.active_cell_iterators())
      if (!cell->is_artificial())
        {
          find_on_boundary(cell, found);
          if (any_inside)
            find_inside(cell, found);
        }
    Output::throw_if_any(found.contradiction, scene.comm);
    dealii::Utilities::MPI::sum(found.count, scene.comm, found.count);
    for (unsigned int h = 0; h < holders.size(); ++h)
      if (found.count[h] == 0 && holders[h].rigid >= 0)
        throw UserError(scene.rigid_bodies[holders[h].rigid].where,
                        "rigid body '" + holders[h].name + "' takes no cell out of the mesh; use more 'FEM/Cells'");
      else if (found.count[h] == 0)
        throw UserError(scene.supports[holders[h].support].where,
                        "support '" + holders[h].name + "' (" + scene.supports[holders[h].support].region.text +
                          ") holds no node of the mesh; enlarge it or move it into the bodies");
    for (const auto &entry : found.unknowns)
      held.push_back(entry.second);
  }

  template class StokesSpace<2>;
  template class StokesSpace<3>;
} // namespace Stroma::Fem
