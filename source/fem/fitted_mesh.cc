#include <stroma/fem/fitted_mesh.h>
#include <stroma/shapes/ball.h>
#include <stroma/shapes/faceted.h>
#include <stroma/shapes/ring.h>

#include <deal.II/fe/mapping_q.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/manifold_lib.h>

#include <algorithm>

namespace Stroma::Fem
{
  namespace
  {
    /// A lattice of radii and angles.
    void
    make_sector(dealii::Triangulation<2> &sector, const Shapes::Ring &ring, const std::vector<unsigned int> &cells)
    {
      dealii::GridGenerator::subdivided_hyper_rectangle(sector, cells, dealii::Point<2>(ring.inner_radius, ring.from),
                                                        dealii::Point<2>(ring.radius, ring.to));
      dealii::GridTools::transform([&](const dealii::Point<2> &polar) { return ring.at(polar[0], polar[1]); }, sector);
    }

    void
    make_ring(const Shapes::Ring &ring, const Settings<2> &settings, dealii::Triangulation<2> &triangulation)
    {
      dealii::Triangulation<2> mesh;
      const bool               is_whole = ring.to - ring.from == 360.;
      if (is_whole && settings.cells[1] < 8)
        throw UserError(settings.where_cells, "'Cells' was given as " + std::to_string(settings.cells[1]) +
                                                " round a whole ring; at least 8 are needed");
      if (is_whole)
        dealii::GridGenerator::concentric_hyper_shells(mesh, ring.centre, ring.inner_radius, ring.radius,
                                                       settings.cells[0], 0., settings.cells[1]);
      else
        make_sector(mesh, ring, settings.cells);
      for (const auto &cell : mesh.active_cell_iterators())
        for (const auto &face : cell->face_iterators())
          if (face->at_boundary())
            face->set_boundary_id(4); // no side of the bounding box
      const dealii::PolarManifold<2> polar(ring.centre);
      mesh.reset_all_manifolds();
      mesh.set_all_manifold_ids(1);
      mesh.set_manifold(1, polar);
      triangulation.copy_triangulation(mesh);
      triangulation.set_manifold(1, polar);
    }

    void
    make_quadrilateral(const Shapes::Polygon &polygon, const Settings<2> &settings,
                       dealii::Triangulation<2> &triangulation)
    {
      dealii::Triangulation<2> square;
      dealii::GridGenerator::subdivided_hyper_rectangle(square, settings.cells, dealii::Point<2>(),
                                                        dealii::Point<2>(1., 1.));
      dealii::GridTools::transform(
        [&](const dealii::Point<2> &s) {
          const auto &x = polygon.vertices;
          return dealii::Point<2>((1 - s[0]) * (1 - s[1]) * x[0] + s[0] * (1 - s[1]) * x[1] + s[0] * s[1] * x[2] +
                                  (1 - s[0]) * s[1] * x[3]);
        },
        square);
      triangulation.copy_triangulation(square);
    }
  } // namespace

  template <int dim>
  bool
  make_fitted(const Shapes::Shape<dim> &shape, const Settings<dim> &settings, dealii::Triangulation<dim> &triangulation,
              std::unique_ptr<dealii::Mapping<dim>> &mapping, unsigned int &n_splits)
  {
    const unsigned int curved = std::max(2u, settings.degree); // of the mapping
    if (const auto *ball = dynamic_cast<const Shapes::Ball<dim> *>(&shape))
      {
        dealii::GridGenerator::hyper_ball_balanced(triangulation, ball->centre, ball->radius);
        mapping = std::make_unique<dealii::MappingQ<dim>>(curved);
        while (4u << n_splits < *std::max_element(settings.cells.begin(), settings.cells.end()))
          ++n_splits;
        return true;
      }
    if constexpr (dim == 2)
      {
        if (const auto *ring = dynamic_cast<const Shapes::Ring *>(&shape))
          {
            make_ring(*ring, settings, triangulation);
            mapping = std::make_unique<dealii::MappingQ<2>>(curved);
            return true;
          }
        const auto *polygon = dynamic_cast<const Shapes::Polygon *>(&shape);
        if (polygon && polygon->vertices.size() == 4 && Shapes::is_convex(polygon->vertices))
          {
            make_quadrilateral(*polygon, settings, triangulation);
            mapping = std::make_unique<dealii::MappingQ<2>>(1);
            return true;
          }
      }
    return false;
  }

  template bool make_fitted(const Shapes::Shape<2> &, const Settings<2> &, dealii::Triangulation<2> &,
                            std::unique_ptr<dealii::Mapping<2>> &, unsigned int &);
  template bool make_fitted(const Shapes::Shape<3> &, const Settings<3> &, dealii::Triangulation<3> &,
                            std::unique_ptr<dealii::Mapping<3>> &, unsigned int &);
} // namespace Stroma::Fem
