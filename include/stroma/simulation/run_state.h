#pragma once

#include <stroma/output/archive.h>
#include <stroma/output/summary.h>
#include <stroma/simulation/method.h>

namespace Stroma
{
  /// What a run goes on from besides the state of its method.
  struct RunState
  {
    unsigned int        steps = 0, field_files = 0; ///< so far
    std::uint64_t       newton_iterations = 0, linear_iterations = 0, residual_evaluations = 0;
    std::vector<double> step_control; ///< StepControl::save()

    void add(const StepWork &work);
    void save(Output::ArchiveWriter &archive) const;
    void load(const Output::ArchiveReader &archive);
    void describe(Output::Summary &summary) const;

    /// A line on the step taken last, with the time left. @param from, now, to times of the run [s] @param gone seconds that it took
    std::string progress(const StepWork &work, double from, double now, double to, double gone) const;
  };
} // namespace Stroma
