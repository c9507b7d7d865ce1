#pragma once

#include <limits>
#include <vector>

namespace Stroma
{
  class Parameters;
}

namespace Stroma::Solvers
{
  /// When and how far time advances. The defaults of the three steps are fractions of the end time.
  struct StepSettings
  {
    double       end_time        = 1.;   ///< [s]
    double       initial_step    = 1e-1; ///< [s]
    double       smallest_step   = 1e-6; ///< [s]
    double       largest_step    = 1.;   ///< [s]
    double       growth          = 2.;   ///< of an easy step
    unsigned int easy_iterations = 4;    ///< a step of at most so many Newton iterations is easy
    unsigned int hard_iterations = 12;   ///< after more than so many the next step is halved

    /// Declares and reads the entries in the current section. Throws UserError if the three steps contradict.
    void add(Parameters &p);
  };

  /**
   * Lengths of the steps of a run: longer after easy steps, half after hard or failed ones, and such that the end and
   * every time that must be met are met exactly, without slivers. Local, and the same on all ranks.
   */
  class StepControl
  {
  public:
    /// @param must_hit times to meet exactly [s], in any order; those outside (0, end) are ignored
    explicit StepControl(const StepSettings &settings, std::vector<double> must_hit = {});

    /// The time to step to from @p t [s], at most one step away. Bit for bit the end or a time of must_hit where the
    /// step ends there.
    double next(double t);

    /// The step to the last next() succeeded.
    /// @param longest that the method can take next, as far as it knows [s]
    void accept(unsigned int newton_iterations, double longest = std::numeric_limits<double>::max());

    /// The step to the last next() failed: halves it. False if it is now below the smallest allowed, so the run ends.
    bool reject();

    /// State for a checkpoint.
    std::vector<double> save() const;
    /// Takes what save() gave.
    void load(const std::vector<double> &state);

  private:
    double target(double t) const;

    StepSettings        settings;
    std::vector<double> must_hit; ///< ascending, the end time last
    double              step;     ///< wanted [s]
    double              taken;    ///< by the last next() [s]
  };
} // namespace Stroma::Solvers
