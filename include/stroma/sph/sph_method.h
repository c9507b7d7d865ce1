#pragma once

#include <stroma/sph/energy_flow.h>
#include <stroma/sph/particle_method.h>

namespace Stroma::Sph
{
  /**
   * Inertial smoothed particle hydrodynamics: velocities follow from m dv/dt = f, explicitly, by the symplectic Euler scheme.
   * A step of the scene is divided into equal parts that are stable: not longer than (34) of Heck 2017 and Courant's limit.
   * Pair geometry is found anew once a particle has moved by a thousandth of the spacing.
   */
  template <int dim>
  class SphMethod : public ParticleMethod<dim>
  {
  public:
    SphMethod(Parameters &p, const Scene<dim> &scene, double end_time, Timers &timers);

    void       setup(const Output::ArchiveReader *archive) override;
    StepStatus advance(double t, double t_next, StepWork &work) override;
    void       save(Output::ArchiveWriter &archive) const override;

    /// The smaller of (34) of Heck 2017 and Courant's limit [s] in material @p m, and in all.
    double step_limit(unsigned int m) const;
    double step_limit() const;
    /// The same from the largest rates of friction and stiffness of the particles as they are [s]: disorder, surfaces and
    /// walls count. Collective.
    double spectral_limit() const;

  private:
    using Velocities = typename System<dim>::Velocities;

    void prepare(const Output::ArchiveReader *archive) override;
    void describe_stepping(Output::Summary &summary) const override;
    /// @param on_walls visit(i, v, add) with the forces of the pairs of row i with walls, see BodyBalance
    /// @param of_bodies what resists bodies besides, or nothing
    template <typename AddForce, typename OnWalls>
    double     largest_rate(const AddForce &add_force, const OnWalls &on_walls,
                            const dealii::FullMatrix<double> &of_bodies) const;
    void       accelerate_bodies(const Velocities &v, double t, double dt);
    StepStatus go_to(double t, double t_next, unsigned int n);
    StepStatus refresh_geometry(double dt);
    void       accelerate(Velocities &v, double t, double dt);
    void       find_forces_apart(const Velocities &v, double t, double dt);
    void       set_initial_velocity();
    void       collect_energies();

    double              limit            = 0.; ///< [s]
    unsigned int        parts_to_refresh = 0;  ///< parts until the moves since the last geometry are looked at again
    Velocities          force;
    std::vector<double> on_bodies; ///< forces on the unknowns of BodyBalance

    std::unique_ptr<EnergyFlow<dim>> energy_flow; ///< of solids
  };
} // namespace Stroma::Sph
