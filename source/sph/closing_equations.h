#pragma once

#include <stroma/base/types.h>
#include <stroma/sph/area_vectors.h>
#include <stroma/sph/smooth_modes.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <memory>

#include "block_inverse.h"
#include "closed_bodies.h"
#include "vector_view.h"

/// What AreaVectors solves.
namespace Stroma::Sph::Closing
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  /// Share of the full second moment, along its weakest direction, below which a particle lies at a free surface,
  inline constexpr double surface_threshold = .75;
  /// The same where walls are facets, which are no gaps: particles inside that are disordered by 30 % of the spacing fall to .64, those
  /// at a flat surface have .5.
  inline constexpr double surface_threshold_facets = .6;
  /// the same of one that touches a rigid body, whose pairs are fewer where it may slide,
  inline constexpr double touching_threshold = .5;
  /// and below which its neighbours leave a direction out, so that it has no gradient to be made exact.
  inline constexpr double lonely_threshold = .01;

  /// Weight of the unknowns themselves against the conditions, relative to the blocks of the diagonal. Where conditions nearly
  /// contradict each other, as at disordered free surfaces, area vectors would otherwise grow tenfold and stable steps shrink
  /// with them. On disordered particles it leaves a force of uniform stresses, 1.9 % of stress times spacing (2.2 % at .003,
  /// .6 % at .0003, where conjugate gradients take longer).
  inline constexpr double ridge = .0025;
  /// The same where something degrades: areas of fluid that flows must close, or pressure drives volume through what is left, and the cell is
  /// too fast (in 200 s at 10 um .3 % of all with .0025),
  inline constexpr double ridge_where_degraded = 1e-5;
  /// while second moments, whose faults B mends, may give so much more: with .0025 the conditions contradict each other beside sparse particles.
  inline constexpr double ridge_of_moments = .03;
  /// The same of a fluid with a free surface: that force lets a liquid at rest overturn (a tank of .5 m with 500 Pa s within 30 s;
  /// with 1e-4 it stays within .1 % of its level for 100 s, with 1e-5 and three times as many iterations for 300 s).
  inline constexpr double ridge_below_surface = 1e-4;
  /// The same of particles that see no gap, where walls are facets: their area vectors start off by a tenth on lattices beside
  /// walls, and this leaves less than 1e-3 of stress times area there, disordered by 30 % of the spacing too (3e-3 at 5e-6).
  inline constexpr double ridge_at_facets = 1e-7;

  /// Area of a fluid's free surface that the kernel's area vectors show, over V/dp: .93 at a flat one, .2 at a gap inside.
  inline constexpr double least_area = .5;
  /// Weight of the area of a fluid's free surface against its being V/dp, relative to the block of the diagonal.
  inline constexpr double softness = .1;

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

  /// Unit vector along the weakest axis of @p moment, towards @p start, by inverse iterations from it. Across an axis a third stronger a
  /// hundredth of @p start stays; of axes that are equally weak, as at corners of a lattice, where rounding would choose among
  /// eigenvectors, all of it. 0 where @p start is.
  template <int dim>
  Tensor<1, dim>
  weakest_direction(const SymmetricTensor<2, dim> &moment, const Tensor<1, dim> &start)
  {
    const SymmetricTensor<2, dim> inverse = invert(moment) * trace(moment);
    Tensor<1, dim>                n       = start;
    for (unsigned int k = 0; k < 16; ++k)
      n = inverse * n;
    const double length = n.norm();
    return length > 0. ? n / length : n;
  }

  template <int dim>
  inline constexpr unsigned int n_unknowns = dim *(dim + 1);

  template <int dim>
  using Unknown = typename AreaVectors<dim>::Unknown;

  template <int dim>
  Tensor<1, dim + 1>
  basis_of(const double first, const Tensor<1, dim> &r)
  {
    Tensor<1, dim + 1> b;
    b[0] = first;
    for (unsigned int d = 0; d < dim; ++d)
      b[d + 1] = r[d];
    return b;
  }

  /// What the area vector of pair @p p multiplies in the conditions of its row's particle.
  template <int dim>
  Tensor<1, dim + 1>
  own_basis(const Pairs<dim> &pairs, const double spacing, const unsigned int i, const unsigned int p)
  {
    const double to_face = pairs.face.empty() ? 1. : 2. * pairs.face[p];
    return basis_of<dim>((p < pairs.row_fixed[i] ? 1. : .5) * spacing, to_face * pairs.r[p]);
  }

  /// And in those of its neighbour, a free particle.
  template <int dim>
  Tensor<1, dim + 1>
  other_basis(const Pairs<dim> &pairs, const double spacing, const unsigned int p)
  {
    const double to_face = pairs.face.empty() ? 1. : 2. * (1. - pairs.face[p]);
    return basis_of<dim>(-spacing, to_face * pairs.r[p]);
  }

  /// By how much unknowns @p x change the area vector that multiplies @p basis, over the pair's weight.
  template <int dim>
  Tensor<1, dim>
  change_of(const Unknown<dim> &x, const Tensor<1, dim + 1> &basis)
  {
    Tensor<1, dim> change;
    for (unsigned int k = 0; k < dim; ++k)
      change[k] = x[k] * basis;
    return change;
  }

  /// What a particle must fulfil.
  enum class Place : std::uint8_t
  {
    inside,
    gap,     ///< neighbours leave a direction out: area vectors need not close, as at free surfaces of solids
    surface, ///< of a fluid: they miss the surface's
    lonely   ///< nothing
  };

  /// Second moment of the neighbours of particle @p i, over beta as r is: V_i I inside an undisturbed lattice.
  template <int dim>
  SymmetricTensor<2, dim>
  moment_of_neighbours(const Pairs<dim> &pairs, const unsigned int i)
  {
    SymmetricTensor<2, dim> moment;
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
      moment += pairs.P[p] * symmetrize(outer_product(pairs.r[p], pairs.r[p]));
    return moment;
  }

  /// Inside, beside a gap, or lonely: by the @p moment of the neighbours of particle @p i, of volume @p V.
  template <int dim>
  Place
  place_of(const Pairs<dim> &pairs, const unsigned int i, const double V, const SymmetricTensor<2, dim> &moment)
  {
    const bool   in_touch  = !pairs.in_touch.empty() && pairs.in_touch[i] != 0;
    const double threshold = pairs.has_facets() ? surface_threshold_facets :
                             in_touch           ? touching_threshold :
                                                  surface_threshold;
    return is_above(moment, threshold * V)        ? Place::inside :
           is_above(moment, lonely_threshold * V) ? Place::gap :
                                                    Place::lonely;
  }

  /// The normal equations of what the area vectors must fulfil, and their block diagonal as preconditioner; where walls are facets, with
  /// SmoothModes. Particles at a free surface of a solid have no first unknown, lonely ones none at all: those stay 0.
  template <int dim>
  class NormalEquations
  {
  public:
    using Basis = Tensor<1, dim + 1>;
    using Block = Tensor<2, dim + 1>;

    NormalEquations(const Neighbours<dim> &neighbours, const Pairs<dim> &pairs, const ParticleSet<dim> &particles,
                    const double spacing, const bool is_fluid, const std::vector<bool> &closed)
      : missing(neighbours.n_free())
      , volume_share(is_fluid ? neighbours.n_free() : 0, 1.)
      , neighbours(neighbours)
      , pairs(pairs)
      , particles(particles)
      , spacing(spacing)
      , is_fluid(is_fluid)
      , n_left_out(neighbours.n_free())
      , normal(is_fluid ? neighbours.n_free() : 0)
      , diagonal(neighbours.n_free())
      , inverse(neighbours.n_free())
      , ghosted(particles.size())
      , bodies(pairs, particles, closed, spacing, neighbours.communicator(),
               [&](const unsigned int i, const unsigned int p) { return own(i, p); })
    {
      double                    n_at_surface = 0.;
      std::vector<std::uint8_t> is_open(pairs.has_facets() ? particles.size() : 0);
      for (unsigned int i = 0; i < neighbours.n_free(); ++i)
        {
          const Place place = add_row(i, particles.volume(i));
          n_at_surface += place == Place::surface;
          if (pairs.has_facets())
            is_open[i] = place != Place::inside;
        }
      neighbours.update_ghosts(is_open);
      const bool has_surface = is_fluid && dealii::Utilities::MPI::sum(n_at_surface, neighbours.communicator()) > 0.;
      for (unsigned int i = 0; i < neighbours.n_free(); ++i)
        finish_block(i, degrades()                                   ? ridge_where_degraded :
                        has_surface                                  ? ridge_below_surface :
                        pairs.has_facets() && !sees_open(i, is_open) ? ridge_at_facets :
                                                                       ridge);
      bodies.visit_rows(bodies.start(), [&](const unsigned int i, Unknown<dim> part) {
        leave_out(i, part);
        for (unsigned int k = 0; k < dim; ++k)
          missing[i][k] += part[k];
      });
    }

    Basis
    own(const unsigned int i, const unsigned int p) const
    {
      return own_basis(pairs, spacing, i, p);
    }
    Basis
    other(const unsigned int p) const
    {
      return other_basis(pairs, spacing, p);
    }

    void
    vmult(Vector &y, const Vector &x) const
    {
      update_ghosts(x);
      Unknown<dim> *const out = view<Unknown<dim>>(y);
      for (unsigned int i = 0; i < neighbours.n_free(); ++i)
        {
          auto sum = of_neighbours(i);
          if (pairs.has_facets())
            hold_directions(i, sum);
          leave_out(i, sum);
          for (unsigned int k = 0; k < dim; ++k)
            out[i][k] = diagonal[i] * ghosted[i][k] + sum[k];
          if (is_fluid)
            soften(i, ghosted[i], out[i]);
        }
      if (!bodies.none())
        bodies.visit_rows(bodies.response(ghosted), [&](const unsigned int i, Unknown<dim> part) {
          leave_out(i, part);
          for (unsigned int k = 0; k < dim; ++k)
            out[i][k] -= part[k];
        });
    }

    void
    precondition(Vector &y, const Vector &x) const
    {
      for (unsigned int i = 0; i < neighbours.n_free(); ++i)
        for (unsigned int k = 0; k < dim; ++k)
          view<Unknown<dim>>(y)[i][k] = inverse[i] * view<Unknown<dim>>(x)[i][k];
      if (modes)
        modes->add_solution(view<Unknown<dim>>(y), view<Unknown<dim>>(x));
    }

    /// Prepares what the preconditioner needs besides, where small ridges leave smooth modes to be found. Collective.
    void
    find_modes(const ParticleSet<dim> &particles)
    {
      if (!pairs.has_facets())
        return;
      auto left_out = n_left_out;
      left_out.resize(particles.size());
      neighbours.update_ghosts(left_out);
      double reach = 0.; // squared
      for (unsigned int i = 0; i < neighbours.n_free(); ++i)
        for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
          reach = std::max(reach, pairs.r[p].norm_square());
      reach = std::sqrt(dealii::Utilities::MPI::max(reach, neighbours.communicator()));
      modes = std::make_unique<SmoothModes<dim>>(neighbours, particles, spacing, reach, left_out);
      for (unsigned int i = 0; i < neighbours.n_free(); ++i)
        {
          modes->add(i, diagonal[i]);
          for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
            modes->add(i, pairs.j[p], pairs.P[p], own(i, p), other(p));
          for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
            for (unsigned int k = 0; k < dim && pairs.wall(p).flat; ++k)
              modes->add_to_component(k, i, (std::pow(pairs.wall(p).normal[k], 2) - 1.) * pairs.P[p], own(i, p));
        }
      modes->factorise();
    }

    /// The unknowns @p x with the values of ghosts.
    std::vector<Unknown<dim>> &
    update_ghosts(const Vector &x) const
    {
      std::copy(view<Unknown<dim>>(x), view<Unknown<dim>>(x) + neighbours.n_free(), ghosted.begin());
      neighbours.update_ghosts(ghosted);
      return ghosted;
    }

    /// y of ClosedBodies for the unknowns @p x of owned particles. Collective.
    std::vector<Tensor<1, dim>>
    of_bodies(const std::vector<Unknown<dim>> &x) const
    {
      auto y = bodies.start();
      if (!bodies.none())
        {
          const auto of_particles = bodies.response(x);
          for (unsigned int m = 0; m < y.size(); ++m)
            y[m] += of_particles[m];
        }
      return y;
    }

    /// Sets the unknowns that particle @p i does not have to 0.
    void
    leave_out(const unsigned int i, Unknown<dim> &x) const
    {
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int e = 0; e < n_left_out[i]; ++e)
          x[k][e] = 0.;
    }

    std::vector<Unknown<dim>> missing;      ///< of the conditions, with the area vectors as they are
    std::vector<double>       volume_share; ///< of fluids

  private:
    /// Finds out what particle @p i of volume @p V must fulfil, what is missing, and its block of the diagonal.
    Place
    add_row(const unsigned int i, const double V)
    {
      Block        &block = diagonal[i];
      Unknown<dim> &b     = missing[i];
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
        {
          const Basis o = own(i, p), Po = pairs.P[p] * o;
          block += outer_product(Po, o);
          for (unsigned int k = 0; k < dim; ++k)
            b[k] -= pairs.c[p][k] * o;
        }
      SymmetricTensor<2, dim> moment;
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int l = 0; l <= k; ++l)
          moment[k][l] = block[k + 1][l + 1];
      if (!pairs.face.empty()) // the block has those of the faces
        moment = moment_of_neighbours(pairs, i);
      Place place = place_of(pairs, i, V, moment);
      if (place == Place::gap && has_opened(i))
        place = Place::inside;
      if (place == Place::gap && is_fluid && is_at_surface(i, V, moment))
        place = Place::surface;
      n_left_out[i] = place == Place::lonely ? dim + 1 : place == Place::gap ? 1 : 0;
      for (unsigned int k = 0; k < dim; ++k)
        b[k][k + 1] += 2. * V * (is_fluid ? volume_share[i] : 1.);
      leave_out(i, b);
      return place;
    }

    /// Whether the gap beside particle @p i is none that was there at the start, nor one of its neighbours': then the particles leave it
    /// out, and not the matter, which no law lets tear.
    bool
    has_opened(const unsigned int i) const
    {
      return degrades() && !sees_open(i, particles.open);
    }

    /// Whether something degrades.
    bool
    degrades() const
    {
      return !particles.open.empty();
    }

    /// Whether particle @p i or a neighbour has a gap beside it.
    bool
    sees_open(const unsigned int i, const std::vector<std::uint8_t> &is_open) const
    {
      const auto first = pairs.j.begin() + pairs.row_start[i], last = pairs.j.begin() + pairs.row_fixed[i];
      return is_open[i] || std::any_of(first, last, [&](const unsigned int j) { return is_open[j]; });
    }

    /// What the unknowns of the neighbours contribute to row @p i.
    Unknown<dim>
    of_neighbours(const unsigned int i) const
    {
      if (!pairs.face.empty())
        return of_neighbours_at_faces(i);
      const unsigned int *const   j = pairs.j.data();
      const double *const         P = pairs.P.data();
      const Tensor<1, dim> *const r = pairs.r.data();
      Unknown<dim>                sum;
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
        {
          const auto &x_j = ghosted[j[p]];
          for (unsigned int k = 0; k < dim; ++k)
            {
              double change = -spacing * x_j[k][0];
              for (unsigned int d = 0; d < dim; ++d)
                change += r[p][d] * x_j[k][d + 1];
              change *= P[p];
              sum[k][0] += change;
              for (unsigned int d = 0; d < dim; ++d)
                sum[k][d + 1] += change * r[p][d];
            }
        }
      for (unsigned int k = 0; k < dim; ++k)
        sum[k][0] *= spacing;
      return sum;
    }

    /// The same where pairs.face is given.
    Unknown<dim>
    of_neighbours_at_faces(const unsigned int i) const
    {
      Unknown<dim> sum;
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
        {
          const Basis b = own(i, p), o = other(p);
          for (unsigned int k = 0; k < dim; ++k)
            sum[k] += (pairs.P[p] * (ghosted[pairs.j[p]][k] * o)) * b;
        }
      return sum;
    }

    /// Takes out of @p sum what areas of flat walls in row @p i would take up along them: the diagonal has them free in all
    /// directions.
    void
    hold_directions(const unsigned int i, Unknown<dim> &sum) const
    {
      for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
        {
          if (!pairs.wall(p).flat)
            continue;
          const Basis          o      = own(i, p);
          const Tensor<1, dim> change = change_of<dim>(ghosted[i], o), along = change - pairs.along_normal(p, change);
          for (unsigned int k = 0; k < dim; ++k)
            sum[k] -= (pairs.P[p] * along[k]) * o;
        }
    }

    /// Whether the neighbours of a fluid's particle, which leave a direction out, all are on one side of it; if so, its surface is
    /// taken into what it must fulfil.
    bool
    is_at_surface(const unsigned int i, const double V, const SymmetricTensor<2, dim> &moment)
    {
      Tensor<1, dim> outward; // minus the sum of area vectors as they are
      for (unsigned int k = 0; k < dim; ++k)
        outward[k] = missing[i][k][0];
      const Tensor<1, dim> n = weakest_direction(moment, outward);
      if (outward * n < least_area * V)
        return false;
      volume_share[i] = .5;
      normal[i]       = n;
      for (unsigned int k = 0; k < dim; ++k)
        missing[i][k][0] -= V * normal[i][k]; // spacing times the area V/dp
      return true;
    }

    /// Adds the weight on phi along the normal of a surface; normals of other particles are 0.
    void
    soften(const unsigned int i, const Unknown<dim> &x, Unknown<dim> &y) const
    {
      double along = 0.;
      for (unsigned int k = 0; k < dim; ++k)
        along += x[k][0] * normal[i][k];
      for (unsigned int k = 0; k < dim; ++k)
        y[k][0] += softness * diagonal[i][0][0] * along * normal[i][k];
    }

    void
    finish_block(const unsigned int i, const double ridge_here)
    {
      Block &block = diagonal[i];
      block *= 1. + ridge_here;
      for (unsigned int e = 1; e <= dim && degrades(); ++e)
        for (unsigned int l = 1; l <= dim; ++l)
          block[e][l] *= 1. + ridge_of_moments;
      for (unsigned int e = 0; e < n_left_out[i]; ++e)
        for (unsigned int l = 0; l <= dim; ++l)
          block[e][l] = block[l][e] = e == l ? std::pow(spacing, dim) : 0.;
      inverse[i] = inverse_of<dim>(block);
    }

    const Neighbours<dim>            &neighbours;
    const Pairs<dim>                 &pairs;
    const ParticleSet<dim>           &particles;
    const double                      spacing;
    const bool                        is_fluid;
    std::vector<std::uint8_t>         n_left_out; ///< leading unknowns of each part that a particle does not have
    std::vector<Tensor<1, dim>>       normal;     ///< of a fluid's free surface, outward; elsewhere 0
    std::vector<Block>                diagonal, inverse;
    mutable std::vector<Unknown<dim>> ghosted;
    const ClosedBodies<dim>           bodies;
    std::unique_ptr<SmoothModes<dim>> modes;
  };
} // namespace Stroma::Sph::Closing
