#pragma once

#include <stroma/base/log.h>
#include <stroma/fem/stokes_solver.h>
#include <stroma/simulation/method.h>
#include <stroma/solvers/time_scheme.h>

#include <memory>

namespace Stroma::Fem
{
  /**
   * Viscous flow by Taylor-Hood finite elements: Stokes' equations of the fluid at rest, incompressible or nearly so,
   * quasi-static or with inertia; see StokesSystem for the equations and StokesViscosity for the viscous stress. The mesh
   * stays where it is. Without inertia and compressibility every step is a steady flow, and one step is enough.
   *
   * Otherwise the fluid starts from zero pressure, and from the bodies' initial velocity with inertia. In two dimensions
   * all forces and flow rates are for the scene's thickness.
   */
  template <int dim>
  class StokesMethod : public Method
  {
  public:
    /// Declares and reads section Linear solver, and 'Scheme' in section FEM where the past matters. @p end_time [s].
    StokesMethod(Parameters &p, const Scene<dim> &scene, const Settings<dim> &settings, double end_time,
                 Timers &timers);

    void       setup(const Output::ArchiveReader *archive) override;
    StepStatus advance(double t, double t_next, StepWork &work) override;
    std::vector<std::pair<std::string, double>>      scalars() const override { return committed_scalars; }
    std::vector<std::pair<std::string, std::string>> write_fields(const FieldRequest &request) override;
    void                                             describe(Output::Summary &summary) override;
    void                                             save(Output::ArchiveWriter &archive) const override;
    std::vector<double>       times_to_meet() const override { return {}; }
    std::vector<SampledField> sampled_fields() const override;
    void                      sample(const std::vector<std::string> &fields, Samples &samples) override;
    Samples                   own_samples(const std::vector<std::string> &fields) override;
    std::vector<std::string>  known_point_fields() const override { return {}; }

  private:
    using Point = typename StokesSystem<dim>::Point;

    void        check_scene() const;
    bool        depends_on_past() const;
    void        start();
    StepStatus  use_rate(double rate);
    /// @param inner_step length of the step [s] in stages before its end in which velocities have rates, else 0
    StepStatus  solve_stage(StokesFlow &next, double t, double inner_step, const StokesRates &rates, StepWork &work);
    void        collect_scalars(const Vector &unbalanced);
    void        collect_reactions(const Vector &unbalanced);
    double      max_speed() const;
    void        error_results(Output::Summary &summary) const;
    void        load(const Output::ArchiveReader &archive);
    std::vector<std::uint64_t> names(const dealii::DoFHandler<dim> &dofs) const;
    void        append(const std::vector<std::string> &fields, const Point &q, std::vector<double> &values) const;

    const Scene<dim>             &scene;
    const Settings<dim>           settings;
    double                        end_time;
    Timers                       &timers;
    Solvers::LinearSolverSettings linear_settings;
    Solvers::TimeSchemeSettings   scheme;

    std::unique_ptr<Mesh<dim>>         mesh;
    std::unique_ptr<StokesSpace<dim>>  space;
    std::unique_ptr<StokesSystem<dim>> system;
    std::unique_ptr<StokesSolver>      solver;
    StokesMatrices                     matrices;
    double                             assembled_rate = -1.; ///< of the matrices [1/s]; negative: not assembled
    bool                               free_level     = false;

    // Committed state.
    StokesFlow flow;
    double     time = 0.; ///< [s]

    std::vector<std::pair<std::string, double>> committed_scalars;
  };
} // namespace Stroma::Fem
