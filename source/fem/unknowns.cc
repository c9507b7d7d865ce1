#include <stroma/base/log.h>
#include <stroma/fem/unknowns.h>
#include <stroma/rigid/contact.h>

#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>

#include <limits>

namespace Stroma::Fem
{
  template <int dim>
  Unknowns<dim>::Unknowns(const Scene<dim> &scene, const Settings<dim> &settings, const Mesh<dim> &mesh,
                          const double end_time)
    : fe(dealii::FE_Q<dim>(settings.degree), dim)
    , dofs(mesh.triangulation)
    , inclusions(scene)
    , scene(scene)
    , mesh(mesh)
  {
    dofs.distribute_dofs(fe);
    number_rigid_bodies();
    mesh_ties.reinit(relevant);
    dealii::DoFTools::make_hanging_node_constraints(dofs, mesh_ties);
    mesh.make_periodic(dofs, mesh_ties);
    find_inclusions();
    mesh_ties.close();
    Vector start(owned, scene.comm);
    tie(inclusions.poses(start), ties);
    find_held(end_time);
  }

  template <int dim>
  void
  Unknowns<dim>::number_rigid_bodies()
  {
    owned = dofs.locally_owned_dofs();
    dealii::DoFTools::extract_locally_relevant_dofs(dofs, relevant);
    inclusions.number(owned, relevant);
  }

  template <int dim>
  dealii::types::global_dof_index
  Unknowns<dim>::of_body(const unsigned int b, const unsigned int c) const
  {
    return inclusions.unknown(inclusions.index_of(b), c);
  }

  template <int dim>
  void
  Unknowns<dim>::find_inclusions()
  {
    for (unsigned int r = 0; r < scene.rigid_bodies.size(); ++r)
      {
        const auto &rigid = scene.rigid_bodies[r];
        const auto &body  = scene.bodies[rigid.body];
        if (Rigid::has_contact(scene, rigid.body))
          continue;
        const double       tolerance = 1e-6 * body.bounding_box().side_length(0);
        const auto         on_steps  = nodes_on_steps(rigid.body);
        unsigned long long n = 0, n_outside = 0;
        for_each_node([&](const dealii::Point<dim> &X, const auto &node, const bool outer) {
          const bool outside = body.shape->distance(X) > tolerance;
          if (!outer || (outside && on_steps.count(node[0]) == 0))
            return;
          ++n;
          n_outside += outside;
          for (unsigned int c = 0; c < dim; ++c)
            if (!mesh_ties.is_constrained(node[c]))
              inclusions.add(node[c], c, r, X);
        });
        if (dealii::Utilities::MPI::sum(n, scene.comm) == 0)
          throw UserError(body.where,
                          "rigid body '" + body.name +
                            "' touches no node of the mesh; let it cut a box out of the bodies, or list it in " +
                            "section Contact");
        if (dealii::Utilities::MPI::sum(n_outside, scene.comm) > 0)
          Log::warning(
            body.where + ": rigid body '" + body.name +
            "' cuts cells, and the nodes of those that it takes go with it as if it were about a third of a cell " +
            "larger on each side; its forces are too large by that, so use cells small against it");
      }
    inclusions.close();
  }

  template <int dim>
  std::set<dealii::types::global_dof_index>
  Unknowns<dim>::nodes_on_steps(const unsigned int b) const
  {
    std::set<dealii::types::global_dof_index> nodes;
    if (!mesh.is_cut())
      return nodes;
    std::vector<dealii::types::global_dof_index> face_dofs(fe.n_dofs_per_face());
    for (const auto &cell : dofs.active_cell_iterators())
      if (!cell->is_artificial())
        for (const unsigned int f : cell->face_indices())
          if (cell->face(f)->at_boundary() && mesh.body_behind(cell, f) == static_cast<int>(b))
            {
              cell->face(f)->get_dof_indices(face_dofs);
              for (unsigned int i = 0; i < face_dofs.size(); ++i)
                if (fe.face_system_to_component_index(i).first == 0)
                  nodes.insert(face_dofs[i]);
            }
    return nodes;
  }

