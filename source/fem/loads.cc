#include <stroma/fem/loads.h>

#include <deal.II/base/quadrature_lib.h>

#include <algorithm>
#include <limits>

namespace Stroma::Fem
{
  namespace
  {
    const auto needed = dealii::update_values | dealii::update_quadrature_points | dealii::update_JxW_values;
  } // namespace

  template <int dim>
  Loads<dim>::Loads(const Scene<dim> &scene, const Settings<dim> &settings, const Mesh<dim> &mesh,
                    const LoadedSpace<dim> &space, const std::vector<std::vector<SingleUnknown<dim>>> &single)
    : scene(scene)
    , settings(settings)
    , mesh(mesh)
    , space(space)
    , single(single)
    , bodies(scene.bounding_box())
    , whole(mesh.mapping(), space.fe, dealii::QGauss<dim>(settings.degree + 2), needed)
    , face(mesh.mapping(), space.fe, dealii::QGauss<dim - 1>(settings.degree + 2), needed)
    , densities(scene)
    , assembled_time(std::numeric_limits<double>::quiet_NaN())
  {
    for (unsigned int l = 0; l < scene.loads.size(); ++l)
      {
        const auto &load = scene.loads[l];
        steady &= !densities.depends_on_time(l);
        if (is_single(load))
          continue;
        double size = 0.;
        for_each_part(load, [&](const auto &, const auto &, const auto &, const std::vector<double> &parts) {
          for (const double part : parts)
            size += part;
        });
        densities.measure(l, size);
        densities.require(l, "part of the mesh");
      }
  }

  template <int dim>
  bool
  Loads<dim>::is_single(const Load<dim> &load) const
  {
    return load.region.kind == Region<dim>::Kind::nearest || load.region.kind == Region<dim>::Kind::body;
  }

  /// Balls, boxes and layers are convex: a cell with all vertices inside lies inside, and one beyond their bounds outside.
  template <int dim>
  bool
  Loads<dim>::is_cut(const Load<dim> &load, const Cell &cell) const
  {
    using Kind         = typename Region<dim>::Kind;
    const auto &region = load.region;
    if (region.kind == Kind::all || region.kind == Kind::material)
      return false;
    bool wholly = true;
    for (const unsigned int v : cell->vertex_indices())
      wholly &= region.contains(cell->vertex(v) + 1e-6 * (cell->center() - cell->vertex(v)), cell->material_id(),
                                bodies);
    if (wholly)
      return false;
    const auto box = cell->bounding_box(), around = region.bounds(bodies);
    for (unsigned int d = 0; d < dim; ++d)
      if (box.lower_bound(d) >= around.upper_bound(d) || box.upper_bound(d) <= around.lower_bound(d))
        return false;
    return true;
  }

