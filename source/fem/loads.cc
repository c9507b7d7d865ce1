#include <stroma/fem/loads.h>

#include <deal.II/base/quadrature_lib.h>

#include <limits>

namespace Stroma::Fem
{
  template <int dim>
  Loads<dim>::Loads(const Scene<dim> &scene, const Settings<dim> &settings, const Mesh<dim> &mesh,
                    const Unknowns<dim> &unknowns)
    : scene(scene)
    , unknowns(unknowns)
    , bodies(scene.bounding_box())
    , coarse(mesh.mapping(), unknowns.fe, dealii::QGauss<dim>(settings.degree + 2),
             dealii::update_values | dealii::update_quadrature_points | dealii::update_JxW_values)
    , fine(mesh.mapping(), unknowns.fe, dealii::QIterated<dim>(dealii::QGauss<1>(2), 16),
           dealii::update_values | dealii::update_quadrature_points | dealii::update_JxW_values)
    , face(mesh.mapping(), unknowns.fe, dealii::QGauss<dim - 1>(settings.degree + 2),
           dealii::update_values | dealii::update_quadrature_points | dealii::update_JxW_values)
    , sizes(scene.loads.size(), 0.)
    , single(scene.loads.size())
    , assembled_time(std::numeric_limits<double>::quiet_NaN())
  {
    for (unsigned int l = 0; l < scene.loads.size(); ++l)
      {
        const auto &load = scene.loads[l];
        for (const auto *expression : {&load.density, &load.traction, &load.total})
          steady &= !expression->given() || !expression->depends_on_time();
        if (load.region.kind == Region<dim>::Kind::body)
          {
            for (unsigned int c = 0; c < dim; ++c)
              single[l].emplace_back(unknowns.of_body(load.region.body, c), c);
            continue;
          }
        if (load.region.kind == Region<dim>::Kind::nearest)
          {
            find_nearest(l);
            continue;
          }
        for_each_part(load, [&](const Cell &, const auto &, const std::vector<unsigned int> &, const std::vector<double> &size) {
          for (const double part : size)
            sizes[l] += part;
        });
        sizes[l] = dealii::Utilities::MPI::sum(sizes[l], scene.comm);
        if (sizes[l] == 0.)
          throw UserError(load.where, "load '" + load.name + "' (" + load.region.text +
                                        ") selects no part of the mesh; enlarge it or move it into the bodies");
      }
  }

  template <int dim>
  void
  Loads<dim>::find_nearest(const unsigned int l)
  {
    // A vertex; equal on all ranks, smallest coordinates first among equals.
    std::array<double, 4> best{{std::numeric_limits<double>::max(), 0, 0, 0}};
    const auto            key = [&](const dealii::Point<dim> &X) {
      std::array<double, 4> result{{X.distance(scene.loads[l].region.first), 0, 0, 0}};
      for (unsigned int d = 0; d < dim; ++d)
        result[1 + d] = X[d];
      return result;
    };
    for (const auto &cell : unknowns.dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int v : cell->vertex_indices())
          best = std::min(best, key(cell->vertex(v)));
    const auto all = dealii::Utilities::MPI::all_gather(scene.comm, best);
    best           = *std::min_element(all.begin(), all.end());
    for (const auto &cell : unknowns.dofs.active_cell_iterators())
      if (cell->is_locally_owned() && single[l].empty())
        for (const unsigned int v : cell->vertex_indices())
          if (key(cell->vertex(v)) == best && unknowns.owned.is_element(cell->vertex_dof_index(v, 0)) && single[l].empty())
            for (unsigned int c = 0; c < dim; ++c)
              single[l].emplace_back(cell->vertex_dof_index(v, c), c);
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
      wholly &= region.contains(cell->vertex(v) + 1e-6 * (cell->center() - cell->vertex(v)), cell->material_id(), bodies);
    if (wholly)
      return false;
    const auto box = cell->bounding_box().get_boundary_points();
    for (unsigned int d = 0; d < dim; ++d)
      {
        const bool   is_ball = region.kind == Kind::ball, of_layer = region.kind == Kind::layer && d == region.axis;
        const double side    = of_layer ? region.side_coordinate(bodies) : region.first[d];
        const double below   = is_ball || of_layer ? side - region.extent : region.first[d];
        const double above   = is_ball || of_layer ? side + region.extent : region.second[d];
        const bool   bounded = region.kind != Kind::layer || of_layer;
        if (bounded && (box.first[d] >= above || box.second[d] <= below))
          return false;
      }
    return true;
  }

