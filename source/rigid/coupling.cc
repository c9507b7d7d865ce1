#include <stroma/rigid/coupling.h>

#include <deal.II/lac/full_matrix.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Rigid
{
  template <int dim>
  dealii::Tensor<1, dim>
  CarriedPoint<dim>::displacement(const Vector &u) const
  {
    dealii::Tensor<1, dim> sum;
    for (const auto &node : nodes)
      for (unsigned int c = 0; c < dim; ++c)
        sum[c] += node.weight * u(node.dofs[c]);
    return sum;
  }

  template <int dim>
  double
  CarriedPoint<dim>::largest(const Vector &u) const
  {
    double result = 0.;
    for (const auto &node : nodes)
      for (unsigned int c = 0; c < dim; ++c)
        result = std::max(result, std::abs(u(node.dofs[c])));
    return result;
  }

  template <int dim>
  Coupling<dim>::Coupling(const Scene<dim> &scene, const Unknowns<dim> &unknowns, const unsigned int r)
    : unknowns(unknowns)
    , body(r)
    , turns(scene.rigid_bodies[r].drive.turns())
  {
    Pose<dim> start;
    start.pivot = scene.rigid_bodies[r].pivot;
    now         = unknowns.frame(r, start);
  }

  template <int dim>
  void
  Coupling<dim>::set_pose(const Vector &u)
  {
    now = unknowns.frame(body, unknowns.poses(u)[body]);
  }

  template <int dim>
  void
  Coupling<dim>::turn(const Axial<dim> &change)
  {
    auto pose = now.pose;
    pose.rotation += change;
    now = unknowns.frame(body, pose);
  }

  template <int dim>
  void
  Coupling<dim>::add_force(Vector &r, const CarriedPoint<dim> &point, const dealii::Point<dim> &x, const Vec &f) const
  {
    const Vec in_space = now.R * f, arm = now.R * (x - now.pose.pivot);
    for (unsigned int c = 0; c < dim; ++c)
      {
        for (const auto &node : point.nodes)
          r(node.dofs[c]) += node.weight * in_space[c];
        r(unknowns.unknown(body, c)) += -in_space[c];
      }
    for (unsigned int k = 0; k < n_rotations<dim>; ++k)
      r(unknowns.unknown(body, dim + k)) += (now.dR[k] * f) * arm;
  }

  /// Those of the point's nodes, U and, where the body may turn, l theta.
  template <int dim>
  std::vector<dealii::types::global_dof_index>
  Coupling<dim>::dofs(const CarriedPoint<dim> &point) const
  {
    std::vector<dealii::types::global_dof_index> all;
    for (const auto &node : point.nodes)
      all.insert(all.end(), node.dofs.begin(), node.dofs.end());
    for (unsigned int c = 0; c < dim + (turns ? n_rotations<dim> : 0); ++c)
      all.push_back(unknowns.unknown(body, c));
    return all;
  }

  template <int dim>
  void
  Coupling<dim>::add_tangent(Matrix &K, Vector &r, const Solvers::Constraints &constraints,
                             const CarriedPoint<dim> &point, const dealii::Point<dim> &x, const Vec &f,
                             const dealii::Tensor<2, dim> &S) const
  {
    const auto         all     = dofs(point);
    const unsigned int n_nodes = point.nodes.size(), theta = dim * (n_nodes + 1);
    const auto         weight = [&](const unsigned int a) { return a < n_nodes ? point.nodes[a].weight : -1.; };
    const Vec          arm    = now.R * (x - now.pose.pivot);
    std::vector<Vec>   B(all.size()); // dx'/dq
    for (unsigned int i = 0; i < theta; ++i)
      for (unsigned int d = 0; d < dim; ++d)
        B[i][d] = weight(i / dim) * now.R[i % dim][d];
    for (unsigned int k = 0; theta + k < all.size(); ++k)
      B[theta + k] = transpose(now.dR[k]) * arm;
    dealii::FullMatrix<double> k(all.size());
    for (unsigned int j = 0; j < all.size(); ++j)
      {
        const Vec SB = S * B[j];
        for (unsigned int i = 0; i < all.size(); ++i)
          k(i, j) = B[i] * SB;
      }
    for (unsigned int l = 0; theta + l < all.size(); ++l) // f . d2x'/dq dq
      {
        const Vec turned = now.dR[l] * f;
        for (unsigned int i = 0; i < theta; ++i)
          {
            k(i, theta + l) -= weight(i / dim) * turned[i % dim];
            k(theta + l, i) -= weight(i / dim) * turned[i % dim];
          }
        for (unsigned int m = 0; theta + m < all.size(); ++m)
          k(theta + l, theta + m) -= (now.ddR[l][m] * f) * arm;
      }
    dealii::Vector<double> zero(all.size());
    for (unsigned int i = 0; i < all.size(); ++i)
      if (constraints.is_constrained(all[i]) && k(i, i) < 0.)
        k(i, i) = -k(i, i);
    constraints.distribute_local_to_global(k, zero, all, K, r, true);
  }

  template <int dim>
  void
  Coupling<dim>::add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints,
                             const CarriedPoint<dim> &point) const
  {
    constraints.add_entries_local_to_global(dofs(point), pattern, false);
  }

  template struct CarriedPoint<2>;
  template struct CarriedPoint<3>;
  template class Coupling<2>;
  template class Coupling<3>;
} // namespace Stroma::Rigid