  template <int dim>
  void
  Unknowns<dim>::tie(const std::vector<Rigid::Pose<dim>> &poses, dealii::AffineConstraints<double> &all) const
  {
    all.reinit(relevant);
    inclusions.tie(all, poses);
    all.close();
    all.merge(mesh_ties);
    all.close();
  }

  template <int dim>
  void
  Unknowns<dim>::distribute(Vector &u)
  {
    if (scene.rigid_bodies.empty())
      {
        ties.distribute(u);
        return;
      }
    const auto poses = inclusions.poses(u);
    inclusions.place(u, poses);
    u.compress(dealii::VectorOperation::insert);
    mesh_ties.distribute(u);
    if (inclusions.turn())
      tie(poses, ties);
  }

  template <int dim>
  bool
  Unknowns<dim>::hangs(const dealii::types::global_dof_index dof) const
  {
    return mesh_ties.is_constrained(dof) && mesh_ties.get_constraint_entries(dof)->size() != 1;
  }

  template <int dim>
  double
  Unknowns<dim>::prescribed(const HeldUnknown<dim> &unknown, const double t) const
  {
    const unsigned int c = unknown.component;
    if (unknown.rigid < 0)
      return scene.supports[unknown.support].displacement.value(unknown.X, t, c);
    return inclusions.prescribed(unknown.rigid, c, t);
  }

  template <int dim>
  double
  Unknowns<dim>::prescribed_rate(const HeldUnknown<dim> &unknown, const double t, const double h) const
  {
    const double now = prescribed(unknown, t);
    return (4. * (now - prescribed(unknown, t - h)) - (now - prescribed(unknown, t - 2. * h))) / (2. * h);
  }

  template <int dim>
  dealii::Point<dim>
  Unknowns<dim>::nearest_node(const dealii::Point<dim> &place) const
  {
    const double          grain = 1e-6 * mesh.smallest_cell();
    std::array<double, 4> best{{std::numeric_limits<double>::max(), 0, 0, 0}}; // distance in grains, coordinates
    for_each_node([&](const dealii::Point<dim> &X, const auto &node, const bool) {
      std::array<double, 4> candidate{{std::round(X.distance(place) / grain), 0, 0, 0}};
      for (unsigned int d = 0; d < dim; ++d)
        candidate[1 + d] = X[d];
      if (!hangs(node[0]))
        best = std::min(best, candidate);
    });
    const auto all = dealii::Utilities::MPI::all_gather(scene.comm, best);
    best           = *std::min_element(all.begin(), all.end());
    dealii::Point<dim> nearest;
    for (unsigned int d = 0; d < dim; ++d)
      nearest[d] = best[1 + d];
    return nearest;
  }

  template <int dim>
  std::vector<std::vector<SingleUnknown<dim>>>
  Unknowns<dim>::loaded_singly() const
  {
    std::vector<std::vector<SingleUnknown<dim>>> single(scene.loads.size());
    const double                                 tolerance = 1e-6 * mesh.smallest_cell();
    for (unsigned int l = 0; l < single.size(); ++l)
      {
        const auto &region = scene.loads[l].region;
        if (region.kind == Region<dim>::Kind::body && scene.loads[l].total.given())
          for (unsigned int c = 0; c < dim; ++c)
            single[l].push_back({of_body(region.body, c), c, {}}); // the same at all places
        if (region.kind != Region<dim>::Kind::nearest)
          continue;
        const auto nearest = nearest_node(region.first);
        for (const auto &[dof, c, X] : owned_nodes())
          if (X.distance(nearest) < tolerance)
            single[l].push_back({dof, c, X});
      }
    return single;
  }

  template <int dim>
  dealii::AffineConstraints<double>
  Unknowns<dim>::constraints(const std::vector<double> &jump) const
  {
    dealii::AffineConstraints<double> all(relevant);
    for (std::size_t i = 0; i < held.size(); ++i)
      {
        all.add_line(held[i].dof);
        all.set_inhomogeneity(held[i].dof, jump.empty() ? 0. : jump[i]);
      }
    all.close();
    all.merge(ties);
    all.close();
    return all;
  }

  template <int dim>
  dealii::AffineConstraints<double>
  Unknowns<dim>::pattern_constraints() const
  {
    dealii::AffineConstraints<double> all(relevant);
    for (const auto &unknown : held)
      all.add_line(unknown.dof);
    all.close();
    dealii::AffineConstraints<double> full;
    tie({}, full);
    all.merge(full);
    all.close();
    return all;
  }

