#include <stroma/output/point_results.h>
#include <stroma/simulation/exact_solution.h>
#include <stroma/simulation/results.h>

#include <algorithm>

namespace Stroma
{
  namespace
  {
    Output::PointGroups
    by_material(const std::vector<std::string> &names, const std::vector<std::string> &fields)
    {
      return {names, [](const Output::PointState &point) { return point.material; }, fields};
    }

    /// The last body in the file that takes up the place of the point counts, if it is of the point's material: a border may cut voxels.
    template <int dim>
    Output::PointGroups
    by_body(const Scene<dim> &scene, const std::vector<std::string> &fields)
    {
      Output::PointGroups       groups;
      std::vector<unsigned int> bodies;
      for (unsigned int b = 0; b < scene.bodies.size(); ++b)
        if (!scene.bodies[b].rigid)
          {
            groups.names.push_back(body_result_name(scene.bodies[b].name));
            bodies.push_back(b);
          }
      groups.fields   = fields;
      groups.group_of = [&scene, bodies](const Output::PointState &point) {
        const auto X = Output::point_of<dim>(point.X);
        for (unsigned int g = bodies.size(); g-- > 0;)
          if (const auto &body = scene.bodies[bodies[g]];
              body.contains(X) && (body.is_image() || body.material == point.material))
            return g;
        return static_cast<unsigned int>(bodies.size());
      };
      return groups;
    }

    template <int dim>
    Output::PointRequest
    request_of(const Method &method, const Scene<dim> &scene, const OutputSettings &output)
    {
      const auto &known = method.facts.sampled_fields;
      const auto  has   = [&](const std::string &field) {
        return std::find(known.begin(), known.end(), field) != known.end();
      };
      Output::PointRequest request{dim, has("displacement"), has("velocity"), {}};
      request.groups.push_back(by_material(scene.material_names, output.by_material));
      if (!output.by_body.empty())
        request.groups.push_back(by_body(scene, output.by_body));
      return request;
    }
  } // namespace

  std::string
  body_result_name(const std::string &body)
  {
    return "body_" + body;
  }

  template <int dim>
  std::vector<Output::Histogram>
  add_results(Method &method, const Scene<dim> &scene, const OutputSettings &output, const double time,
              const Output::PointResults *const collected, std::map<std::string, double> &results)
  {
    const ExactSolution<dim>              exact(scene);
    const auto                            request = request_of(method, scene, output);
    std::unique_ptr<Output::StateView>    state;
    std::unique_ptr<Output::PointResults> own;
    if (collected == nullptr || exact.given())
      state = method.state(exact.given() || request.has_gradients());
    if (collected == nullptr)
      own = Output::add_point_results(*state, request, scene.comm, results);
    else
      collected->report(scene.comm, results);
    if (exact.given())
      exact.add_errors(*state, method.facts.sampled_fields, time, results);
    return (own ? *own : *collected).histograms(scene.comm);
  }

  template <int dim>
  std::unique_ptr<Output::PointResults>
  collect_results(Method &method, const Scene<dim> &scene, const OutputSettings &output)
  {
    const auto request = request_of(method, scene, output);
    if (request.has_gradients())
      return nullptr;
    return std::make_unique<Output::PointResults>(request, method.state(false)->n_points());
  }

#define INSTANTIATE(dim)                                                                                               \
  template std::vector<Output::Histogram> add_results(Method &, const Scene<dim> &, const OutputSettings &, double,    \
                                                      const Output::PointResults *, std::map<std::string, double> &);  \
  template std::unique_ptr<Output::PointResults> collect_results(Method &, const Scene<dim> &, const OutputSettings &);
  INSTANTIATE(2)
  INSTANTIATE(3)
#undef INSTANTIATE
} // namespace Stroma
