#pragma once

#include <stroma/particles/neighbours.h>
#include <stroma/scene/loads.h>
#include <stroma/sph/settings.h>

namespace Stroma::Sph
{
  using namespace Particles;

  /// The scene's body forces on particles, and the supports that hold particles of the material itself. Loads are those of the
  /// places where a fluid is now, as with finite elements, whose mesh a fluid flows through; of solids, of undeformed places.
  template <int dim>
  class Loads
  {
  public:
    /// Measures the loads on the particles at the start or at a restart. Throws UserError for a load or support that acts on
    /// no particle, and where two supports hold one particle and contradict each other. Collective.
    /// @param spacing [m] @param end_time of the run [s]
    Loads(const Scene<dim> &scene, const ParticleSet<dim> &particles, double spacing, double end_time);

    /// After a search for neighbours, in which particles change places in memory: finds again what acts on which. Collective.
    void find(const ParticleSet<dim> &particles);

    /// Forces of time @p t on the free particles [N over the thickness]. Local.
    const std::vector<dealii::Tensor<1, dim>> &force(const ParticleSet<dim> &particles, double t);

    /// Of the undeformed volume; a fluid's total force is spread over what is in its region now.
    LoadDensities<dim> densities;

    const std::vector<dealii::Tensor<1, dim>> &
    last_force() const
    {
      return forces;
    }

    /// A material particle that a support holds. Of several that hold a component the first one in the file counts.
    struct Held
    {
      unsigned int particle, support;
      std::uint8_t components; ///< bit c: whether this support holds component c

      bool
      holds(const unsigned int c) const
      {
        return components >> c & 1;
      }
    };
    const std::vector<Held> &
    held() const
    {
      return held_particles;
    }

    /// Whether component @p c of free particle @p i is held.
    bool
    is_held(const unsigned int i, const unsigned int c) const
    {
      return !mask.empty() && (mask[i] >> c & 1);
    }
    bool
    holds_any() const
    {
      return any_held;
    } ///< on any rank

    /// Velocity that moves a held particle from @p t to @p t_next [m/s]. Local.
    dealii::Tensor<1, dim> velocity(const Held &held, const ParticleSet<dim> &particles, double t, double t_next) const;

  private:
    struct Share
    {
      unsigned int particle;
      double       volume; ///< of the particle's undeformed volume [m^dim]
    };
    void check_overlaps(const ParticleSet<dim> &particles, double end_time) const;
    /// What load @p load acts on when the particles are at @p places.
    std::vector<Share> found(unsigned int load, const ParticleSet<dim> &particles,
                             const std::vector<dealii::Point<dim>> &places) const;
    void               measure(unsigned int load, const std::vector<Share> &shares); ///< collective
    std::uint64_t      nearest(const Region<dim> &region, const ParticleSet<dim> &particles) const;
    bool is_on(const Region<dim> &region, unsigned int index, const ParticleSet<dim> &particles, unsigned int i) const;

    const Scene<dim>                   &scene;
    dealii::BoundingBox<dim>            box;
    double                              spacing;
    bool                                changes  = false; ///< whether forces do with time, or as a fluid moves
    bool                                any_held = false;
    std::vector<std::uint64_t>          nearest_loaded; ///< id of the particle of each load on 'nearest'
    std::vector<std::uint64_t>          nearest_held;   ///< and of each support
    std::vector<std::vector<Share>>     loaded;         ///< particles of each load
    std::vector<Held>                   held_particles;
    std::vector<std::uint8_t>           mask; ///< components held of each free particle; empty if none is
    std::vector<dealii::Tensor<1, dim>> forces;
    double                              force_time = std::nan("");
  };
} // namespace Stroma::Sph
