#include <stroma/mpm/loads.h>

#include <cmath>

namespace Stroma::Mpm
{
  template <int dim>
  LoadedPoints<dim>::LoadedPoints(const Scene<dim> &scene, const Points<dim> &points)
    : scene(scene)
    , points(points)
    , bodies(scene.bounding_box())
  {
    for (const auto &load : scene.loads)
      single.push_back(load.region.kind == Region<dim>::Kind::nearest ? points.nearest(load.region.first) :
                                                                        points.nobody);
  }

  template <int dim>
  bool
  LoadedPoints<dim>::is_chosen(const unsigned int l, const dealii::types::particle_index id,
                               const dealii::Point<dim> &X, const double *numbers) const
  {
    const auto &region = scene.loads[l].region;
    return region.kind == Region<dim>::Kind::nearest ? id == single[l] :
                                                       region.contains(X, points.material_of(numbers), bodies);
  }

  template <int dim>
  void
  LoadedPoints<dim>::mark(Points<dim> &all) const
  {
    for (auto &point : all.handler)
      {
        const auto numbers = point.get_properties();
        const auto X       = all.initial_place(point.get_location(), numbers.data());
        for (unsigned int l = 0; l < scene.loads.size(); ++l)
          if (is_chosen(l, point.get_id(), X, numbers.data()))
            numbers[all.load.first] += std::ldexp(1., l);
      }
  }

  template <int dim>
  Loads<dim>::Loads(const Scene<dim> &scene, const Points<dim> &points, ActiveCells<dim> &cells)
    : scene(scene)
    , points(points)
    , cells(cells)
    , densities(scene)
    , loaded(scene, points)
  {
    for (unsigned int l = 0; l < scene.loads.size(); ++l)
      {
        if (scene.loads[l].region.kind == Region<dim>::Kind::body)
          continue;          // see Rigid::Unknowns
        long double sum = 0; // resets change the order of the points and their ranks: no digit of a double may tell
        for (const auto &point : points.handler)
          {
            const auto numbers = point.get_properties();
            const auto X       = points.initial_place(point.get_location(), numbers.data());
            if (loaded.bears(l, point.get_id(), X, numbers.data()))
              sum += numbers[points.volume.first];
          }
        densities.measure(l, sum);
        densities.require(l, "material point");
      }
  }

  template <int dim>
  void
  Loads<dim>::assemble(const double t, Vector &force)
  {
    force = 0.;
    cells.add_nodal(force, [&](std::vector<double> &nodal) {
      for_each(t, [&](const ActiveCell<dim> &active, const auto &point, const dealii::Tensor<1, dim> &F_ext) {
        const auto shapes = cells.shapes(active, point.get_reference_location());
        for (unsigned int a = 0; a < cells.n_nodes; ++a)
          for (unsigned int c = 0; c < dim; ++c)
            nodal[active.node[a] + c] += shapes.value[a] * F_ext[c];
      });
    });
    force.compress(dealii::VectorOperation::add);
  }

  template class LoadedPoints<2>;
  template class LoadedPoints<3>;
  template class Loads<2>;
  template class Loads<3>;
} // namespace Stroma::Mpm
