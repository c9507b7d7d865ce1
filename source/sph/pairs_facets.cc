// Pairs with walls of facets.

#include <stroma/sph/pairs.h>

#include <algorithm>

namespace Stroma::Sph
{
  using dealii::Tensor;

  namespace
  {
    /// Part of the kernel that walls are taken to leave at least: bounds what pairs beside them grow by.
    constexpr double least_gamma = .25;

    /// Most that shares of friction grow by beside facets.
    constexpr double most_friction = 4.;
  } // namespace

  template <int dim>
  void
  Pairs<dim>::look_at_facets(const ParticleSet<dim> &particles, const Neighbours<dim> &neighbours, const double t,
                             const std::vector<Rigid::Pose<dim>> &poses)
  {
    facets->update(t, poses);
    parts.clear();
    part_start.assign(1, 0);
    gamma.assign(particles.size(), 1.);
    for (unsigned int i = 0; i < neighbours.n_rows(); ++i)
      {
        if (settings.published())
          {
            look_at_segments(particles, i);
            continue;
          }
        double missing = facets->look(particles.x[i], parts);
        // The material ends where it did at the start, and that moves as the wall does: seen from as near as it is to the material.
        Tensor<1, dim> nearer;
        for (unsigned int k = part_start.back(); k < parts.size(); ++k)
          nearer -= facets->clearance(parts[k].X) / parts[k].gradient.norm() * parts[k].gradient;
        if (nearer.norm_square() > 0.)
          {
            parts.resize(part_start.back());
            missing = facets->look(particles.x[i] + nearer, parts);
          }
        gamma[i] = std::max(1. - missing, least_gamma);
        part_start.push_back(parts.size());
      }
    neighbours.update_ghosts(gamma);
  }

  /// Of the bodies that free particle @p i may touch, where they are.
  template <int dim>
  void
  Pairs<dim>::look_at_segments(const ParticleSet<dim> &particles, const unsigned int i)
  {
    if (!particles.is_fixed(i))
      {
        facets->look(particles.x[i], parts);
        parts.erase(std::remove_if(parts.begin() + part_start.back(), parts.end(),
                                   [&](const auto &part) { return !may_meet_mover(particles, i, part.mover); }),
                    parts.end());
      }
    for (unsigned int k = part_start.back(); k < parts.size(); ++k)
      gamma[i] -= parts[k].missing;
    gamma[i] = std::max(gamma[i], least_gamma);
    part_start.push_back(parts.size());
  }

  /// Pairs with segments (Heck 2017, (25) and (27) with the factor 2 mu that is missing in print), times gamma.
  template <int dim>
  unsigned int
  Pairs<dim>::add_segments(const ParticleSet<dim> &particles, const unsigned int i, unsigned int q)
  {
    for (unsigned int k = part_start[i]; k < part_start[i + 1]; ++k, ++q)
      {
        const auto  &part   = parts[k];
        const double size   = part.gradient.norm();
        const auto   normal = part.gradient / size;
        const double away   = -(part.to * normal);
        j[q]                = n_points();
        r[q]                = part.to + (away - std::max(away, least_gap)) * normal;
        c[q]                = -2. * particles.volume(i) * part.gradient;
        P[q]                = 0.;
        friction[q]         = particles.volume(i) * size / std::max(away, settings.arrangement.spacing); // (29)
        walls.push_back({part.mover, part.X, normal, away, part.missing, false, part.flat});
      }
    return q;
  }

  template <int dim>
  unsigned int
  Pairs<dim>::add_facets(const ParticleSet<dim> &particles, const unsigned int i, unsigned int q)
  {
    for (unsigned int p = row_start[i]; p < q; ++p)
      if (const double growth = .5 * (1. / gamma[i] + 1. / gamma[j[p]]); growth != 1.)
        {
          P[p] *= growth;
          c[p] *= growth; // friction does not: a uniform shear leaves no force on particles that see no wall
        }
    const unsigned int first = q;
    for (unsigned int k = part_start[i]; k < part_start[i + 1]; ++k, ++q)
      {
        const auto  &part   = parts[k];
        const double size   = part.gradient.norm();
        const auto   normal = part.gradient / size;
        const double away = -(part.to * normal), d = std::max(away, least_gap);
        j[q]        = n_points();
        r[q]        = part.to + (away - d) * normal;
        c[q]        = -4. * particles.volume(i) / gamma[i] * part.gradient;
        P[q]        = c[q].norm() / (2. * d);
        friction[q] = .5 * P[q];
        walls.push_back({part.mover, part.X, normal, away + facets->clearance(part.X), part.missing, false, part.flat});
      }
    if (q > first)
      share_friction(i, q);
    return q;
  }

  /// Scales the weights of friction with walls such that a uniform shear along them leaves no force, as it does inside.
  template <int dim>
  void
  Pairs<dim>::share_friction(const unsigned int i, const unsigned int q)
  {
    Tensor<1, dim> inside, at_walls;
    for (unsigned int p = row_start[i]; p < row_fixed[i]; ++p)
      inside += friction[p] * r[p];
    for (unsigned int p = row_fixed[i]; p < q; ++p)
      at_walls += friction[p] * r[p];
    const double share = std::clamp(-(inside * at_walls) / at_walls.norm_square(), 0., most_friction);
    for (unsigned int p = row_fixed[i]; p < q; ++p)
      friction[p] *= share;
  }

  template void         Pairs<2>::look_at_facets(const ParticleSet<2> &, const Neighbours<2> &, double,
                                                 const std::vector<Rigid::Pose<2>> &);
  template void         Pairs<2>::look_at_segments(const ParticleSet<2> &, unsigned int);
  template unsigned int Pairs<2>::add_facets(const ParticleSet<2> &, unsigned int, unsigned int);
  template unsigned int Pairs<2>::add_segments(const ParticleSet<2> &, unsigned int, unsigned int);
  template void         Pairs<2>::share_friction(unsigned int, unsigned int);
  template void         Pairs<3>::look_at_facets(const ParticleSet<3> &, const Neighbours<3> &, double,
                                                 const std::vector<Rigid::Pose<3>> &);
  template void         Pairs<3>::look_at_segments(const ParticleSet<3> &, unsigned int);
  template unsigned int Pairs<3>::add_facets(const ParticleSet<3> &, unsigned int, unsigned int);
  template unsigned int Pairs<3>::add_segments(const ParticleSet<3> &, unsigned int, unsigned int);
  template void         Pairs<3>::share_friction(unsigned int, unsigned int);
} // namespace Stroma::Sph
