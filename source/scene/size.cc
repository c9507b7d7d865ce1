#include <stroma/scene/size.h>

namespace Stroma
{
  template <int dim>
  double
  estimated_volume(const Scene<dim> &scene)
  {
    constexpr unsigned int n       = dim == 2 ? 64 : 16; // along each axis of a body's box
    constexpr unsigned int n_total = dim == 2 ? n * n : n * n * n;
    double                 volume  = 0.;
    for (unsigned int b = 0; b < scene.bodies.size(); ++b)
      {
        const auto &body = scene.bodies[b];
        if (body.rigid)
          continue;
        const auto   box    = body.bounding_box();
        unsigned int inside = 0;
        for (unsigned int i = 0; i < n_total; ++i)
          {
            dealii::Point<dim> X;
            for (unsigned int d = 0, rest = i; d < dim; ++d, rest /= n)
              X[d] = box.lower_bound(d) + (rest % n + .5) / n * box.side_length(d);
            inside += body.contains(X) && !scene.covered_by_later_body(b, X) && scene.material_at(X);
          }
        volume += box.volume() * inside / n_total;
      }
    return volume;
  }

  template double estimated_volume(const Scene<2> &);
  template double estimated_volume(const Scene<3> &);
} // namespace Stroma
