#include <stroma/base/parameters.h>
#include <stroma/base/text.h>
#include <stroma/solvers/step_control.h>

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Solvers
{
  void
  StepSettings::add(Parameters &p)
  {
    const double old_end = end_time;
    p.add("End", end_time, "time at which the run ends", "s", Range::positive());
    for (double *const step : {&initial_step, &smallest_step, &largest_step})
      *step *= end_time / old_end;
    p.add("Initial step", initial_step, "first step", "s", Range::positive());
    p.add("Smallest step", smallest_step, "a step cut below this ends the run", "s", Range::positive());
    p.add("Largest step", largest_step, "no step is longer", "s", Range::positive());
    p.add("Growth", growth, "factor on the step after an easy one", "", Range::at_least(1.));
    p.add("Easy iterations", easy_iterations, "Newton iterations up to which a step was easy");
    p.add("Hard iterations", hard_iterations, "Newton iterations beyond which the next step is halved");
    p.all_declared();
    if (smallest_step > initial_step)
      throw UserError(p.where("Smallest step"), "`Smallest step` is longer than `Initial step`; make it shorter.");
    if (initial_step > largest_step)
      throw UserError(p.where("Largest step"), "`Largest step` is shorter than `Initial step`; make it longer.");
    const double usual = growth > 1. ? largest_step : initial_step, most = std::pow(2., 32);
    if (!(end_time / usual <= most))
      throw UserError(p.where(growth > 1. ? "Largest step" : "Initial step"),
                      "the run would take " + brief(end_time / usual) + " steps, more than " + brief(most) +
                        "; make the steps longer or 'End' earlier");
    if (easy_iterations > hard_iterations)
      throw UserError(p.where("Easy iterations"), "`Easy iterations` exceeds `Hard iterations`; make it smaller.");
  }

  StepControl::StepControl(const StepSettings &settings, std::vector<double> times)
    : settings(settings)
    , step(settings.initial_step)
    , taken(settings.initial_step)
  {
    const double same = 1e-12 * settings.end_time;
    std::sort(times.begin(), times.end());
    for (const double time : times)
      if (time > same && time < settings.end_time - same && (must_hit.empty() || time > must_hit.back() + same))
        must_hit.push_back(time);
    must_hit.push_back(settings.end_time);
  }

  double
  StepControl::target(const double t) const
  {
    const auto later = std::upper_bound(must_hit.begin(), must_hit.end(), t);
    return later == must_hit.end() ? settings.end_time : *later;
  }

  double
  StepControl::next(const double t)
  {
    const double goal = target(t), rest = goal - t;
    const bool   last = rest <= step * (1. + 1e-6);
    taken             = last ? rest : std::min(step, .5 * rest); // two halves rather than a step and a sliver
    return last ? goal : t + taken;
  }

  void
  StepControl::accept(const unsigned int newton_iterations, const double longest)
  {
    if (newton_iterations > settings.hard_iterations)
      step = std::max(settings.smallest_step, .5 * std::min(step, taken));
    else if (newton_iterations <= settings.easy_iterations)
      step = std::min(settings.largest_step, std::max(step, settings.growth * taken));
    step = std::max(settings.smallest_step, std::min(step, longest));
  }

  bool
  StepControl::reject()
  {
    step = .5 * std::min(step, taken);
    return step >= settings.smallest_step;
  }

  std::vector<double>
  StepControl::save() const
  {
    return {step, taken};
  }

  void
  StepControl::load(const std::vector<double> &state)
  {
    AssertThrow(state.size() == 2, dealii::ExcDimensionMismatch(state.size(), 2));
    step  = state[0];
    taken = state[1];
  }
} // namespace Stroma::Solvers
