#include <stroma/mpm/cell_points.h>
#include <stroma/scene/rheology.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Mpm
{
  template <int dim>
  CellPoints<dim>::CellPoints(const Scene<dim> &scene, const Points<dim> &points, const BackgroundGrid<dim> &grid,
                              const Settings<dim> &settings)
    : MaterialBlock(Materials::pointers_to(scene.materials))
    , is_viscous(Stroma::is_viscous(scene))
    , scene(scene)
    , points(points)
    , settings(settings)
    , count(scene.materials.size())
    , next(scene.materials.size())
  {
    for (unsigned int d = 0; d < dim; ++d)
      inverse_size[d] = 1. / grid.box().cell_size[d];
  }

  template <int dim>
  void
  CellPoints<dim>::resize(const unsigned int n)
  {
    MaterialBlock::resize(n);
    if (V.size() >= n)
      return;
    V.resize(n);
    shape.resize(n, Shape(dealii::Point<dim>(), inverse_size));
    g.resize(n);
    F_D.resize(n);
    if (is_viscous)
      {
        L.resize(n);
        J.resize(n);
      }
    values.resize(n);
    location.resize(n);
  }

  template <int dim>
  void
  CellPoints<dim>::order_by_material(const typename Handler::particle_iterator_range &range)
  {
    std::fill(count.begin(), count.end(), 0);
    unsigned int n = 0;
    for (const auto &point : range)
      {
        ++count[points.material_of(point.get_properties().data())];
        ++n;
      }
    resize(n);
    runs.clear();
    unsigned int begin = 0;
    for (unsigned int m = 0; m < count.size(); ++m)
      {
        next[m] = begin;
        if (count[m] > 0)
          runs.push_back({m, begin, begin + count[m]});
        begin += count[m];
      }
  }

  template <int dim>
  StepStatus
  CellPoints<dim>::gather(const typename dealii::Triangulation<dim>::active_cell_iterator &cell, const Nodal &u,
                          const Nodal *v)
  {
    // The handler's range has no const version that gives writable numbers; gathering itself writes nothing.
    auto      &handler = const_cast<Handler &>(points.handler);
    const auto range   = handler.particles_in_cell(cell);
    order_by_material(range);

    StepStatus status = StepStatus::ok;
    for (auto &point : range)
      {
        const auto         numbers = point.get_properties();
        const unsigned int p       = next[points.material_of(numbers.data())]++;
        values[p]                  = numbers.data();
        location[p]                = point.get_location();
        V[p]                       = numbers[points.volume.first];
        shape[p]                   = Shape(point.get_reference_location(), inverse_size);

        dealii::Tensor<2, dim> &f = F_D[p];
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int k = 0; k < dim; ++k)
            f[i][k] = (i == k) + Solid::sum<dim>(u[i] * shape[p].gradient[k]);

        const double J_D = determinant(f);
        if (!std::isfinite(J_D))
          status = worse(status, StepStatus::not_finite);
        else if (J_D <= 0)
          status = worse(status, StepStatus::inverted_point);

        if (settings.internal_force == InternalForce::consistent)
          {
            const auto inverse = invert(f);
            for (unsigned int k = 0; k < dim; ++k)
              {
                g[p][k] = inverse[0][k] * shape[p].gradient[0];
                for (unsigned int K = 1; K < dim; ++K)
                  g[p][k] += inverse[K][k] * shape[p].gradient[K];
              }
          }
        else
          g[p] = shape[p].gradient;

        find_deformation(p);
        if (is_viscous)
          find_velocity_gradient(p, v);
      }
    gather_history([&](const unsigned int p) { return values[p] + points.history.first; });
    if (settings.projected && status == StepStatus::ok)
      project_dilatation();
    return status;
  }

  /// F = F_D F^r (2).
  template <int dim>
  inline void
  CellPoints<dim>::find_deformation(const unsigned int p)
  {
    dealii::Tensor<2, dim> total = F_D[p];
    if (points.deformation.stored())
      {
        dealii::Tensor<2, dim> stored;
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int k = 0; k < dim; ++k)
            stored[i][k] = values[p][points.deformation.first + i * dim + k];
        total = F_D[p] * stored;
      }
    F[p] = 0.;
    if constexpr (dim == 2)
      F[p][2][2] = 1.;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int k = 0; k < dim; ++k)
        F[p][i][k] = total[i][k];
  }

  template <int dim>
  void
  CellPoints<dim>::find_velocity_gradient(const unsigned int p, const Nodal *v)
  {
    J[p] = determinant(F[p]);
    L[p] = 0.;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int k = 0; k < dim; ++k)
        if (v != nullptr)
          L[p][i][k] = Solid::sum<dim>((*v)[i] * g[p][k]);
        else if (points.velocity_gradient.stored())
          L[p][i][k] = values[p][points.velocity_gradient.first + i * dim + k];
  }

  template <int dim>
  void
  CellPoints<dim>::keep_history()
  {
    store_history([&](const unsigned int p) { return values[p] + points.history.first; });
  }

  /// F becomes Fbar: ln J its mean over the cell.
  template <int dim>
  void
  CellPoints<dim>::project_dilatation()
  {
    double volume = 0, mean = 0;
    g_mean = {};
    for (unsigned int p = 0; p < size; ++p)
      {
        volume += V[p];
        mean += V[p] * std::log(determinant(F[p]));
        for (unsigned int k = 0; k < dim; ++k)
          g_mean[k] += V[p] * g[p][k];
      }
    mean /= volume;
    for (auto &gradient : g_mean)
      gradient /= volume;
    for (unsigned int p = 0; p < size; ++p)
      {
        const double factor = std::exp((mean - std::log(determinant(F[p]))) / dim);
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int k = 0; k < dim; ++k)
            F[p][i][k] *= factor;
      }
  }

  template class CellPoints<2>;
  template class CellPoints<3>;
} // namespace Stroma::Mpm
