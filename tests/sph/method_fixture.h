#pragma once

#include "../base/message_of.h"
#include "../particles/scene_fixture.h"

#include <stroma/solvers/step_control.h>
#include <stroma/sph/nsph_method.h>

/// A particle method with its particles to be seen.
template <typename Method>
struct Open : public Method
{
  using Method::Method;
  using Method::system;
};

/// Steps as long as the run up to @p end [s].
inline Stroma::Solvers::StepSettings
steps_to(const double end)
{
  Stroma::Solvers::StepSettings steps;
  steps.end_time = end;
  return steps;
}

/// @p n steps of @p dt [s].
inline Stroma::Solvers::StepSettings
steps_of(const double dt, const unsigned int n)
{
  auto steps         = steps_to(n * dt);
  steps.initial_step = steps.largest_step = dt;
  return steps;
}

/// What a plane scene is refused with by NSPH when it is set up; "" if it is not.
inline std::string
message_of_setup(const std::string &text)
{
  return message_of([&] {
    ParticleScene<2>           scene(text);
    Stroma::Timers             timers;
    Stroma::Sph::NsphMethod<2> method(scene.parameters, scene.scene, steps_to(1.), timers);
    method.setup(nullptr);
  });
}
