// How islands move as a whole, and what forces do to that.

#include <stroma/sph/islands.h>

#include <deal.II/base/mpi.h>

#include <Eigen/Eigenvalues>

#include <cmath>

namespace Stroma::Sph
{
  using dealii::Tensor;

  namespace
  {
    /// Moment of inertia over the largest, below which particles lie on the axis.
    constexpr double on_axis = 1e-8;

    /// Part of the loads on an island that may be left over: particles sum them up only nearly.
    constexpr double negligible_sum = .02;

    /// Of the mean diagonal entry of a particle.
    constexpr double diagonal_shift = .01;

    /// Inverse of @p inertia on the axes of @p may_turn, without those that all lies on.
    template <int n>
    Tensor<2, n>
    inverse_on(const Tensor<2, n> &inertia, const std::array<bool, n> &may_turn)
    {
      Eigen::Matrix<double, n, n> matrix = Eigen::Matrix<double, n, n>::Zero();
      for (unsigned int a = 0; a < n; ++a)
        for (unsigned int b = 0; b < n; ++b)
          if (may_turn[a] && may_turn[b])
            matrix(a, b) = inertia[a][b];
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, n, n>> eigen(matrix);
      Tensor<2, n>                                                     inverse;
      for (unsigned int e = 0; e < n; ++e)
        if (const double value = eigen.eigenvalues()[e]; value > on_axis * eigen.eigenvalues()[n - 1])
          for (unsigned int a = 0; a < n; ++a)
            for (unsigned int b = 0; b < n; ++b)
              inverse[a][b] += eigen.eigenvectors()(a, e) * eigen.eigenvectors()(b, e) / value;
      return inverse;
    }
  } // namespace

  /// Places of members from their centres, and inertia.
  template <int dim>
  void
  Islands<dim>::measure()
  {
    const auto          comm = system.scene.comm;
    std::vector<double> sums((dim + 1) * islands.size(), 0.);
    for (const auto &member : members)
      {
        sums[(dim + 1) * member.island + dim] += 1.;
        for (unsigned int d = 0; d < dim; ++d)
          sums[(dim + 1) * member.island + d] += member.y[d];
      }
    dealii::Utilities::MPI::sum(sums, comm, sums);
    std::vector<double> inertia(n_turns * n_turns * islands.size(), 0.);
    for (auto &member : members)
      {
        const auto *const sum = &sums[(dim + 1) * member.island];
        for (unsigned int d = 0; d < dim; ++d)
          member.y[d] -= sum[d] / sum[dim];
        for (unsigned int a = 0; a < n_turns; ++a)
          for (unsigned int b = 0; b < n_turns; ++b)
            inertia[n_turns * (n_turns * member.island + a) + b] += (a == b ? member.y.norm_square() : 0.) -
                                                                    (dim == 3 ? member.y[a] * member.y[b] : 0.);
      }
    dealii::Utilities::MPI::sum(inertia, comm, inertia);
    inverse_inertia.resize(islands.size());
    for (unsigned int k = 0; k < islands.size(); ++k)
      {
        islands[k].n_particles = static_cast<unsigned int>(std::lround(sums[(dim + 1) * k + dim]));
        Turning                   of_island;
        std::array<bool, n_turns> may_turn;
        for (unsigned int a = 0; a < n_turns; ++a)
          {
            may_turn[a] = true;
            for (unsigned int d = 0; d < dim; ++d)
              may_turn[a] = may_turn[a] && !(repeats[k][d] && (dim == 2 || d != a));
            for (unsigned int b = 0; b < n_turns; ++b)
              of_island[a][b] = inertia[n_turns * (n_turns * k + a) + b];
          }
        inverse_inertia[k] = inverse_on<n_turns>(of_island, may_turn);
      }
  }

  template <int dim>
  std::uint64_t
  Islands<dim>::n_particles() const
  {
    std::uint64_t n = 0;
    for (const auto &island : islands)
      n += island.n_particles;
    return n;
  }

  /// Of each island the sum of @p v and that of y x v.
  template <int dim>
  std::vector<double>
  Islands<dim>::sums_of(const Tensor<1, dim> *const v) const
  {
    std::vector<double> sums(n_modes * islands.size(), 0.);
    for (const auto &member : members)
      {
        const auto moment = Rigid::moment<dim>(member.y, v[member.i]);
        for (unsigned int d = 0; d < dim; ++d)
          sums[n_modes * member.island + d] += v[member.i][d];
        for (unsigned int a = 0; a < n_turns; ++a)
          sums[n_modes * member.island + dim + a] += moment[a];
      }
    dealii::Utilities::MPI::sum(sums, system.scene.comm, sums);
    return sums;
  }

  template <int dim>
  void
  Islands<dim>::remove_rigid_motions(Tensor<1, dim> *const v) const
  {
    if (islands.empty())
      return;
    const auto sums = sums_of(v);
    for (const auto &member : members)
      {
        const auto *const sum = &sums[n_modes * member.island];
        Rigid::Axial<dim> moment;
        for (unsigned int a = 0; a < n_turns; ++a)
          moment[a] = sum[dim + a];
        for (unsigned int d = 0; d < dim; ++d)
          v[member.i][d] -= sum[d] / islands[member.island].n_particles;
        v[member.i] -= Rigid::cross<dim>(inverse_inertia[member.island] * moment, member.y);
      }
  }

  template <int dim>
  const typename Islands<dim>::Island *
  Islands<dim>::driven_by(const Velocities &loads) const
  {
    if (islands.empty())
      return nullptr;
    const auto          sums = sums_of(loads.data());
    std::vector<double> sizes(2 * islands.size(), 0.); // of forces, and of these times their arms
    for (const auto &member : members)
      {
        sizes[2 * member.island] += loads[member.i].norm();
        sizes[2 * member.island + 1] += member.y.norm() * loads[member.i].norm();
      }
    dealii::Utilities::MPI::sum(sizes, system.scene.comm, sizes);
    for (unsigned int k = 0; k < islands.size(); ++k)
      {
        Rigid::Axial<dim> moment;
        for (unsigned int c = 0; c < n_modes; ++c)
          if (c >= dim)
            moment[c - dim] = sums[n_modes * k + c];
          else if (std::abs(sums[n_modes * k + c]) > negligible_sum * sizes[2 * k])
            return &islands[k];
        // What cannot turn has no use for a moment.
        if (inverse_inertia[k].norm() > 0. && moment.norm() > negligible_sum * sizes[2 * k + 1])
          return &islands[k];
      }
    return nullptr;
  }

  template <int dim>
  double
  Islands<dim>::shift(const double trace)
  {
    return trace > 0. ? diagonal_shift * trace / dim : 1.;
  }

  template void                               Islands<2>::measure();
  template std::uint64_t                      Islands<2>::n_particles() const;
  template std::vector<double>                Islands<2>::sums_of(const Tensor<1, 2> *) const;
  template void                               Islands<2>::remove_rigid_motions(Tensor<1, 2> *) const;
  template const typename Islands<2>::Island *Islands<2>::driven_by(const Velocities &) const;
  template double                             Islands<2>::shift(double);
  template void                               Islands<3>::measure();
  template std::uint64_t                      Islands<3>::n_particles() const;
  template std::vector<double>                Islands<3>::sums_of(const Tensor<1, 3> *) const;
  template void                               Islands<3>::remove_rigid_motions(Tensor<1, 3> *) const;
  template const typename Islands<3>::Island *Islands<3>::driven_by(const Velocities &) const;
  template double                             Islands<3>::shift(double);
} // namespace Stroma::Sph
