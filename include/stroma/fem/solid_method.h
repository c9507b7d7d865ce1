#pragma once

#include <stroma/fem/solid_system.h>
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

    void       setup(const Output::ArchiveReader *archive) override;
    StepStatus advance(double t, double t_next, StepWork &work) override;
    std::vector<std::pair<std::string, double>>      scalars() const override { return committed_scalars; }
    std::vector<std::pair<std::string, std::string>> write_fields(const FieldRequest &request) override;
    void                                             describe(Output::Summary &summary) override;
    void                                             save(Output::ArchiveWriter &archive) const override;
    std::vector<double>                              times_to_meet() const override { return {}; }
    std::vector<std::string>                         known_point_fields() const override;
    std::vector<SampledField>                        sampled_fields() const override;
    void    sample(const std::vector<std::string> &fields, Samples &samples) override;
    Samples own_samples(const std::vector<std::string> &fields) override;

  private:
    void       build();
    void       allocate();
    void       find_free_parts();
    void       refine_by_error();
    StepStatus start();
    StepStatus solve_stage(const Solvers::Stage &stage, double t, double t_next, Vector &u, StepWork &work);
    StepStatus fail(StepStatus status);
    /// @param balanced displacement at which the forces of contact were brought into balance
    void       collect_scalars(const Vector &balanced);
    void       load(const Output::ArchiveReader &archive);
    void       error_results(Output::Summary &summary);
    void       stress_results(Output::Summary &summary);
    void       set_initial_velocity();

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
    Vector          last_increment; ///< of the last step, for the next first guess; empty if there is none
    double          last_dt = 0.;   ///< of last_increment [s]
    double          time    = 0.;   ///< [s]
    unsigned int    n_free_parts = 0;

    std::vector<std::pair<std::string, double>> committed_scalars;
    Solvers::RoundOffCount                      below_round_off;
  };
} // namespace Stroma::Fem