  template <int dim>
  Vector
  Unknowns<dim>::on_mesh(const Vector &u) const
  {
    dealii::IndexSet mesh_relevant;
    dealii::DoFTools::extract_locally_relevant_dofs(dofs, mesh_relevant);
    Vector part(dofs.locally_owned_dofs(), scene.comm), ghosted(dofs.locally_owned_dofs(), mesh_relevant, scene.comm);
    std::copy_n(u.begin(), part.locally_owned_size(), part.begin()); // the mesh's unknowns come first
    ghosted = part;
    return ghosted;
  }

  template <int dim>
  std::vector<std::uint64_t>
  Unknowns<dim>::names() const
  {
    // A hash of the node's place, rounded to a millionth of the smallest cell, and of the component.
    const double               grain = 1e-6 * mesh.smallest_cell();
    std::vector<std::uint64_t> result(owned.n_elements());
    const auto                 mix = [](std::uint64_t hash, const std::uint64_t value) {
      hash ^= value + 0x9e3779b97f4a7c15ull + (hash << 6) + (hash >> 2);
      hash *= 0xff51afd7ed558ccdull;
      return hash ^ (hash >> 33);
    };
    for_each_node([&](const dealii::Point<dim> &X, const auto &node, const bool) {
      for (unsigned int c = 0; c < dim; ++c)
        if (owned.is_element(node[c]))
          {
            std::uint64_t hash = c;
            for (unsigned int d = 0; d < dim; ++d)
              hash = mix(hash, static_cast<std::uint64_t>(std::llround(X[d] / grain)));
            result[owned.index_within_set(node[c])] = hash;
          }
    });
    for (dealii::types::global_dof_index i = dofs.n_dofs(); i < size(); ++i)
      if (owned.is_element(i))
        result[owned.index_within_set(i)] = i - dofs.n_dofs();
    return result;
  }

  template <int dim>
  std::vector<typename Unknowns<dim>::OwnedNode>
  Unknowns<dim>::owned_nodes() const
  {
    std::vector<OwnedNode> nodes;
    std::vector<bool>      seen(owned.n_elements(), false);
    for_each_node([&](const dealii::Point<dim> &X, const auto &node, const bool) {
      for (unsigned int c = 0; c < dim; ++c)
        if (owned.is_element(node[c]) && !seen[owned.index_within_set(node[c])])
          {
            seen[owned.index_within_set(node[c])] = true;
            nodes.push_back({node[c], c, X});
          }
    });
    return nodes;
  }

  template <int dim>
  std::vector<Vector>
  Unknowns<dim>::rigid_motions() const
  {
    constexpr unsigned int n_modes = dim == 2 ? 3 : 6;
    std::vector<Vector>    modes(n_modes, Vector(owned, scene.comm));
    const auto             centre = scene.bounding_box().center();
    const auto             set    = [&](const dealii::types::global_dof_index dof, const dealii::Tensor<1, dim> &r,
                         const unsigned int c) {
      if (!owned.is_element(dof) || held_place[relevant.index_within_set(dof)] >= 0)
        return;
      modes[c](dof) = 1.;
      if (dim == 2)
        modes[2](dof) = c == 0 ? -r[1] : r[0];
      else
        for (unsigned int axis = 0; axis < 3; ++axis)
          modes[3 + axis](dof) = c == (axis + 1) % 3 ? -r[(axis + 2) % 3] :
                                                c == (axis + 2) % 3 ? r[(axis + 1) % 3] :
                                                                      0.;
    };
    for_each_node([&](const dealii::Point<dim> &X, const auto &node, const bool) {
      for (unsigned int c = 0; c < dim; ++c)
        set(node[c], X - centre, c);
    });
    inclusions.set_motions(modes, centre, 1., [this](const dealii::types::global_dof_index dof) {
      return held_place[relevant.index_within_set(dof)] >= 0;
    });
    for (auto &mode : modes)
      mode.compress(dealii::VectorOperation::insert);
    return modes;
  }

  template class Unknowns<2>;
  template class Unknowns<3>;
} // namespace Stroma::Fem
