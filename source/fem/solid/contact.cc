#include <stroma/fem/solid/contact.h>
#include <stroma/output/collective.h>
#include <stroma/output/named_rows.h>
#include <stroma/shapes/path.h>

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/lac/trilinos_sparsity_pattern.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace Stroma::Fem
{
  namespace
  {
    constexpr unsigned int max_changes = 4; ///< after these a node stays active for the step
    /// What may be missing of the contact force, and of a step's motion where nodes meet the body: the tolerance, a length,
    /// can be more than all there is.
    constexpr double largest_part_missing = 1e-4;
  } // namespace

  template <int dim>
  RigidContact<dim>::RigidContact(const Scene<dim> &scene, const Contact &contact, const Settings<dim> &settings,
                                  const Mesh<dim> &mesh, const Unknowns<dim> &unknowns)
    : scene(scene)
    , contact(contact)
    , unknowns(unknowns)
    , shape(*scene.bodies[contact.body].shape)
    , pivot(scene.rigid_bodies[unknowns.rigid_index(contact.body)].pivot)
    , arm(unknowns.inclusions.length(unknowns.rigid_index(contact.body)))
    , cell_size(mesh.smallest_cell())
    , penalty(settings.contact_penalty)
    , tolerance(settings.contact_tolerance * cell_size)
    , law(shape, contact.type, tolerance)
  {
    const auto box = shape.bounding_box();
    for (unsigned int d = 0; d < dim; ++d)
      half_width = std::max(half_width, .5 * box.side_length(d));
    set_stage(0.);
    for (unsigned int c = 0; c < dim; ++c)
      driven_by_force |= std::none_of(unknowns.held.begin(), unknowns.held.end(),
                                      [&](const auto &held) { return held.dof == unknowns.of_body(contact.body, c); });
    find_nodes(settings, mesh);
    double deepest = 0;
    for (const auto &node : nodes)
      deepest = std::max(deepest, -shape.distance(node.X));
    if (dealii::Utilities::MPI::max(deepest, scene.comm) > cell_size * 1e-3)
      throw UserError(scene.bodies[contact.body].where, "rigid body '" + scene.bodies[contact.body].name +
                                                          "' lies inside the material at the start; move it out");
  }

  template <int dim>
  void
  RigidContact<dim>::set_stage(const double v_factor)
  {
    double modulus = 0; // of the P-wave, K + 4/3 G, and 3 mu of the central viscosity
    for (unsigned int m = 0; m < scene.materials.size(); ++m)
      modulus = std::max(modulus, scene.materials[m]->p_wave_modulus() + 3. * scene.media[m].viscosity * v_factor);
    eps              = penalty * modulus / cell_size;
    spring_stiffness = modulus * (dim == 2 ? scene.thickness : cell_size);
  }

  template <int dim>
  void
  RigidContact<dim>::find_nodes(const Settings<dim> &settings, const Mesh<dim> &mesh)
  {
    Vector                    area(unknowns.owned, scene.comm);
    const auto               &fe = unknowns.fe;
    dealii::FEFaceValues<dim> values(mesh.mapping(), fe, dealii::QGauss<dim - 1>(settings.degree + 1),
                                     dealii::update_values | dealii::update_JxW_values);
    dealii::Vector<double>    w(fe.n_dofs_per_cell());
    std::vector<dealii::types::global_dof_index>    dofs(fe.n_dofs_per_cell());
    std::map<dealii::types::global_dof_index, Node> found; // by first unknown
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
            for (unsigned int a = 0; a < w.size(); ++a)
              if (const auto [c, i] = fe.system_to_component_index(a); c == 0 && fe.has_support_on_face(a, f) &&
                                                                       unknowns.owned.is_element(dofs[a]) &&
                                                                       !unknowns.ties.is_constrained(dofs[a]))
                {
                  Node node;
                  node.X = mesh.mapping().transform_unit_to_real_cell(cell,
                                                                      fe.base_element(0).get_unit_support_points()[i]);
                  for (unsigned int d = 0; d < dim; ++d)
                    node.dofs[d] = dofs[fe.component_to_system_index(d, i)];
                  found.emplace(dofs[a], node);
                }
          }
    area.compress(dealii::VectorOperation::add);
    for (auto &[dof, node] : found)
      {
        unsigned int n_held = 0;
        for (const auto &held : unknowns.held)
          n_held += std::count(node.dofs.begin(), node.dofs.end(), held.dof);
        node.area = area(dof);
        if (n_held < dim && node.area > 0)
          nodes.push_back(node);
      }
  }

  template <int dim>
  void
  RigidContact<dim>::start_step(const Vector &u)
  {
    start = u;
    for (auto &node : nodes)
      node.state.changes = node.state.turns = 0;
    saved_nodes  = nodes;
    spring_place = translation(u);
    has_spring   = driven_by_force;
  }

  template <int dim>
  void
  RigidContact<dim>::restore()
  {
    nodes = saved_nodes;
  }

  template <int dim>
  typename RigidContact<dim>::Vec
  RigidContact<dim>::translation(const Vector &u) const
  {
    Vec U;
    for (unsigned int c = 0; c < dim; ++c)
      U[c] = u(unknowns.of_body(contact.body, c));
    return U;
  }

  template <int dim>
  dealii::Point<dim>
  RigidContact<dim>::place(const Node &node, const Vector &u) const
  {
    dealii::Point<dim> x = node.X - translation(u);
    for (unsigned int c = 0; c < dim; ++c)
      x[c] += u(node.dofs[c]);
    return x;
  }

  template <int dim>
  bool
  RigidContact<dim>::approach(Vector &u, const Vector &external)
  {
    int any = 0;
    for (const auto &node : nodes)
      any |= node.state.active;
    if (!driven_by_force || dealii::Utilities::MPI::max(any, scene.comm))
      return true;
    // Direction of the force on the free components, known to the rank that owns them.
    Vec force;
    for (unsigned int c = 0; c < dim; ++c)
      {
        const auto dof  = unknowns.of_body(contact.body, c);
        const bool held = std::any_of(unknowns.held.begin(), unknowns.held.end(),
                                      [dof](const auto &h) { return h.dof == dof; });
        force[c]        = !held && unknowns.owned.is_element(dof) ? external(dof) : 0.;
      }
    force = dealii::Utilities::MPI::sum(force, scene.comm);
    if (force.norm() == 0.)
      return true; // nothing moves it
    const Vec e        = force / force.norm();
    double    distance = std::numeric_limits<double>::max();
    for (const auto &node : nodes)
      {
        const auto   x   = place(node, start);
        const double far = std::min(distance, x.distance(shape.bounding_box().center()) + 2. * dim * half_width);
        if (const auto s = Shapes::first_meeting(shape, x, dealii::Point<dim>(x - far * e)))
          distance = std::min(distance, *s * far);
      }
    distance = dealii::Utilities::MPI::min(distance, scene.comm);
    if (distance == std::numeric_limits<double>::max())
      return false;
    for (unsigned int c = 0; c < dim; ++c)
      {
        const auto dof = unknowns.of_body(contact.body, c);
        if (unknowns.owned.is_element(dof))
          u(dof) += distance * e[c];
        spring_place[c] += distance * e[c];
      }
    u.compress(dealii::VectorOperation::add);
    for (auto &node : nodes)
      if (const auto x = place(node, start); shape.distance(x - distance * e) <= 1e-9 * half_width)
        law.enter(node.state, x, dealii::Point<dim>(x - (distance + tolerance) * e));
    return true;
  }

  template <int dim>
  double
  RigidContact<dim>::summed_force(const Vector &u) const
  {
    const double U       = translation(u).norm();
    double       squares = 0;
    for (const auto &node : nodes)
      if (node.state.active)
        squares += std::pow(node.area * (eps * (half_width + U) + node.state.multiplier.norm()), 2);
    return 4. * std::sqrt(dealii::Utilities::MPI::sum(squares, scene.comm));
  }

  template <int dim>
  void
  RigidContact<dim>::add_force(Vector &r, const Vector &u) const
  {
    for (const auto &node : nodes)
      if (node.state.active)
        {
          const auto x      = place(node, u);
          const Vec  force  = node.area * law.traction(node.state, x, eps);
          const auto torque = Rigid::moment<dim>(x - pivot,
                                                 -force); // the body does not turn: arms are those of its frame
          for (unsigned int c = 0; c < dim; ++c)
            {
              r(node.dofs[c]) += force[c];
              r(unknowns.of_body(contact.body, c)) += -force[c];
            }
          for (unsigned int k = 0; k < Rigid::n_rotations<dim>; ++k)
            r(unknowns.of_body(contact.body, dim + k)) += torque[k] / arm;
        }
    if (has_spring)
      for (unsigned int c = 0; c < dim; ++c)
        if (const auto dof = unknowns.of_body(contact.body, c); unknowns.owned.is_element(dof))
          r(dof) += -spring_stiffness * (translation(u)[c] - spring_place[c]);
  }

  template <int dim>
  void
  RigidContact<dim>::add_stiffness(Matrix &K, Vector &r, const Vector &u,
                                   const dealii::AffineConstraints<double> &constraints) const
  {
    dealii::FullMatrix<double>                   k(2 * dim);
    dealii::Vector<double>                       zero(2 * dim);
    std::vector<dealii::types::global_dof_index> dofs(2 * dim);
    for (const auto &node : nodes)
      if (node.state.active)
        {
          const auto a = node.area * law.stiffness(node.state, place(node, u), eps);
          for (unsigned int i = 0; i < dim; ++i)
            {
              dofs[i]       = node.dofs[i];
              dofs[dim + i] = unknowns.of_body(contact.body, i);
              for (unsigned int j = 0; j < dim; ++j)
                {
                  k(i, j) = k(dim + i, dim + j) = a[i][j];
                  k(dim + i, j) = k(i, dim + j) = -a[i][j];
                }
            }
          constraints.distribute_local_to_global(k, zero, dofs, K, r, true);
        }
    if (has_spring)
      for (unsigned int c = 0; c < dim; ++c)
        if (const auto dof = unknowns.of_body(contact.body, c);
            unknowns.owned.is_element(dof) && !constraints.is_constrained(dof))
          K.add(dof, dof, spring_stiffness);
  }

  template <int dim>
  template <typename Pattern>
  void
  RigidContact<dim>::add_pattern(Pattern &pattern, const dealii::AffineConstraints<double> &constraints) const
  {
    std::vector<dealii::types::global_dof_index> dofs(2 * dim);
    for (const auto &node : nodes)
      {
        for (unsigned int i = 0; i < dim; ++i)
          {
            dofs[i]       = node.dofs[i];
            dofs[dim + i] = unknowns.of_body(contact.body, i);
          }
        constraints.add_entries_local_to_global(dofs, pattern, false);
      }
  }

  template <int dim>
  bool
  RigidContact<dim>::update(const Vector &u)
  {
    int    changed   = 0;
    double violation = 0, motion = 0, missing = 0, total = 0;
    for (const auto &node : nodes)
      motion = std::max(motion, place(node, u).distance(place(node, start)));
    motion              = dealii::Utilities::MPI::max(motion, scene.comm);
    const double inside = 1e-3 * std::min(tolerance, largest_part_missing * motion);
    for (auto &node : nodes)
      {
        auto      &state = node.state;
        const auto x     = place(node, u);
        if (!state.active && shape.distance(x) >= -inside)
          continue;
        const bool may_change = !state.active || state.changes < max_changes;
        const Vec  T          = state.active ? law.traction(state, x, eps) : Vec();
        if (!state.active)
          law.enter(state, place(node, start), x);
        else if (may_change && law.leaves(state, x, eps))
          state.active = false;
        else if (!law.follow(state, x, eps) && may_change)
          state.active = false;
        else
          {
            const double left = law.violation(state, x);
            violation         = std::max(violation, left);
            missing += node.area * eps * left;
            total += node.area * T.norm();
            continue;
          }
        ++state.changes;
        changed = 1;
      }
    changed              = dealii::Utilities::MPI::max(changed, scene.comm);
    violation            = dealii::Utilities::MPI::max(violation, scene.comm);
    missing              = dealii::Utilities::MPI::sum(missing, scene.comm);
    total                = dealii::Utilities::MPI::sum(total, scene.comm);
    const Vec    U       = translation(u);
    const double carried = has_spring ? (U - spring_place).norm() : 0.; // by the spring
    const bool   pulled  = carried > tolerance || spring_stiffness * carried > largest_part_missing * total;
    spring_place         = U;
    int any              = 0;
    for (const auto &node : nodes)
      any |= node.state.active;
    any        = dealii::Utilities::MPI::max(any, scene.comm);
    has_spring = driven_by_force && (changed || !any);
    return changed || violation > tolerance || missing > largest_part_missing * total || (pulled && any);
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  RigidContact<dim>::scalars(const Vector &u, const Vector &balanced) const
  {
    Vec                                total;
    double                             area = 0;
    std::vector<std::array<double, 2>> profile; // place along the surface, pressure
    for (const auto &node : nodes)
      if (node.state.active)
        {
          const auto x = place(node, balanced);
          total -= node.area * law.traction(node.state, x, eps);
          area += node.area;
          profile.push_back({{x[0], law.pressure(node.state, x, eps)}});
        }
    total    = dealii::Utilities::MPI::sum(total, scene.comm);
    area     = dealii::Utilities::MPI::sum(area, scene.comm);
    auto all = Output::gather_all(profile, scene.comm);
    std::sort(all.begin(), all.end());
    double peak = 0;
    for (const auto &entry : all)
      peak = std::max(peak, entry[1]);
    const std::string                          &name = scene.bodies[contact.body].name;
    std::vector<std::pair<std::string, double>> result;
    for (unsigned int c = 0; c < dim; ++c)
      {
        result.emplace_back("displacement_" + name + "_" + "xyz"[c] + "_m", translation(u)[c]);
        result.emplace_back("contact_force_" + name + "_" + "xyz"[c] + "_N", total[c]);
      }
    result.emplace_back("contact_pressure_max_" + name + "_Pa", peak);
    result.emplace_back("contact_area_" + name + "_m2", area);
    if (dim == 2)
      {
        // Near its edges p^2 falls linearly (Hertz): the place of its zero beyond the last two nodes.
        const auto edge = [](const std::array<double, 2> &inner, const std::array<double, 2> &outer) {
          const double fall   = inner[1] * inner[1] - outer[1] * outer[1];
          const double beyond = fall > 0 ? std::min(1., outer[1] * outer[1] / fall) : 1.;
          return outer[0] + beyond * (outer[0] - inner[0]);
        };
        const std::size_t n = all.size();
        result.emplace_back("contact_half_width_" + name + "_m",
                            n < 2 ? 0. : .5 * (edge(all[n - 2], all[n - 1]) - edge(all[1], all[0])));
      }
    return result;
  }

  template <int dim>
  std::uint64_t
  RigidContact<dim>::name_of(const Node &node) const
  {
    std::uint64_t name = 1469598103934665603ull;
    for (unsigned int d = 0; d < dim; ++d)
      name = (name ^ static_cast<std::uint64_t>(std::llround(node.X[d] / (1e-9 * half_width)))) * 1099511628211ull;
    return name;
  }

  template <int dim>
  void
  RigidContact<dim>::save(Output::ArchiveWriter &archive) const
  {
    std::vector<std::uint64_t> names;
    std::vector<double>        values;
    for (const auto &node : nodes)
      if (node.state.active)
        {
          names.push_back(name_of(node));
          values.resize(values.size() + State::n_values);
          node.state.save(&values[values.size() - State::n_values]);
        }
    archive.write("contact_" + contact.name + "_nodes", dealii::make_array_view(names));
    archive.write("contact_" + contact.name, dealii::make_array_view(values));
  }

  template <int dim>
  void
  RigidContact<dim>::load(const Output::ArchiveReader &archive)
  {
    std::vector<std::uint64_t> wanted;
    for (const auto &node : nodes)
      wanted.push_back(name_of(node));
    const Output::NamedRows rows(archive, "contact_" + contact.name + "_nodes", wanted, scene.comm);
    const auto              values = rows.read("contact_" + contact.name, State::n_values);
    const double           *next   = values.data();
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (rows.counts()[i] > 0)
        {
          nodes[i].state.load(next);
          next += State::n_values * rows.counts()[i];
        }
  }

  template class RigidContact<2>;
  template class RigidContact<3>;
  template void RigidContact<2>::add_pattern(dealii::TrilinosWrappers::SparsityPattern &,
                                             const dealii::AffineConstraints<double> &) const;
  template void RigidContact<3>::add_pattern(dealii::TrilinosWrappers::SparsityPattern &,
                                             const dealii::AffineConstraints<double> &) const;
} // namespace Stroma::Fem