  template <int dim>
  template <typename Visit>
  void
  Loads<dim>::for_each_part(const Load<dim> &load, const Visit &visit)
  {
    std::vector<unsigned int> points;
    std::vector<double>       size;
    for (const auto &cell : unknowns.dofs.active_cell_iterators())
      {
        if (!cell->is_locally_owned())
          continue;
        if (load.region.is_boundary())
          {
            for (const unsigned int f : cell->face_indices())
              if (cell->face(f)->at_boundary() &&
                  load.region.on_boundary(cell->face(f)->vertex(0), bodies, 1e-6 * cell->diameter()) &&
                  load.region.on_boundary(cell->face(f)->vertex((1u << (dim - 1)) - 1), bodies, 1e-6 * cell->diameter()))
                {
                  face.reinit(cell, f);
                  points.clear();
                  size.clear();
                  for (unsigned int q = 0; q < face.n_quadrature_points; ++q)
                    {
                      points.push_back(q);
                      size.push_back(scene.thickness * face.JxW(q));
                    }
                  visit(cell, face, points, size);
                }
            continue;
          }
        auto &values = is_cut(load, cell) ? fine : coarse;
        values.reinit(cell);
        points.clear();
        size.clear();
        for (unsigned int q = 0; q < values.n_quadrature_points; ++q)
          if (load.region.contains(values.quadrature_point(q), cell->material_id(), bodies))
            {
              points.push_back(q);
              size.push_back(scene.thickness * values.JxW(q));
            }
        if (!points.empty())
          visit(cell, values, points, size);
      }
  }

  template <int dim>
  void
  Loads<dim>::assemble_load(const unsigned int l, const double t, Vector &force)
  {
    const auto &load = scene.loads[l];
    if (!single[l].empty() || load.region.kind == Region<dim>::Kind::nearest)
      {
        for (const auto &[dof, c] : single[l])
          if (unknowns.owned.is_element(dof))
            unknowns.ties.distribute_local_to_global(
              dealii::Vector<double>({load.total.value(load.region.first, t, c)}), std::vector<dealii::types::global_dof_index>{dof},
              force);
        return;
      }
    const auto                                  &fe = unknowns.fe;
    dealii::Vector<double>                       f(fe.n_dofs_per_cell());
    std::vector<dealii::types::global_dof_index> dofs(fe.n_dofs_per_cell());
    for_each_part(load, [&](const Cell &cell, const auto &values, const auto &points, const auto &size) {
      f = 0.;
      for (std::size_t k = 0; k < points.size(); ++k)
        {
          const auto                  &X = values.quadrature_point(points[k]);
          const dealii::Tensor<1, dim> p = load.density.given()  ? load.density.value(X, t) :
                                           load.traction.given() ? load.traction.value(X, t) :
                                                                   load.total.value(X, t) / sizes[l];
          for (unsigned int a = 0; a < f.size(); ++a)
            f(a) += size[k] * p[fe.system_to_component_index(a).first] * values.shape_value(a, points[k]);
        }
      cell->get_dof_indices(dofs);
      unknowns.ties.distribute_local_to_global(f, dofs, force);
    });
  }

  template <int dim>
  void
  Loads<dim>::assemble(const double t, Vector &force)
  {
    const bool known = assembled_time == t || (steady && !std::isnan(assembled_time));
    if (!known)
      {
        assembled.reinit(unknowns.owned, scene.comm);
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
