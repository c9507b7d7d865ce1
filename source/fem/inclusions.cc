#include <stroma/fem/inclusions.h>
#include <stroma/output/collective.h>

#include <deal.II/base/mpi.h>

#include <Eigen/Dense>

#include <algorithm>
#include <tuple>

namespace Stroma::Fem
{
  using Rigid::n_rotations;

  template <int dim>
  Inclusions<dim>::Inclusions(const Scene<dim> &scene)
    : scene(scene)
  {
    for (const auto &rigid : scene.rigid_bodies)
      {
        const auto corners = scene.bodies[rigid.body].bounding_box().get_boundary_points();
        lengths.push_back(.5 * corners.first.distance(corners.second));
      }
  }

  template <int dim>
  void
  Inclusions<dim>::number(const Dof first_unknown)
  {
    first = first_unknown;
  }

  template <int dim>
  void
  Inclusions<dim>::add(const Dof dof, const unsigned int c, const unsigned int r, const dealii::Point<dim> &X)
  {
    nodes.push_back({dof, c, r, X});
  }

  template <int dim>
  void
  Inclusions<dim>::close()
  {
    std::sort(nodes.begin(), nodes.end(),
              [](const Node &a, const Node &b) { return std::tie(a.dof, a.body) < std::tie(b.dof, b.body); });
    std::string contradiction;
    for (std::size_t k = 1; k < nodes.size() && contradiction.empty(); ++k)
      if (const auto &a = scene.rigid_bodies[nodes[k - 1].body], &b = scene.rigid_bodies[nodes[k].body];
          nodes[k].dof == nodes[k - 1].dof && a.body != b.body && (a.drive.moves() || b.drive.moves()))
        contradiction = UserError(b.where, "rigid bodies '" + a.name + "' and '" + b.name +
                                             "' touch each other, and not " +
                                             "both are at rest; leave material between them, or draw them as one body")
                          .what();
    Output::throw_if_any(contradiction, scene.comm);
    const auto same = [](const Node &a, const Node &b) { return a.dof == b.dof; }; // the first body's in the file
    nodes.erase(std::unique(nodes.begin(), nodes.end(), same), nodes.end());
  }

  template <int dim>
  int
  Inclusions<dim>::body_of(const Dof dof) const
  {
    const auto place = std::lower_bound(nodes.begin(), nodes.end(), dof,
                                        [](const Node &node, const Dof wanted) { return node.dof < wanted; });
    return place != nodes.end() && place->dof == dof ? static_cast<int>(place->body) : -1;
  }

  template <int dim>
  bool
  Inclusions<dim>::turn() const
  {
    return std::any_of(scene.rigid_bodies.begin(), scene.rigid_bodies.end(),
                       [](const auto &rigid) { return rigid.drive.turns(); });
  }

  template <int dim>
  std::vector<Rigid::Pose<dim>>
  Inclusions<dim>::poses(const Vector &u) const
  {
    std::vector<double> values(size(), 0.);
    for (Dof i = 0; i < size(); ++i)
      if (u.has_ghost_elements() || u.in_local_range(first + i))
        values[i] = u(first + i);
    if (!u.has_ghost_elements())
      dealii::Utilities::MPI::sum(values, scene.comm, values);
    std::vector<Rigid::Pose<dim>> poses(scene.rigid_bodies.size());
    for (unsigned int r = 0; r < poses.size(); ++r)
      {
        poses[r].pivot = scene.rigid_bodies[r].pivot;
        for (unsigned int c = 0; c < dim; ++c)
          poses[r].translation[c] = values[r * per_body + c];
        for (unsigned int k = 0; k < n_rotations<dim>; ++k)
          poses[r].rotation[k] = values[r * per_body + dim + k] / lengths[r];
      }
    return poses;
  }

  template <int dim>
  void
  Inclusions<dim>::place(Vector &u, const std::vector<Rigid::Pose<dim>> &poses) const
  {
    for (const auto &node : nodes)
      if (u.in_local_range(node.dof))
        u(node.dof) = poses[node.body].displacement(node.X)[node.component];
  }

  template <int dim>
  std::array<Rigid::Axial<dim>, n_rotations<dim>>
  Inclusions<dim>::axes(const Rigid::Axial<dim> &theta) const
  {
    std::array<Rigid::Axial<dim>, n_rotations<dim>> columns;
    for (unsigned int k = 0; k < n_rotations<dim>; ++k)
      {
        Rigid::Axial<dim> axis;
        axis[k]    = 1.;
        columns[k] = Rigid::angular_velocity<dim>(theta, axis);
      }
    return columns;
  }

