#include <stroma/base/types.h>
#include <stroma/sph/area_vectors.h>

#include <deal.II/lac/solver_cg.h>

namespace Stroma::Sph
{
  using dealii::Tensor;

  namespace
  {
    /// Share of the full second moment, along its weakest direction, below which a particle lies at a free surface.
    constexpr double surface_threshold = .75;

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

    /// The normal equations of the constraints, and their block diagonal as preconditioner.
    template <int dim>
    class NormalEquations
    {
    public:
      using Basis = Tensor<1, dim + 1>;
      using Block = Tensor<2, dim + 1>;

      NormalEquations(const Neighbours<dim> &neighbours, const Pairs<dim> &pairs, std::vector<std::uint8_t> inside,
                      const double spacing, const unsigned int n_particles)
        : neighbours(neighbours)
        , pairs(pairs)
        , inside(std::move(inside))
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
        for (unsigned int i = 0; i < n; ++i)
          if (!this->inside[i])
            diagonal[i][0][0] = pairs.P[pairs.row_start[i]] * spacing * spacing; // decoupled
        for (const Block &block : diagonal)
          inverse.push_back(invert(block));
      }

      /// What the area vector of pair @p p multiplies in the constraints of its row's particle.
      Basis
      own(const unsigned int i, const unsigned int p) const
      {
        const double share = p < pairs.row_fixed[i] ? 1. : .5;
        return basis(inside[i] ? share * spacing : 0., pairs.r[p]);
      }

      /// And in those of its neighbour, a free particle.
      Basis
      other(const unsigned int p) const
      {
        return basis(inside[pairs.j[p]] ? -spacing : 0., pairs.r[p]);
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
      basis(const double first, const Tensor<1, dim> &r)
      {
        Basis b;
        b[0] = first;
        for (unsigned int d = 0; d < dim; ++d)
          b[d + 1] = r[d];
        return b;
      }

      const Neighbours<dim>            &neighbours;
      const Pairs<dim>                 &pairs;
      const std::vector<std::uint8_t>   inside; ///< whether the areas of a particle (or ghost) close
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
  unsigned int
  AreaVectors<dim>::close(Pairs<dim> &pairs, Particles<dim> &particles) const
  {
    auto &unknowns = particles.closure;
    std::vector<std::uint8_t> inside(particles.size());
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
      inside[i] = !at_surface(pairs, particles, i);
    neighbours.update_ghosts(inside);
    const NormalEquations<dim> equations(neighbours, pairs, inside, spacing, particles.size());

    Vector       missing = new_vector(neighbours, comm), x(missing);
    Unknown     *b       = view<dim>(missing);
    double       scale   = 0.;
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
    {
      const double V = particles.volume(i);
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
        for (unsigned int k = 0; k < dim; ++k)
          b[i][k] -= pairs.c[p][k] * equations.own(i, p);
      for (unsigned int k = 0; k < dim; ++k)
        b[i][k][k + 1] += 2. * V;
      scale += 4. * V * V * dim;
    }
    std::copy(unknowns.begin(), unknowns.begin() + neighbours.n_free(), view<dim>(x));

    dealii::IterationNumberControl control(max_iterations,
                                           tolerance * std::sqrt(dealii::Utilities::MPI::sum(scale, comm)), false, false);
    dealii::SolverCG<Vector>(control).solve(equations, x, missing, BlockJacobi<dim>{ equations });

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
    return control.last_step();
  }

  template <int dim>
  bool
  AreaVectors<dim>::at_surface(const Pairs<dim> &pairs, const Particles<dim> &particles, const unsigned int i) const
  {
    return eigenvalues(pairs.second_moment[i]).back() < surface_threshold * particles.volume(i);
  }

  template class AreaVectors<2>;
  template class AreaVectors<3>;
} // namespace Stroma::Sph
