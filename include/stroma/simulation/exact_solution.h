#pragma once

#include <stroma/output/state_view.h>
#include <stroma/scene/scene.h>

#include <map>
#include <string>

namespace Stroma
{
  /// Section 'Exact solution' of a scene, by the names of fields.
  template <int dim>
  class ExactSolution
  {
  public:
    /// @p scene must outlive this.
    explicit ExactSolution(const Scene<dim> &scene);

    bool given() const; ///< of anything that errors are reported of

    /// Whether there is one of field @p name (with its unit).
    bool has(const std::string &name) const;

    /// Its components at @p X and @p time [s]; gradients by central differences of fourth order.
    void fill(const std::string &name, const Output::Place &X, double time, double *values) const;

    /// "displacement_error_L2_relative" and so on: errors of displacement, velocity (also of their gradients, H1) and
    /// pressure where the scene has the exact field and @p known names it, over the sample points. Collective.
    void add_errors(const Output::StateView &state, const std::vector<std::string> &known, double time,
                    std::map<std::string, double> &results) const;

  private:
    const Scene<dim> &scene;
    double            step; ///< of central differences [m]
  };
} // namespace Stroma