  template <int dim>
  void
  Inclusions<dim>::tie(dealii::AffineConstraints<double> &ties, const std::vector<Rigid::Pose<dim>> &poses) const
  {
    for (const auto &[dof, c, r, X] : nodes)
      {
        ties.add_line(dof);
        ties.add_entry(dof, unknown(r, c), 1.);
        if (!scene.rigid_bodies[r].drive.turns())
          continue;
        const auto columns = axes(poses.empty() ? Rigid::Axial<dim>() : poses[r].rotation);
        for (unsigned int k = 0; k < n_rotations<dim>; ++k)
          ties.add_entry(dof, unknown(r, dim + k),
                         poses.empty() ? 1. : Rigid::cross<dim>(columns[k], poses[r].arm(X))[c] / lengths[r]);
      }
  }

  template <int dim>
  std::vector<dealii::Tensor<2, dim>>
  Inclusions<dim>::condense(Vector &force, const std::vector<Rigid::Pose<dim>> &poses) const
  {
    constexpr unsigned int n = dim + dim * dim; // of a body: sum of forces, virial
    std::vector<double>    sums(n * poses.size(), 0.);
    for (const auto &[dof, c, r, X] : nodes)
      if (force.in_local_range(dof))
        {
          const double f = force(dof);
          sums[n * r + c] += f;
          for (unsigned int d = 0; d < dim; ++d)
            sums[n * r + dim + dim * c + d] += f * (X - poses[r].pivot)[d];
          force(dof) = 0.;
        }
    dealii::Utilities::MPI::sum(sums, scene.comm, sums);
    std::vector<dealii::Tensor<2, dim>> virials(poses.size());
    const auto                          add = [&](const Dof dof, const double f) {
      if (force.in_local_range(dof))
        force(dof) = force(dof) + f;
    };
    for (unsigned int r = 0; r < poses.size(); ++r)
      {
        for (unsigned int c = 0; c < dim; ++c)
          {
            add(unknown(r, c), sums[n * r + c]);
            for (unsigned int d = 0; d < dim; ++d)
              virials[r][c][d] = sums[n * r + dim + dim * c + d];
          }
        const auto turning = conjugate(r, poses[r].rotation, virials[r], {});
        for (unsigned int k = 0; k < n_rotations<dim>; ++k)
          add(unknown(r, dim + k), turning[k]);
      }
    force.compress(dealii::VectorOperation::insert);
    return virials;
  }

  template <int dim>
  Rigid::Axial<dim>
  Inclusions<dim>::conjugate(const unsigned int r, const Rigid::Axial<dim> &theta, const dealii::Tensor<2, dim> &virial,
                             const Rigid::Axial<dim> &torque) const
  {
    const auto        columns = axes(theta);
    const auto        R       = transpose(Rigid::rotation_matrix<dim>(theta)); // its columns as rows
    const auto        M       = transpose(virial);
    Rigid::Axial<dim> forces;
    for (unsigned int k = 0; k < n_rotations<dim>; ++k)
      {
        double work = columns[k] * torque;
        for (unsigned int d = 0; d < dim; ++d)
          work += M[d] * Rigid::cross<dim>(columns[k], R[d]);
        forces[k] = work / lengths[r];
      }
    return forces;
  }

  template <int dim>
  Rigid::Axial<dim>
  Inclusions<dim>::torque(const unsigned int r, const Rigid::Axial<dim> &theta, const Rigid::Axial<dim> &forces) const
  {
    constexpr unsigned int      n       = n_rotations<dim>;
    const auto                  columns = axes(theta);
    Eigen::Matrix<double, n, n> J_transposed;
    Eigen::Matrix<double, n, 1> conjugate;
    for (unsigned int k = 0; k < n; ++k)
      {
        conjugate(k) = forces[k] * lengths[r];
        for (unsigned int i = 0; i < n; ++i)
          J_transposed(k, i) = columns[k][i];
      }
    const Eigen::Matrix<double, n, 1> solved = J_transposed.partialPivLu().solve(conjugate);
    Rigid::Axial<dim>                 torque;
    for (unsigned int k = 0; k < n; ++k)
      torque[k] = solved(k);
    return torque;
  }

  template class Inclusions<2>;
  template class Inclusions<3>;
} // namespace Stroma::Fem
