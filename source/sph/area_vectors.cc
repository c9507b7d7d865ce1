#include <stroma/sph/area_vectors.h>

#include <deal.II/lac/solver_cg.h>

#include "closing_equations.h"

namespace Stroma::Sph
{
  namespace
  {
    template <int dim>
    struct BlockJacobi
    {
      const Closing::NormalEquations<dim> &equations;
      void
      vmult(Vector &y, const Vector &x) const
      {
        equations.precondition(y, x);
      }
    };

    template <int dim>
    Vector
    new_vector(const Neighbours<dim> &neighbours, const MPI_Comm comm)
    {
      const auto       n = Closing::n_unknowns<dim>;
      dealii::IndexSet owned(neighbours.n_equations * n);
      owned.add_range(neighbours.first_equation * n, (neighbours.first_equation + neighbours.n_free()) * n);
      return Vector(owned, comm);
    }
  } // namespace

  template <int dim>
  AreaVectors<dim>::AreaVectors(const Neighbours<dim> &neighbours, const double spacing, const bool is_fluid,
                                const double tolerance_asked, std::vector<bool> closed, const MPI_Comm comm)
    : neighbours(neighbours)
    , spacing(spacing)
    , is_fluid(is_fluid)
    , tolerance_asked(tolerance_asked > 0. ? tolerance_asked :
                      is_fluid             ? tolerance_of_fluids :
                                             tolerance)
    , closed(std::move(closed))
    , comm(comm)
  {}

  template <int dim>
  StepStatus
  AreaVectors<dim>::close(Pairs<dim> &pairs, ParticleSet<dim> &particles, const bool from_scratch) const
  {
    find_free_surface(pairs, particles);
    const unsigned int            n = neighbours.n_free();
    Closing::NormalEquations<dim> equations(neighbours, pairs, particles, spacing, is_fluid, closed);
    Vector                        missing = new_vector(neighbours, comm), x(missing);
    double                        scale   = 0.;
    for (unsigned int i = 0; i < n; ++i)
      {
        const double V = particles.volume(i);
        scale += 4. * V * V * dim;
        view<Unknown>(missing)[i] = equations.missing[i];
        view<Unknown>(x)[i]       = particles.closure[i];
        equations.leave_out(i, view<Unknown>(x)[i]);
      }
    if (!std::isfinite(missing.l2_norm()))
      return StepStatus::not_finite;

    equations.find_modes(particles);
    scale = std::sqrt(dealii::Utilities::MPI::sum(scale, comm));
    dealii::IterationNumberControl control(
      from_scratch ? max_iterations_from_scratch : max_iterations,
      (from_scratch ? std::min(tolerance_from_scratch, tolerance_asked) : tolerance_asked) * scale, false, false);
    try
      {
        dealii::SolverCG<Vector>(control).solve(equations, x, missing, BlockJacobi<dim>{equations});
      }
    catch (const dealii::SolverControl::NoConvergence &) // not finite, on all ranks
      {
        return StepStatus::not_finite;
      }

    if (control.last_value() > tolerance * scale)
      return StepStatus::not_closed;
    std::copy(view<Unknown>(x), view<Unknown>(x) + n, particles.closure.begin());
    correct(pairs, particles, equations.of_bodies(particles.closure));
    pairs.volume_share = equations.volume_share;
    return StepStatus::ok;
  }

  template <int dim>
  void
  AreaVectors<dim>::find_free_surface(const Pairs<dim> &pairs, ParticleSet<dim> &particles) const
  {
    for (unsigned int i = 0; i < neighbours.n_free() && !particles.open.empty(); ++i)
      if (particles.open[i] == not_found)
        particles.open[i] = Closing::place_of(pairs, i, particles.volume(i), Closing::moment_of_neighbours(pairs, i)) !=
                            Closing::Place::inside;
    neighbours.update_ghosts(particles.open);
  }

  template <int dim>
  void
  AreaVectors<dim>::apply(Pairs<dim> &pairs, ParticleSet<dim> &particles) const
  {
    const Closing::NormalEquations<dim> equations(neighbours, pairs, particles, spacing, is_fluid, closed);
    pairs.volume_share = equations.volume_share;
    correct(pairs, particles, equations.of_bodies(particles.closure));
  }

  template <int dim>
  void
  AreaVectors<dim>::correct(Pairs<dim> &pairs, ParticleSet<dim> &particles,
                            const std::vector<dealii::Tensor<1, dim>> &of_bodies) const
  {
    const auto &unknowns = particles.closure;
    neighbours.update_ghosts(particles.closure);
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
        {
          auto change = Closing::change_of<dim>(unknowns[i], Closing::own_basis(pairs, spacing, i, p));
          if (p < pairs.row_fixed[i])
            change += Closing::change_of<dim>(unknowns[pairs.j[p]], Closing::other_basis(pairs, spacing, p));
          else if (pairs.has_facets() && pairs.wall(p).flat)
            change = pairs.along_normal(p, change);
          if (p >= pairs.row_fixed[i] && !closed.empty() && closed[pairs.mover(particles, p)])
            change -= spacing / 2. * of_bodies[pairs.mover(particles, p)];
          pairs.c[p] += pairs.P[p] * change;
        }
  }

  template class AreaVectors<2>;
  template class AreaVectors<3>;
} // namespace Stroma::Sph
