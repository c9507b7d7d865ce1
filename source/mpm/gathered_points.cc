#include <stroma/mpm/gathered_points.h>
#include <stroma/scene/rheology.h>

#include <algorithm>

namespace Stroma::Mpm
{
  template <int dim>
  GatheredPoints<dim>::GatheredPoints(const Scene<dim> &scene, const Points<dim> &points)
    : MaterialBlock(Materials::pointers_to(scene.materials))
    , is_viscous(Stroma::is_viscous(scene))
    , points(points)
    , scene(scene)
    , count(scene.materials.size())
    , next(scene.materials.size())
  {}

  template <int dim>
  void
  GatheredPoints<dim>::resize(const unsigned int n)
  {
    MaterialBlock::resize(n);
    if (V.size() >= n)
      return;
    V.resize(n);
    F_D.resize(n);
    if (is_viscous)
      {
        L.resize(n);
        J.resize(n);
      }
    values.resize(n);
    location.resize(n);
    xi.resize(n);
  }

  /// Runs and the place of each material's first point, from how many there are.
  template <int dim>
  void
  GatheredPoints<dim>::order_by_material()
  {
    runs.clear();
    unsigned int begin = 0;
    for (unsigned int m = 0; m < count.size(); ++m)
      {
        next[m] = begin;
        if (count[m] > 0)
          runs.push_back({m, begin, begin + count[m]});
        begin += count[m];
      }
    resize(begin);
  }

  /// Places and stored numbers of the points of a cell, and their history.
  template <int dim>
  void
  GatheredPoints<dim>::gather_points(const ActiveCell<dim> &active)
  {
    // The handler's range has no const version that gives writable numbers; gathering itself writes nothing.
    auto      &handler = const_cast<typename Points<dim>::Handler &>(points.handler);
    const auto range   = handler.particles_in_cell(active.cell);
    std::fill(count.begin(), count.end(), 0);
    for (const auto &point : range)
      ++count[points.material_of(point.get_properties().data())];
    order_by_material();
    for (auto &point : range)
      {
        const auto         numbers = point.get_properties();
        const unsigned int p       = next[points.material_of(numbers.data())]++;
        values[p]                  = numbers.data();
        location[p]                = point.get_location();
        xi[p]                      = point.get_reference_location();
        V[p]                       = numbers[points.volume.first];
        if (points.weight.stored())
          V[p] *= numbers[points.weight.first];
      }
    gather_history([&](const unsigned int p) { return values[p] + points.history.first; });
  }

  template <int dim>
  void
  GatheredPoints<dim>::gather_found(const ActiveCell<dim> &active, const TwoMomentPoints<dim> &standing)
  {
    std::fill(count.begin(), count.end(), 0);
    standing.for_parts(active.number, [&](const auto &part) { count[part.material] = part.n_points; });
    order_by_material();
    points.for_points_of(active, [&](const dealii::Point<dim> &place, const dealii::Point<dim> &X, const unsigned int m,
                                     const double volume) {
      const unsigned int p = next[m]++;
      location[p]          = X;
      xi[p]                = place;
      V[p]                 = volume;
    });
  }

  template <int dim>
  void
  GatheredPoints<dim>::gather_standing(const TwoMomentPoints<dim> &standing, const unsigned int number)
  {
    runs.clear();
    unsigned int n = 0;
    standing.for_parts(number, [&](const auto &part) { n += part.end - part.begin; });
    resize(n);
    n = 0;
    standing.for_parts(number, [&](const auto &part) {
      const unsigned int size = part.end - part.begin;
      runs.push_back({part.material, n, n + size});
      std::copy_n(&standing.xi[part.begin], size, &xi[n]);
      std::copy_n(&standing.V[part.begin], size, &V[n]);
      n += size;
    });
  }

  template <int dim>
  void
  GatheredPoints<dim>::keep_history()
  {
    store_history([&](const unsigned int p) { return values[p] + points.history.first; });
  }

  template class GatheredPoints<2>;
  template class GatheredPoints<3>;
} // namespace Stroma::Mpm
