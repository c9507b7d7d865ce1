#include <stroma/mpm/loads.h>

namespace Stroma::Mpm
{
  template <int dim>
  Loads<dim>::Loads(const Scene<dim> &scene, const Points<dim> &points, ActiveCells<dim> &cells)
    : scene(scene)
    , points(points)
    , cells(cells)
    , densities(scene)
  {
    const auto bodies = scene.bounding_box();
    for (unsigned int l = 0; l < scene.loads.size(); ++l)
      {
        const auto &load = scene.loads[l];
        single.push_back(load.region.kind == Region<dim>::Kind::nearest ?
                           static_cast<long long>(points.nearest(load.region.first)) :
                           -1);
        if (single.back() >= 0 || load.region.kind == Region<dim>::Kind::body)
          continue;          // see Rigid::Unknowns
        long double sum = 0; // resets change the order of the points and their ranks: no digit of a double may tell
        for (const auto &point : points.handler)
          {
            const auto numbers = point.get_properties();
            const auto X       = points.initial_place(point.get_location(), numbers.data());
            if (load.region.contains(X, points.material_of(numbers.data()), bodies))
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

  template class Loads<2>;
  template class Loads<3>;
} // namespace Stroma::Mpm
