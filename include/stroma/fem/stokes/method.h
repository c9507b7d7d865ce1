#pragma once

#include <stroma/base/log.h>
#include <stroma/fem/stokes/free_bodies.h>
#include <stroma/fem/stokes/solver.h>
#include <stroma/rigid/motion.h>
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

    void                               setup(const Output::ArchiveReader *archive) override;
    StepStatus                         advance(double t, double t_next, StepWork &work) override;
    void                               describe(Output::Summary &summary) override;
    void                               save(Output::ArchiveWriter &archive) const override;
    std::unique_ptr<Output::StateView> state(bool with_gradients) override;
    std::string                        write_grid(const Output::FieldRequest &request) override;

  private:
    class View;
    using Point = typename StokesSystem<dim>::Point;

    void       check_scene() const;
    bool       depends_on_past() const;
    void       start();
    StepStatus use_rate(double rate);
    /// Solves for what @p flow, with the velocities that are imposed on it, lacks of the balance that leaves it @p r.
    StepStatus correct(StokesFlow &flow, StokesFlow &r, StepWork &work);
    StepStatus find_responses(double rate);
    void       move_free_bodies(StokesFlow &flow, double t, const StokesRates &rates);
    /// @param inner_step length of the step [s] in stages before its end in which velocities have rates, else 0
    StepStatus solve_stage(StokesFlow &next, double t, double inner_step, const StokesRates &rates, StepWork &work);
    void       collect_scalars(const Vector &unbalanced);
    void       collect_reactions(const Vector &unbalanced);
    double     max_speed() const;
    void       load(const Output::ArchiveReader &archive);
    std::vector<std::uint64_t> names(const dealii::DoFHandler<dim> &dofs) const;

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
    std::unique_ptr<FreeBodies<dim>>   free_bodies;
    StokesMatrices                     matrices;
    double                             assembled_rate = -1.; ///< of the matrices [1/s]; negative: not assembled
    bool                               free_level     = false;
    std::vector<StokesFlow>            responses; ///< flows of unit velocities of free bodies, at the assembled rate
    dealii::FullMatrix<double>         mobility;  ///< velocities of forces on these bodies [m/(N s)]
    std::vector<double>                of_bodies; ///< their velocities in the last stage

    // Committed state.
    StokesFlow                      flow;
    std::vector<Rigid::Motion<dim>> rigid; ///< by the scene's rigid bodies; the mesh does not follow them
  };
} // namespace Stroma::Fem
