#include <stroma/base/text.h>
#include <stroma/scene/reactions.h>

#include <cmath>

namespace Stroma
{
  template <int dim>
  std::vector<std::pair<std::string, double>>
  reaction_scalars(const Scene<dim> &scene, const std::vector<dealii::Tensor<1, dim>> &reactions, const double t)
  {
    std::vector<std::pair<std::string, double>> scalars;
    const auto                                  box = scene.bounding_box();
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      {
        const auto &support = scene.supports[s];
        const auto  axis    = support.region.axis;
        const bool  is_side = support.region.kind == Region<dim>::Kind::side;
        const bool  is_end  = is_side || support.region.kind == Region<dim>::Kind::layer;
        if (is_end && support.region.upper && support.displacement.given() && !support.displacement.is_free(axis))
          {
            auto end  = box.center();
            end[axis] = support.region.side_coordinate(box);
            scalars.emplace_back(std::string("strain_") + "xyz"[axis],
                                 support.displacement.value(end, t, axis) / box.side_length(axis));
          }
        for (unsigned int c = 0; c < dim; ++c)
          if (support.holds(c))
            scalars.emplace_back("reaction_" + support.name + "_" + "xyz"[c] + "_N", reactions[s][c]);
        if (is_side && !support.region.upper && support.holds(axis))
          scalars.emplace_back(std::string("reaction_force_") + "xyz"[axis] + "_N", std::abs(reactions[s][axis]));
      }
    return scalars;
  }

  template <int dim>
  void
  check_agreement(const Scene<dim> &scene, const unsigned int a, const unsigned int b, const dealii::Point<dim> &X,
                  const unsigned int component, const double end_time)
  {
    const double size = scene.bounding_box().side_length(0);
    for (const double part : {0., .5, 1.})
      {
        const double first  = scene.supports[a].displacement.value(X, part * end_time, component);
        const double second = scene.supports[b].displacement.value(X, part * end_time, component);
        if (std::abs(first - second) > 1e-9 * size)
          throw UserError(scene.supports[b].where,
                          "supports '" + scene.supports[a].name + "' and '" + scene.supports[b].name +
                            "' contradict each other: at t = " + brief(part * end_time) + " s one moves a shared node by " +
                            brief(first) + " m along " + "xyz"[component] + ", the other by " + brief(second) +
                            " m; make them agree or free one of them");
      }
  }

  template std::vector<std::pair<std::string, double>> reaction_scalars(const Scene<2> &,
                                                                        const std::vector<dealii::Tensor<1, 2>> &, double);
  template std::vector<std::pair<std::string, double>> reaction_scalars(const Scene<3> &,
                                                                        const std::vector<dealii::Tensor<1, 3>> &, double);
  template void check_agreement(const Scene<2> &, unsigned int, unsigned int, const dealii::Point<2> &, unsigned int, double);
  template void check_agreement(const Scene<3> &, unsigned int, unsigned int, const dealii::Point<3> &, unsigned int, double);
} // namespace Stroma
