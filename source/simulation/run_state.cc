#include <stroma/base/text.h>
#include <stroma/simulation/run_state.h>

#include <cstdlib>
#include <sstream>

namespace Stroma
{
  void
  RunState::add(const StepWork &work)
  {
    newton_iterations += work.newton_iterations;
    linear_iterations += work.linear_iterations;
    residual_evaluations += work.residual_evaluations;
  }

  void
  RunState::save(Output::ArchiveWriter &archive) const
  {
    archive.attribute("steps", std::uint64_t(steps));
    archive.attribute("field_files", std::uint64_t(field_files));
    archive.attribute("newton_iterations", newton_iterations);
    archive.attribute("linear_iterations", linear_iterations);
    archive.attribute("residual_evaluations", residual_evaluations);
    std::ostringstream text;
    text << std::hexfloat;
    for (const double number : step_control)
      text << number << ' ';
    archive.attribute("step_control", text.str());
  }

  void
  RunState::load(const Output::ArchiveReader &archive)
  {
    steps                = archive.attribute_uint64("steps");
    field_files          = archive.attribute_uint64("field_files");
    newton_iterations    = archive.attribute_uint64("newton_iterations");
    linear_iterations    = archive.attribute_uint64("linear_iterations");
    residual_evaluations = archive.attribute_uint64("residual_evaluations");
    step_control.clear();
    std::istringstream text(archive.attribute_string("step_control"));
    for (std::string hex; text >> hex;)
      step_control.push_back(std::strtod(hex.c_str(), nullptr));
  }

  void
  RunState::describe(Output::Summary &summary) const
  {
    summary.n_steps              = steps;
    summary.newton_iterations    = newton_iterations;
    summary.linear_iterations    = linear_iterations;
    summary.residual_evaluations = residual_evaluations;
  }

  std::string
  RunState::progress(const StepWork &work, const double from, const double now, const double to,
                     const double gone) const
  {
    const double done = (now - from) / (to - from);
    char         line[200];
    std::snprintf(line, sizeof(line),
                  "  step %u: t = %.6g s (%.0f %%), %u Newton, %u CG iterations; %s gone, about %s left", steps, now,
                  100 * now / to, work.newton_iterations, work.linear_iterations, duration(gone).c_str(),
                  duration(gone * (1 - done) / done).c_str());
    return line;
  }
} // namespace Stroma
