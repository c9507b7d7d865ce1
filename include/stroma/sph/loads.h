#pragma once

#include <stroma/scene/scene.h>
#include <stroma/sph/neighbours.h>

namespace Stroma::Sph
{
  /// The scene's body forces on particles, and the supports that hold particles of the material itself.
  template <int dim>
  class Loads
  {
  public:
    /// Measures the loads on the particles at the start or at a restart. Throws UserError for a load or support that acts on
    /// no particle. Collective. @param spacing [m]
    Loads(const Scene<dim> &scene, const Particles<dim> &particles, double spacing);

    /// After particles have changed places in memory: finds again what acts on which. Local.
    void find(const Particles<dim> &particles);

    /// Forces of time @p t on the free particles [N over the thickness]. Local.
    const std::vector<dealii::Tensor<1, dim>> &force(const Particles<dim> &particles, double t);

    const std::vector<dealii::Tensor<1, dim>> &last_force() const { return forces; }

    /// A material particle that a support holds.
    struct Held
    {
      unsigned int particle, support;
    };
    const std::vector<Held> &held() const { return held_particles; }

    /// Whether component @p c of free particle @p i is held.
    bool is_held(const unsigned int i, const unsigned int c) const { return !mask.empty() && (mask[i] >> c & 1); }
    bool holds_any() const { return any_held; } ///< on any rank

    /// Velocity that moves a held particle from @p t to @p t_next [m/s]. Local.
    dealii::Tensor<1, dim> velocity(const Held &held, const Particles<dim> &particles, double t, double t_next) const;

  private:
    struct Share
    {
      unsigned int particle;
      double       volume; ///< of the particle's undeformed volume [m^dim]
    };
    std::vector<Share> shares(const Region<dim> &region, const Particles<dim> &particles) const;
    std::uint64_t      nearest(const Region<dim> &region, const Particles<dim> &particles) const;
    bool               is_on(const Region<dim> &region, unsigned int index, const Particles<dim> &particles, unsigned int i) const;

    const Scene<dim>               &scene;
    dealii::BoundingBox<dim>        box;
    double                          spacing;
    bool                            time_dependent = false, any_held = false;
    std::vector<double>             measure;         ///< of each load: undeformed volume that it acts on [m^dim]
    std::vector<std::uint64_t>      nearest_loaded;  ///< id of the particle of each load on 'nearest'
    std::vector<std::uint64_t>      nearest_held;    ///< and of each support
    std::vector<std::vector<Share>> loaded;          ///< particles of each load
    std::vector<Held>               held_particles;
    std::vector<std::uint8_t>       mask; ///< components held of each free particle; empty if none is
    std::vector<dealii::Tensor<1, dim>> forces;
    double                          force_time = std::nan("");
  };
} // namespace Stroma::Sph
