#pragma once

#include <stroma/base/log.h>
#include <stroma/base/parameters.h>
#include <stroma/scene/scene.h>
#include <stroma/simulation/method.h>
#include <stroma/solvers/step_control.h>

#include <memory>
#include <string>
#include <vector>

namespace Stroma
{
  /// A line of the table of methods. What the method can do it says itself, to Scene::require, as that depends on its settings.
  template <int dim>
  struct MethodEntry
  {
    std::string name;    ///< as 'Method' has it
    std::string meaning; ///< in a few words
    std::string section; ///< of its own settings

    /// Makes it, and reads its section and those of its solvers. Throws UserError for a scene that it cannot solve.
    std::unique_ptr<Method> (*make)(Parameters &p, const Scene<dim> &scene, const Solvers::StepSettings &steps,
                                    Timers &timers);

    /// Declares and checks the entries of its section alone, where a file has them for another run.
    void (*check_section)(Parameters &p, const Scene<dim> &scene);
  };

  /// The methods of this build, as CMake's STROMA_METHODS lists them; the first is the default. Each comes from
  /// `<name>_entry()` in source/<room>/entry.cc.
  template <int dim>
  const std::vector<MethodEntry<dim>> &methods();

  /// Names of the methods that this build has not; a scene's section of one has its name in capitals.
  const std::vector<std::string> &methods_left_out();

  /// Adds a method that is not of this build, such as one made up for a test, before a scene is read.
  template <int dim>
  void add_method(const MethodEntry<dim> &entry);
} // namespace Stroma
