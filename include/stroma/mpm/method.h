#pragma once

#include <stroma/mpm/system.h>
#include <stroma/simulation/method.h>
#include <stroma/solvers/linear_solver.h>
#include <stroma/solvers/newton.h>

#include <memory>

namespace Stroma::Mpm
{
  /**
   * The implicit material point method of Guilkey 2006, quasi-static or viscous without inertia: standard (grid reset after
   * every step), modified (never reset), or reset when distorted.
   */
  template <int dim>
  class MpmMethod : public Method
  {
  public:
    /// Declares and reads the sections MPM, Newton and Linear solver. @p end_time [s] of the scene.
    MpmMethod(Parameters &p, const Scene<dim> &scene, double end_time, Timers &timers);

    void                               setup(const Output::ArchiveReader *archive) override;
    StepStatus                         advance(double t, double t_next, StepWork &work) override;
    void                               describe(Output::Summary &summary) override;
    void                               save(Output::ArchiveWriter &archive) const override;
    std::unique_ptr<Output::StateView> state(bool with_gradients) override;
    std::string                        write_grid(const Output::FieldRequest &request) override;

  private:
    class View;

    StepStatus                 solve(const Solvers::Stage &stage, double t, Vector &next, StepWork &work);
    StepStatus                 solve_stages(double t, double t_next, Solvers::Motion &next, StepWork &work);
    Vector                     first_guess(double dt) const;
    void                       commit(double t);
    void                       reset_grid();
    void                       find_free_parts();
    ConnectedParts<dim>        connected_parts() const; ///< of the cells that hold points now
    void                       warn_of_sparse_points(double t);
    void                       allocate();
    void                       prepare_solver();
    bool                       assemble_instead();
    void                       log_choices() const;
    bool                       has_room_for_grid();
    void                       warn_of_few_points(const GridBox<dim> &box, bool drives_points) const;
    double                     assembled_up_to(bool drives_points) const;
    void                       collect_scalars(double t);
    void                       load_points(const Output::ArchiveReader &archive);
    void                       load_displacement(const Output::ArchiveReader &archive);
    void                       describe_parts(Output::Summary &summary) const;
    std::vector<std::uint64_t> unknown_names() const;

    const Scene<dim>             &scene;
    Timers                       &timers;
    double                        end_time;
    Settings<dim>                 settings;
    Solvers::NewtonSettings       newton_settings;
    Solvers::LinearSolverSettings linear_settings;
    std::string                   where_preconditioner; ///< place of the entry

    std::unique_ptr<BackgroundGrid<dim>>   grid;
    std::unique_ptr<Points<dim>>           points;
    std::unique_ptr<PrescribedMotion<dim>> motion;
    std::unique_ptr<System<dim>>           system;
    std::unique_ptr<Solvers::LinearSolver> linear_solver;
    std::unique_ptr<Solvers::TimeScheme>   scheme;
    Matrix                                 K;

    // Committed state, besides the points.
    Vector       u;                ///< grid displacement since the last rebase [m]
    Vector       v;                ///< grid velocity [m/s]; empty after a rebase and where nothing is viscous
    Vector       last_increment;   ///< of the last step, for the next first guess; empty if there is none
    double       last_dt     = 0.; ///< of last_increment [s]
    double       rebase_time = 0.; ///< time of the last rebase [s]
    unsigned int n_resets = 0, n_free_parts = 0;
    bool         is_assembled     = false; ///< the tangent, as geometric multigrid has failed
    unsigned int n_parts          = 0;     ///< in which the bodies hang together at the start, if the grid may be reset
    double       misfit           = 0.;    ///< System::misfit() of the last step, after resets
    bool         is_whole         = true;  ///< the grid holds them in no more parts since
    bool         sparse_told      = false; ///< the user knows that points have come too far apart
    bool         grid_is_left_out = false; ///< of field files, for want of memory; the user knows

    Solvers::RoundOffCount below_round_off;
  };
} // namespace Stroma::Mpm
