#pragma once

#include <stroma/base/parameters.h>
#include <stroma/particles/mover.h>
#include <stroma/particles/particle_set.h>
#include <stroma/scene/scene.h>

namespace Stroma::Particles
{
  /// How particles are laid out at the start.
  enum class ArrangementName
  {
    square,    ///< the cubic lattice
    hexagonal, ///< rows shifted by half a spacing; in 3D hexagonal close packing
    voronoi    ///< relaxed: each particle at the centroid of its Voronoi cell, all cells of about one volume (Lloyd)
  };

  /// The entries `Spacing`, `Arrangement`, `Jitter`, `Jitter seed`.
  struct ArrangementSettings
  {
    double spacing = std::nan(""); ///< dp [m]: distance of neighbours; each stands for dp^dim, hexagonal ones for less
    ArrangementName name   = ArrangementName::square;
    double          jitter = 0.; ///< largest random shift along each axis over the spacing: disorder, for tests
    unsigned int    seed   = 1;  ///< of the random numbers of jitter and voronoi
    bool            follows_borders =
      false; ///< whether volumes of a lattice's particles do, between materials: shares_at_borders()
    bool bodies_by_surface =
      false; ///< whether rigid bodies are boundary particles on their outline instead of a filling

    std::string where_spacing;

    void add(Parameters &p);
  };

  /**
   * The particles of a scene at the start: place, volume, material, mover, J = 1; other fields are left empty. Free
   * ones fill the bodies that are not rigid, on a lattice fitted to the bodies' box (Lattice). Fixed ones continue the
   * lattice (of voronoi: the square one) beyond the held sides to a depth of at least @p reach, and fill the rigid
   * bodies to that depth.
   *
   * Beyond an edge or corner where held sides meet, fixed particles belong to the first of the supports; beyond one
   * where a held side meets a free one there are none, nor where the body has no material just inside the side. There
   * are none across periodic faces, and none at all with a reach of 0.
   *
   * Boundary particles (in the plane) stand a spacing or less apart on the outline of a rigid body, but not where a held side or
   * another body covers it. Each has the part theta/2 pi of a site's volume, theta the angle outside the outline there (Heck
   * 2017, 2.5.1), times the length of outline that is its own over the spacing.
   *
   * Volumes: a lattice site's (of what lies on its side of a border, if asked for), or a Voronoi cell's; those of a body
   * whose exact volume is known, and which no other body's box overlaps, are scaled to sum up to it. Materials: fixed
   * particles beyond a side have that just inside it;
   * in rigid bodies it is 0 and means nothing.
   *
   * Each rank gets the particles whose id modulo the number of ranks is its own, by ascending ids, free ones first. Ids
   * are the same on any number of ranks, and those of free ones do not depend on @p reach; they are not consecutive.
   * Throws UserError: a spacing that does not fit, no particle in a body.
   * Collective.
   */
  template <int dim>
  ParticleSet<dim> arrange(const Scene<dim> &scene, const ArrangementSettings &settings,
                           const std::vector<Mover<dim>> &movers, double reach);

  /// Share of the particle's cell, a cube of side @p spacing about @p X, that lies in a region: sums over the particles
  /// then converge at second order. Exact for a box or layer, by 16^2 or 6^3 points for a ball; 1 or 0 for sets of
  /// materials, by the particle's. 0 for boundaries, and for the nearest particle, which the caller must find.
  template <int dim>
  double share_in_region(const Scene<dim> &scene, const Region<dim> &region, const dealii::Point<dim> &X,
                         unsigned int material, double spacing);
} // namespace Stroma::Particles
