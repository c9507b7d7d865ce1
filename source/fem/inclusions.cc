#include <stroma/fem/inclusions.h>
#include <stroma/output/collective.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <tuple>

namespace Stroma::Fem
{
  using Rigid::n_rotations;

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
  void
  Inclusions<dim>::place(Vector &u, const std::vector<Rigid::Pose<dim>> &poses) const
  {
    for (const auto &node : nodes)
      if (u.in_local_range(node.dof))
        u(node.dof) = poses[node.body].displacement(node.X)[node.component];
  }

  template <int dim>
  void
  Inclusions<dim>::tie(dealii::AffineConstraints<double> &ties, const std::vector<Rigid::Pose<dim>> &poses) const
  {
    for (const auto &[dof, c, r, X] : nodes)
      {
        ties.add_line(dof);
        ties.add_entry(dof, this->unknown(r, c), 1.);
        if (!scene.rigid_bodies[r].drive.turns())
          continue;
        const auto columns = this->axes(poses.empty() ? Rigid::Axial<dim>() : poses[r].rotation);
        for (unsigned int k = 0; k < n_rotations<dim>; ++k)
          ties.add_entry(dof, this->unknown(r, dim + k),
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
            add(this->unknown(r, c), sums[n * r + c]);
            for (unsigned int d = 0; d < dim; ++d)
              virials[r][c][d] = sums[n * r + dim + dim * c + d];
          }
        const auto turning = this->conjugate(r, poses[r].rotation, virials[r], {});
        for (unsigned int k = 0; k < n_rotations<dim>; ++k)
          add(this->unknown(r, dim + k), turning[k]);
      }
    force.compress(dealii::VectorOperation::insert);
    return virials;
  }

  template class Inclusions<2>;
  template class Inclusions<3>;
} // namespace Stroma::Fem