  /// Points of a cell that the region's edge cuts.
  template <int dim>
  dealii::Quadrature<dim>
  Loads<dim>::cut_quadrature(const Load<dim> &load, const Cell &cell) const
  {
    if (!mesh.is_a_lattice() || load.region.kind == Region<dim>::Kind::ball)
      return dealii::QIterated<dim>(dealii::QGauss<1>(2), 16);
    const auto                box = cell->bounding_box(), around = load.region.bounds(bodies);
    const dealii::QGauss<dim> gauss(settings.degree + 2);
    auto                      points  = gauss.get_points();
    auto                      weights = gauss.get_weights();
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double lower = std::max(0., (around.lower_bound(d) - box.lower_bound(d)) / box.side_length(d));
        const double upper = std::min(1., (around.upper_bound(d) - box.lower_bound(d)) / box.side_length(d));
        for (unsigned int q = 0; q < points.size(); ++q)
          {
            points[q][d] = lower + (upper - lower) * points[q][d];
            weights[q] *= upper - lower;
          }
      }
    return dealii::Quadrature<dim>(points, weights);
  }

  template <int dim>
  void
  Loads<dim>::visit_faces(const Load<dim> &load, const Cell &cell, const Visit &visit)
  {
    for (const unsigned int f : cell->face_indices())
      {
        bool loaded = cell->at_boundary(f) && !cell->has_periodic_neighbor(f);
        for (const unsigned int v : cell->face(f)->vertex_indices())
          loaded = loaded && load.region.on_boundary(cell->face(f)->vertex(v), bodies, 1e-6 * cell->diameter());
        if (!loaded)
          continue;
        face.reinit(cell, f);
        std::vector<unsigned int> points;
        std::vector<double>       parts;
        for (unsigned int q = 0; q < face.n_quadrature_points; ++q)
          {
            points.push_back(q);
            parts.push_back(scene.thickness * face.JxW(q));
          }
        visit(cell, face, points, parts);
      }
  }

  template <int dim>
  void
  Loads<dim>::for_each_part(const Load<dim> &load, const Visit &visit)
  {
    std::unique_ptr<dealii::FEValues<dim>> cut;
    std::vector<unsigned int>              points;
    std::vector<double>                    parts;
    for (const auto &cell : space.dofs.active_cell_iterators())
      {
        if (!cell->is_locally_owned())
          continue;
        if (load.region.is_boundary())
          {
            visit_faces(load, cell, visit);
            continue;
          }
        const bool with_edge = is_cut(load, cell);
        if (with_edge)
          cut = std::make_unique<dealii::FEValues<dim>>(mesh.mapping(), space.fe, cut_quadrature(load, cell), needed);
        auto &values = with_edge ? *cut : whole;
        values.reinit(cell);
        points.clear();
        parts.clear();
        for (unsigned int q = 0; q < values.n_quadrature_points; ++q)
          if (const auto &X = values.quadrature_point(q); load.region.contains(X, mesh.material(cell, X), bodies))
            {
              points.push_back(q);
              parts.push_back(scene.thickness * values.JxW(q));
            }
        if (!points.empty())
          visit(cell, values, points, parts);
      }
  }

  template <int dim>
  void
  Loads<dim>::assemble_load(const unsigned int l, const double t, Vector &force)
  {
    const auto &load = scene.loads[l];
    if (is_single(load))
      {
        for (const auto &[dof, c, X] : single[l])
          if (space.owned.is_element(dof))
            space.ties.distribute_local_to_global(dealii::Vector<double>({load.total.value(X, t, c)}),
                                                  std::vector<dealii::types::global_dof_index>{dof}, force);
        return;
      }
    dealii::Vector<double>                       f(space.fe.n_dofs_per_cell());
    std::vector<dealii::types::global_dof_index> dofs(f.size());
    for_each_part(load, [&](const Cell &cell, const auto &values, const auto &points, const auto &parts) {
      f = 0.;
      for (std::size_t k = 0; k < points.size(); ++k)
        {
          const auto                  &X = values.quadrature_point(points[k]);
          const dealii::Tensor<1, dim> p = densities.value(l, X, t);
          for (unsigned int a = 0; a < f.size(); ++a)
            f(a) += parts[k] * p[space.fe.system_to_component_index(a).first] * values.shape_value(a, points[k]);
        }
      cell->get_dof_indices(dofs);
      space.ties.distribute_local_to_global(f, dofs, force);
    });
  }

  template <int dim>
  void
  Loads<dim>::assemble(const double t, Vector &force)
  {
    const bool known = assembled_time == t || (steady && !std::isnan(assembled_time));
    if (!known)
      {
        assembled.reinit(space.owned, scene.comm);
        for (unsigned int l = 0; l < scene.loads.size(); ++l)
          assemble_load(l, t, assembled);
        assembled.compress(dealii::VectorOperation::add);
        assembled_time = t;
      }
    force = assembled;
  }

  template class Loads<2>;
  template class Loads<3>;
} // namespace Stroma::Fem
