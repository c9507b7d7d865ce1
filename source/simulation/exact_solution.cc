#include <stroma/simulation/exact_solution.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace Stroma
{
  namespace
  {
    bool
    contains(const std::vector<std::string> &names, const std::string &name)
    {
      return std::find(names.begin(), names.end(), name) != names.end();
    }
  } // namespace

  template <int dim>
  ExactSolution<dim>::ExactSolution(const Scene<dim> &scene)
    : scene(scene)
    , step(1e-5 * scene.bounding_box().side_length(0))
  {}

  template <int dim>
  bool
  ExactSolution<dim>::given() const
  {
    return scene.exact_displacement.given() || scene.exact_velocity.given() || scene.exact_pressure.given();
  }

  template <int dim>
  bool
  ExactSolution<dim>::has(const std::string &name) const
  {
    if (name == "displacement_m" || name == "displacement_gradient")
      return scene.exact_displacement.given();
    if (name == "velocity_m_per_s" || name == "velocity_gradient_per_s")
      return scene.exact_velocity.given();
    return (name == "pressure_Pa" && scene.exact_pressure.given()) ||
           (name == "von_mises_Pa" && scene.exact_von_mises.given());
  }

  template <int dim>
  void
  ExactSolution<dim>::fill(const std::string &name, const Output::Place &X, const double time, double *values) const
  {
    const auto point = Output::point_of<dim>(X);
    if (name == "pressure_Pa" || name == "von_mises_Pa")
      {
        *values = (name == "pressure_Pa" ? scene.exact_pressure : scene.exact_von_mises).value(point, time)[0];
        return;
      }
    const auto &vector = name.rfind("velocity", 0) == 0 ? scene.exact_velocity : scene.exact_displacement;
    const auto  at     = [&](const unsigned int d, const double i) {
      return vector.value(point + i * step * dealii::Point<dim>::unit_vector(d), time);
    };
    if (name.find("gradient") == std::string::npos)
      {
        const auto value = vector.value(point, time);
        std::copy(value.begin_raw(), value.end_raw(), values);
        return;
      }
    for (unsigned int d = 0; d < dim; ++d)
      {
        const auto slope = (8. * (at(d, 1) - at(d, -1)) - (at(d, 2) - at(d, -2))) / (12. * step);
        for (unsigned int c = 0; c < dim; ++c)
          values[c * dim + d] = slope[c];
      }
  }

  template <int dim>
  void
  ExactSolution<dim>::add_errors(const Output::StateView &state, const std::vector<std::string> &known,
                                 const double time, std::map<std::string, double> &results) const
  {
    for (const std::string field :
         {"displacement", "displacement_gradient", "velocity", "velocity_gradient", "pressure"})
      {
        const Output::StateFields fields(dim, {field});
        const std::string         name = fields.list()[0].name, of = field.substr(0, field.find('_'));
        if (!has(name) || !contains(known, field))
          continue;
        std::vector<double> value(fields.width()), exact(fields.width()),
          sums(5); // |e|^2 V, |exact|^2 V; e V, exact V, V
        state.for_each_point([&](const Output::PointState &point) {
          if (point.is_fixed)
            return;
          fields.fill(point, value.data());
          fill(name, point.X, time, exact.data());
          for (unsigned int c = 0; c < value.size(); ++c)
            {
              sums[0] += point.V0 * std::pow(value[c] - exact[c], 2);
              sums[1] += point.V0 * std::pow(exact[c], 2);
            }
          sums[2] += point.V0 * (value[0] - exact[0]);
          sums[3] += point.V0 * exact[0];
          sums[4] += point.V0;
        });
        dealii::Utilities::MPI::sum(sums, scene.comm, sums);
        if (field == "pressure" && state.pressure_level_is_free())
          {
            sums[0] -= sums[2] * sums[2] / sums[4];
            sums[1] -= sums[3] * sums[3] / sums[4];
          }
        results[of + "_error_" + (of == field ? "L2" : "H1") + "_relative"] = std::sqrt(sums[0] / sums[1]);
      }
  }

  template class ExactSolution<2>;
  template class ExactSolution<3>;
} // namespace Stroma
