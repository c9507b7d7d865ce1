#include <stroma/base/types.h>
#include <stroma/sph/area_vectors.h>

#include <deal.II/lac/solver_cg.h>

namespace Stroma::Sph
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  namespace
  {
    /// Share of the full second moment, along its weakest direction, below which a particle lies at a free surface,
    constexpr double surface_threshold = .75;
    /// and below which its neighbours leave a direction out, so that it has no gradient to be made exact.
    constexpr double lonely_threshold = .01;

    /// What the area vectors of a particle must fulfil.
    enum Conditions : std::uint8_t
    {
      none,
      gradient, ///< linear velocities have their gradient
      both      ///< and areas close
    };

    /// Weight of the unknowns themselves against the conditions, relative to the blocks of the diagonal. Where conditions nearly
    /// contradict each other, as at disordered free surfaces, area vectors would otherwise grow tenfold and stable steps shrink
    /// with them; accuracy inside does not change from .003 to .2.
    constexpr double ridge = .003;

    /// Whether all eigenvalues are above @p bound; without roots, which rounding makes complex on lattices.
    template <int dim>
    bool
    is_above(SymmetricTensor<2, dim> A, const double bound)
    {
      for (unsigned int d = 0; d < dim; ++d)
        A[d][d] -= bound;
      const double minor = A[0][0] * A[1][1] - A[0][1] * A[0][1];
      return A[0][0] > 0. && minor > 0. && (dim == 2 || determinant(A) > 0.);
    }

    template <int dim>
    constexpr unsigned int n_unknowns = dim *(dim + 1);

    template <int dim>
    using Unknown = typename AreaVectors<dim>::Unknown;

    template <int dim>
    Unknown<dim> *
    view(Vector &x)
    {
      return reinterpret_cast<Unknown<dim> *>(x.begin());
    }

    template <int dim>
    const Unknown<dim> *
    view(const Vector &x)
    {
      return reinterpret_cast<const Unknown<dim> *>(x.begin());
    }

    /// Inverse of a positive definite block by the Schur complement of its first row; deal.II's ends at 3 x 3.
    template <int dim>
    Tensor<2, dim + 1>
    inverse_of(const Tensor<2, dim + 1> &block)
    {
      Tensor<2, dim> rest;
      Tensor<1, dim> first;
      for (unsigned int a = 0; a < dim; ++a)
      {
        first[a] = block[0][a + 1];
        for (unsigned int b = 0; b < dim; ++b)
          rest[a][b] = block[a + 1][b + 1];
      }
      rest                        = invert(rest);
      const Tensor<1, dim> folded = rest * first;
      Tensor<2, dim + 1>   inverse;
      inverse[0][0] = 1. / (block[0][0] - folded * first);
      for (unsigned int a = 0; a < dim; ++a)
      {
        inverse[0][a + 1] = inverse[a + 1][0] = -inverse[0][0] * folded[a];
        for (unsigned int b = 0; b < dim; ++b)
          inverse[a + 1][b + 1] = rest[a][b] + inverse[0][0] * folded[a] * folded[b];
      }
      return inverse;
    }

    /// The normal equations of the constraints, and their block diagonal as preconditioner.
    template <int dim>
    class NormalEquations
    {
    public:
      using Basis = Tensor<1, dim + 1>;
      using Block = Tensor<2, dim + 1>;

      NormalEquations(const Neighbours<dim> &neighbours, const Pairs<dim> &pairs, std::vector<std::uint8_t> conditions,
                      const double spacing, const unsigned int n_particles)
        : neighbours(neighbours)
        , pairs(pairs)
        , conditions(std::move(conditions))
        , spacing(spacing)
        , ghosted(n_particles)
      {
        const unsigned int n = neighbours.n_free();
        diagonal.resize(n);
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
          {
            const Basis b = own(i, p);
            diagonal[i] += pairs.P[p] * outer_product(b, b);
          }
        for (Block &block : diagonal)
          block *= 1. + ridge;
        for (unsigned int i = 0; i < n; ++i) // what has no condition is decoupled
          for (unsigned int k = this->conditions[i] == none ? dim + 1 : this->conditions[i] == gradient ? 1 : 0; k-- > 0;)
            diagonal[i][k][k] = std::pow(spacing, dim);
        for (const Block &block : diagonal)
          inverse.push_back(inverse_of<dim>(block));
      }

      /// What the area vector of pair @p p multiplies in the constraints of its row's particle.
      Basis
      own(const unsigned int i, const unsigned int p) const
      {
        const double share = p < pairs.row_fixed[i] ? 1. : .5;
        return basis(conditions[i], share * spacing, pairs.r[p]);
      }

      /// And in those of its neighbour, a free particle.
      Basis
      other(const unsigned int p) const
      {
        return basis(conditions[pairs.j[p]], -spacing, pairs.r[p]);
      }

      void
      vmult(Vector &y, const Vector &x) const
      {
        update_ghosts(x);
        Unknown<dim> *const out = view<dim>(y);
        for (unsigned int i = 0; i < neighbours.n_free(); ++i)
        {
          for (unsigned int k = 0; k < dim; ++k)
            out[i][k] = diagonal[i] * ghosted[i][k];
          for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
          {
            const Basis b = pairs.P[p] * own(i, p), o = other(p);
            for (unsigned int k = 0; k < dim; ++k)
              out[i][k] += (ghosted[pairs.j[p]][k] * o) * b;
          }
        }
      }

      void
      precondition(Vector &y, const Vector &x) const
      {
        for (unsigned int i = 0; i < neighbours.n_free(); ++i)
          for (unsigned int k = 0; k < dim; ++k)
            view<dim>(y)[i][k] = inverse[i] * view<dim>(x)[i][k];
      }

      /// The unknowns @p x with the values of ghosts.
      std::vector<Unknown<dim>> &
      update_ghosts(const Vector &x) const
      {
        std::copy(view<dim>(x), view<dim>(x) + neighbours.n_free(), ghosted.begin());
        neighbours.update_ghosts(ghosted);
        return ghosted;
      }

    private:
      static Basis
      basis(const std::uint8_t conditions, const double first, const Tensor<1, dim> &r)
      {
        Basis b;
        if (conditions == none)
          return b;
        b[0] = conditions == both ? first : 0.;
        for (unsigned int d = 0; d < dim; ++d)
          b[d + 1] = r[d];
        return b;
      }

      const Neighbours<dim>            &neighbours;
      const Pairs<dim>                 &pairs;
      const std::vector<std::uint8_t>   conditions; ///< of each particle, ghosts included
      const double                      spacing;
      std::vector<Block>                diagonal, inverse;
      mutable std::vector<Unknown<dim>> ghosted;
    };

    template <int dim>
    struct BlockJacobi
    {
      const NormalEquations<dim> &equations;
      void vmult(Vector &y, const Vector &x) const { equations.precondition(y, x); }
    };

    template <int dim>
    Vector
    new_vector(const Neighbours<dim> &neighbours, const MPI_Comm comm)
    {
      const auto       n = n_unknowns<dim>;
      dealii::IndexSet owned(neighbours.n_equations * n);
      owned.add_range(neighbours.first_equation * n, (neighbours.first_equation + neighbours.n_free()) * n);
      return Vector(owned, comm);
    }
  } // namespace

  template <int dim>
  AreaVectors<dim>::AreaVectors(const Neighbours<dim> &neighbours, const double spacing, const MPI_Comm comm)
    : neighbours(neighbours)
    , spacing(spacing)
    , comm(comm)
  {}

  template <int dim>
  StepStatus
  AreaVectors<dim>::close(Pairs<dim> &pairs, Particles<dim> &particles) const
  {
    auto &unknowns = particles.closure;
    std::vector<std::uint8_t> conditions(particles.size(), none);
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
    {
      const double V = particles.volume(i);
      const auto  &M = pairs.second_moment[i];
      conditions[i]  = is_above(M, surface_threshold * V) ? both : is_above(M, lonely_threshold * V) ? gradient : none;
    }
    neighbours.update_ghosts(conditions);
    const NormalEquations<dim> equations(neighbours, pairs, conditions, spacing, particles.size());

    Vector       missing = new_vector(neighbours, comm), x(missing);
    Unknown     *b       = view<dim>(missing);
    double       scale   = 0.;
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
    {
      const double V = particles.volume(i);
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
        for (unsigned int k = 0; k < dim; ++k)
          b[i][k] -= pairs.c[p][k] * equations.own(i, p);
      for (unsigned int k = 0; k < dim && conditions[i] != none; ++k)
        b[i][k][k + 1] += 2. * V;
      scale += 4. * V * V * dim;
    }
    std::copy(unknowns.begin(), unknowns.begin() + neighbours.n_free(), view<dim>(x));
    if (!std::isfinite(missing.l2_norm()))
      return StepStatus::not_finite;

    dealii::IterationNumberControl control(max_iterations,
                                           tolerance * std::sqrt(dealii::Utilities::MPI::sum(scale, comm)), false, false);
    try
    {
      dealii::SolverCG<Vector>(control).solve(equations, x, missing, BlockJacobi<dim>{ equations });
    }
    catch (const dealii::SolverControl::NoConvergence &) // not finite, on all ranks
    {
      return StepStatus::not_finite;
    }

    unknowns = equations.update_ghosts(x);
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
        for (unsigned int k = 0; k < dim; ++k)
        {
          double change = unknowns[i][k] * equations.own(i, p);
          if (p < pairs.row_fixed[i])
            change += unknowns[pairs.j[p]][k] * equations.other(p);
          pairs.c[p][k] += pairs.P[p] * change;
        }
    return StepStatus::ok;
  }

  template class AreaVectors<2>;
  template class AreaVectors<3>;
} // namespace Stroma::Sph
