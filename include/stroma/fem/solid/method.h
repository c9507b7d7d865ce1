#pragma once

#include <stroma/fem/solid/system.h>
#include <stroma/simulation/method.h>
#include <stroma/solvers/newton.h>

#include <memory>

namespace Stroma::Fem
{
  /**
   * Finite elements for solids on a mesh that fits the bodies: the reference for the particle methods. Quasi-static,
   * viscous (Kelvin-Voigt) or dynamic, finite or small strains, contact with rigid balls.
   */
  template <int dim>
  class SolidMethod : public Method
  {
  public:
    /// Reads the sections Newton and Linear solver. @p end_time [s] of the scene.
    SolidMethod(Parameters &p, const Scene<dim> &scene, const Settings<dim> &settings, double end_time, Timers &timers);

    void                               setup(const Output::ArchiveReader *archive) override;
    StepStatus                         advance(double t, double t_next, StepWork &work) override;
    void                               describe(Output::Summary &summary) override;
    void                               save(Output::ArchiveWriter &archive) const override;
    std::unique_ptr<Output::StateView> state(bool with_gradients) override;
    std::string                        write_grid(const Output::FieldRequest &request) override;

  private:
    class View;

    void       build();
    void       allocate();
    void       find_free_parts();
    void       refine_by_error();
    StepStatus start();
    StepStatus solve_stage(const Solvers::Stage &stage, double t, double t_next, Vector &u, StepWork &work);
    StepStatus fail(StepStatus status);
    /// @param balanced displacement at which the forces of contact were brought into balance
    void   collect_scalars(const Vector &balanced);
    void   load(const Output::ArchiveReader &archive);
    double largest_displacement() const;
    void   set_initial_velocity();

    const Scene<dim>             &scene;
    Settings<dim>                 settings;
    Timers                       &timers;
    double                        end_time;
    Solvers::NewtonSettings       newton_settings;
    Solvers::LinearSolverSettings linear_settings;

    std::unique_ptr<Mesh<dim>>             mesh;
    std::unique_ptr<Unknowns<dim>>         unknowns;
    std::unique_ptr<SolidSystem<dim>>      system;
    std::unique_ptr<Solvers::LinearSolver> linear_solver;
    std::unique_ptr<Solvers::TimeScheme>   scheme;
    Matrix                                 K;

    // Committed state, besides what the system keeps.
    Solvers::Motion motion;
    Vector          last_increment;    ///< of the last step, for the next first guess; empty if there is none
    double          last_dt      = 0.; ///< of last_increment [s]
    unsigned int    n_free_parts = 0;

    Solvers::RoundOffCount below_round_off;
  };
} // namespace Stroma::Fem
