#include "spring_chain.h"

#include <deal.II/base/mpi.h>
#include <deal.II/lac/trilinos_sparsity_pattern.h>

#include <cmath>

using namespace dealii;
using Stroma::StepStatus;

SpringChain::SpringChain(const unsigned int n, const double foundation)
  : n(n)
  , foundation(foundation)
  , owned(Utilities::MPI::create_evenly_distributed_partitioning(MPI_COMM_WORLD, n + 1))
  , relevant(owned)
{
  for (const auto i : owned)
    relevant.add_range(i > 0 ? i - 1 : 0, std::min<types::global_dof_index>(i + 2, n + 1));
  ghosted.reinit(owned, relevant, MPI_COMM_WORLD);
}

void
SpringChain::move_end(const double displacement)
{
  end_is_moved     = true;
  end_displacement = displacement;
}

void
SpringChain::pull_end(const double force)
{
  end_is_moved = false;
  end_force    = force;
}

Stroma::Vector
SpringChain::vector() const
{
  return Stroma::Vector(owned, MPI_COMM_WORLD);
}

Stroma::Matrix
SpringChain::matrix() const
{
  TrilinosWrappers::SparsityPattern pattern(owned, owned, MPI_COMM_WORLD, 3);
  for (const auto i : owned)
    for (const unsigned int j : {i > 0 ? i - 1 : i, i, i < n ? i + 1 : i})
      pattern.add(i, j);
  pattern.compress();
  Stroma::Matrix K;
  K.reinit(pattern);
  return K;
}

double
SpringChain::value(const Stroma::Vector &v, const unsigned int i) const
{
  return Utilities::MPI::sum(owned.is_element(i) ? static_cast<double>(v[i]) : 0., MPI_COMM_WORLD);
}

double
SpringChain::stretch(const double force, const double k)
{
  double l = 1.;
  for (unsigned int i = 0; i < 100; ++i)
    l = std::max(.5 * l, l - (k * (l - 1. / (l * l)) - force) / (k * (1. + 2. / (l * l * l))));
  return l;
}

double
SpringChain::get_stretch(const unsigned int spring) const
{
  return 1. + ghosted[spring + 1] - ghosted[spring];
}

StepStatus
SpringChain::residual(Stroma::Vector &r, const Stroma::Vector &u)
{
  last_u.reinit(u);
  last_u         = u;
  ghosted        = u;
  double squares = 0., summed = 0.;
  bool   turned = false;
  for (const auto i : owned)
    {
      double internal = foundation * ghosted[i];
      for (const int side : {-1, 0})
        if (const int spring = static_cast<int>(i) + side; spring >= 0 && spring < static_cast<int>(n))
          {
            const double l = get_stretch(spring);
            turned         = turned || l <= 0.;
            summed += std::pow(stiffness(spring) * (1. + std::abs(ghosted[spring]) + std::abs(ghosted[spring + 1])), 2);
            internal += (side == -1 ? 1. : -1.) * stiffness(spring) * (l - 1. / (l * l));
          }
      squares += internal * internal;
      const double external = i == n && !end_is_moved ? end_force : 0.;
      r[i]                  = constrained(i) ? 0. : external - internal;
    }
  r.compress(VectorOperation::insert);
  scale = std::sqrt(Utilities::MPI::sum(squares, MPI_COMM_WORLD));
  noise = 4. * std::numeric_limits<double>::epsilon() * std::sqrt(Utilities::MPI::sum(summed, MPI_COMM_WORLD));
  return Stroma::reduce(turned ? StepStatus::inverted_point : StepStatus::ok, MPI_COMM_WORLD);
}

StepStatus
SpringChain::tangent(Stroma::Matrix &K, Stroma::Vector &r, const Stroma::Vector &u)
{
  ghosted = u;
  K       = 0.;
  for (const auto i : owned)
    {
      double diagonal = foundation;
      for (const int side : {-1, 0})
        if (const int spring = static_cast<int>(i) + side; spring >= 0 && spring < static_cast<int>(n))
          {
            const unsigned int j = side == -1 ? i - 1 : i + 1;
            const double       k = stiffness(spring) * (1. + 2. * std::pow(get_stretch(spring), -3));
            diagonal += k;
            if (constrained(i))
              continue;
            if (constrained(j))
              r[i] = r[i] + k * (prescribed(j) - ghosted[j]);
            else
              K.set(i, j, -k);
          }
      K.set(i, i, diagonal);
      if (constrained(i))
        r[i] = diagonal * (prescribed(i) - ghosted[i]);
    }
  K.compress(VectorOperation::insert);
  r.compress(VectorOperation::insert);
  return StepStatus::ok;
}
