#include <stroma/base/text.h>
#include <stroma/scene/consistency.h>

#include <cmath>

namespace Stroma
{
  std::vector<double>
  sample_times(const double end_time)
  {
    constexpr double       golden = .6180339887498949;
    constexpr unsigned int n      = 40;
    std::vector<double>    times{0., .5 * end_time, end_time};
    for (unsigned int i = 1; i <= n; ++i)
      times.push_back((i * golden - std::floor(i * golden)) * end_time);
    return times;
  }

  namespace
  {
    /// What a support prescribes to a component: its velocity where @p of_velocity, else its displacement.
    template <int dim>
    double
    prescribed(const Scene<dim> &scene, const HeldPlace<dim> &held, const unsigned int component,
               const bool of_velocity, const double t, const double end_time)
    {
      if (held.support == scene.supports.size())
        return 0.;
      const auto &support = scene.supports[held.support];
      if (!of_velocity)
        return support.displacement.value(held.X, t, component);
      return support.velocity.given() ? support.velocity.value(held.X, t, component) :
                                        support.displacement.rate(held.X, t, component, -1e-6 * end_time);
    }
  } // namespace

  template <int dim>
  void
  check_agreement(const Scene<dim> &scene, const HeldPlace<dim> &a, const HeldPlace<dim> &b,
                  const unsigned int component, const double end_time)
  {
    if (a.support == b.support && a.X == b.X)
      return;
    const bool at_rest     = a.support == scene.supports.size();
    const bool of_velocity = scene.supports[b.support].velocity.given() ||
                             (!at_rest && scene.supports[a.support].velocity.given());
    const std::string unit = of_velocity ? " m/s" : " m";
    for (const double t : sample_times(end_time))
      {
        const double first  = prescribed(scene, a, component, of_velocity, t, end_time);
        const double second = prescribed(scene, b, component, of_velocity, t, end_time);
        const double grain  = of_velocity ? 1e-6 * (std::abs(first) + std::abs(second)) :
                                            1e-9 * scene.bounding_box().side_length(0);
        if (std::abs(first - second) <= grain)
          continue;
        if (at_rest)
          throw UserError(scene.supports[b.support].where,
                          "support '" + scene.supports[b.support].name +
                            "' moves the surface of a rigid body that is at rest; " +
                            "move the body too, by a support on 'body NAME', or let the support not reach it");
        const auto       &name   = scene.supports[a.support].name;
        const std::string motion = ": at t = " + brief(t) + " s one moves a shared node by " + brief(first) + unit +
                                   " along " + "xyz"[component] + ", the other by " + brief(second) + unit +
                                   "; make them agree or ";
        throw UserError(scene.supports[b.support].where,
                        a.support == b.support ?
                          "support '" + name + "' contradicts itself on a rigid body or on sides that repeat" + motion +
                            "let it not depend on place there" :
                          "supports '" + name + "' and '" + scene.supports[b.support].name + "' contradict each other" +
                            motion + "free one of them");
      }
  }

  template void check_agreement(const Scene<2> &, const HeldPlace<2> &, const HeldPlace<2> &, unsigned int, double);
  template void check_agreement(const Scene<3> &, const HeldPlace<3> &, const HeldPlace<3> &, unsigned int, double);
} // namespace Stroma
