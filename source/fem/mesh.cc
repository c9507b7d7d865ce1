#include <stroma/base/log.h>
#include <stroma/base/text.h>
#include <stroma/fem/fitted_mesh.h>
#include <stroma/fem/mesh.h>
#include <stroma/fem/size.h>
#include <stroma/output/collective.h>

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_nothing.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_cartesian.h>
#include <deal.II/grid/cell_id.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace Stroma::Fem
{
  namespace
  {
    /// Splits whose undoing leaves every coarse cell wholly with or without material.
    template <int dim>
    unsigned int
    common_splits(const std::vector<unsigned int> &cells, const std::vector<bool> &filled,
                  const std::array<bool, dim> &periodic)
    {
      const auto coarse_is_uniform = [&](const unsigned int factor) {
        std::vector<unsigned int> coarse(dim);
        std::size_t               n = 1;
        for (unsigned int d = 0; d < dim; ++d)
          {
            if (cells[d] % factor != 0 || (periodic[d] && cells[d] / factor < 2))
              return false;
            coarse[d] = cells[d] / factor;
            n *= coarse[d];
          }
        std::vector<signed char> state(n, -1);
        for (std::size_t i = 0; i < filled.size(); ++i)
          {
            std::size_t rest = i, place = 0, stride = 1;
            for (unsigned int d = 0; d < dim; ++d)
              {
                place += (rest % cells[d]) / factor * stride;
                rest /= cells[d];
                stride *= coarse[d];
              }
            if (state[place] >= 0 && state[place] != static_cast<signed char>(filled[i]))
              return false;
            state[place] = filled[i];
          }
        return true;
      };
      unsigned int splits = 0;
      while (coarse_is_uniform(2u << splits))
        ++splits;
      return splits;
    }

    /// Throws UserError, at @p where, unless the material on the two sides across axis @p d has the same faces.
    template <int dim>
    void
    check_sides_match(const dealii::Triangulation<dim> &triangulation, const dealii::BoundingBox<dim> &box,
                      const unsigned int d, const std::string &where)
    {
      constexpr double steps = 1e6; // of the box' edges, to compare places
      std::array<std::map<std::array<long, dim>, dealii::Point<dim>>, 2> faces;
      for (const auto &cell : triangulation.cell_iterators_on_level(0))
        for (const auto &face : cell->face_iterators())
          for (unsigned int side = 0; side < 2; ++side)
            if (face->at_boundary() && face->boundary_id() == 2 * d + side)
              {
                std::array<long, dim> key{};
                for (unsigned int e = 0; e < dim; ++e)
                  if (e != d)
                    key[e] = std::lround(steps * (face->center()[e] - box.lower_bound(e)) / box.side_length(e));
                faces[side].emplace(key, face->center());
              }
      for (unsigned int side = 0; side < 2; ++side)
        for (const auto &[key, centre] : faces[side])
          if (faces[1 - side].count(key) == 0)
            {
              std::string place;
              for (unsigned int e = 0; e < dim; ++e)
                place += (e ? ", " : "") + brief(centre[e]);
              throw UserError(where, std::string("along ") + "xyz"[d] +
                                       " the material on the two sides differs: the "
                                       "face at " +
                                       place +
                                       " m has no partner on the other side; let holes and "
                                       "rigid bodies that reach one side reach the other too");
            }
    }
  } // namespace

  template <int dim>
  Mesh<dim>::Mesh(const Scene<dim> &scene, const Settings<dim> &settings)
    : triangulation(scene.comm)
    , scene(scene)
    , settings(settings)
    , fit(scene)
  {
    check_size(scene, settings);
    const Body<dim> *fitted = nullptr;
    unsigned int     n_soft = 0;
    for (const auto &body : scene.bodies)
      if (!body.rigid)
        {
          ++n_soft;
          if (!body.is_box() && !body.is_image())
            fitted = &body;
        }
    const bool fits = n_soft == 1 && fitted &&
                      make_fitted(*fitted->shape, settings, triangulation, cell_mapping, initial_splits);
    if (fitted && !fits && settings.material_place == MaterialPlace::cell)
      throw UserError(fitted->where,
                      "a mesh cannot fit body '" + fitted->name + "' " +
                        (n_soft > 1 ? "beside other bodies; use boxes or images, this body alone, or " :
                                      "that is no box, ball, ring or quadrilateral; draw it so, or set ") +
                        "'Material at = quadrature point' in section FEM");
    if (!fits)
      make_lattice();
    make_periodic_faces();
    triangulation.refine_global(initial_splits);
    refine_regions();
    find_materials();
    if (settings.material_place == MaterialPlace::quadrature_point)
      check_points();
  }

  /// Which cells of the lattice, x fastest, hold material. In cells that need not fit, the material at the centre counts.
  template <int dim>
  std::vector<bool>
  Mesh<dim>::filled_cells() const
  {
    const auto  corners = scene.bounding_box().get_boundary_points();
    const auto &cells   = settings.cells;
    std::size_t n_cells = 1;
    for (const unsigned int n : cells)
      n_cells *= n;
    std::vector<bool> filled(n_cells);
    double            in_mesh = 0., in_bodies = 0.; // in cells
    for (std::size_t i = 0; i < n_cells; ++i)
      {
        std::size_t        rest = i;
        dealii::Point<dim> lower, upper;
        for (unsigned int d = 0; d < dim; ++d)
          {
            const double size = (corners.second[d] - corners.first[d]) / cells[d];
            lower[d]          = corners.first[d] + (rest % cells[d]) * size;
            upper[d]          = lower[d] + size;
            rest /= cells[d];
          }
        const dealii::BoundingBox<dim> cell({lower, upper});
        filled[i] = bool(scene.material_at(cell.center()));
        if (settings.material_place == MaterialPlace::quadrature_point)
          {
            in_mesh += filled[i];
            in_bodies += fit.filled_share(cell);
          }
        else if (!filled[i])
          if (const auto message = what_cuts(cell); !message.empty())
            throw UserError(message);
      }
    if (std::find(filled.begin(), filled.end(), true) == filled.end())
      throw UserError(settings.where_cells, "no cell of the mesh holds material; use more cells");
    if (std::abs(in_mesh - in_bodies) > 1e-6 * in_bodies)
      Log::warning(settings.where_cells +
                   ": cells that do not fit the bodies' outer edges are kept or left out as a whole, so " +
                   "that the mesh has " + brief(100. * in_mesh / in_bodies) + " % of the bodies' volume");
    return filled;
  }

  template <int dim>
  void
  Mesh<dim>::make_lattice()
  {
    is_lattice                      = true;
    cell_mapping                    = std::make_unique<dealii::MappingCartesian<dim>>();
    const auto              corners = scene.bounding_box().get_boundary_points();
    const auto             &cells   = settings.cells;
    const std::vector<bool> filled  = filled_cells();
    initial_splits                  = common_splits<dim>(cells, filled, scene.periodic);
    std::vector<unsigned int> coarse(cells);
    for (unsigned int &n : coarse)
      n >>= initial_splits;
    dealii::Triangulation<dim> lattice, kept;
    dealii::GridGenerator::subdivided_hyper_rectangle(lattice, coarse, corners.first, corners.second);
    std::set<typename dealii::Triangulation<dim>::active_cell_iterator> empty;
    for (const auto &cell : lattice.active_cell_iterators())
      {
        // The centre of a coarse cell of an even split lies on fine vertices: take a fine cell's centre.
        const auto size = cell->vertex((1u << dim) - 1) - cell->vertex(0);
        if (!scene.material_at(
              dealii::Point<dim>(cell->center() - (initial_splits > 0 ? 1. / (2u << initial_splits) : 0.) * size)))
          empty.insert(cell);
      }
    const auto *source = &lattice;
    if (!empty.empty())
      {
        dealii::GridGenerator::create_triangulation_with_removed_cells(lattice, empty, kept);
        source = &kept;
      }
    for (const auto &cell : source->active_cell_iterators())
      for (const auto &face : cell->face_iterators())
        if (face->at_boundary())
          {
            dealii::types::boundary_id id = 2 * dim; // inside the bounding box
            for (unsigned int d = 0; d < dim; ++d)
              {
                const double tolerance = 1e-9 * (corners.second[d] - corners.first[d]);
                if (std::abs(face->center()[d] - corners.first[d]) < tolerance)
                  id = 2 * d;
                else if (std::abs(face->center()[d] - corners.second[d]) < tolerance)
                  id = 2 * d + 1;
              }
            face->set_all_boundary_ids(id);
          }
    triangulation.copy_triangulation(*source);
  }

  template <int dim>
  void
  Mesh<dim>::make_periodic_faces()
  {
    for (unsigned int d = 0; d < dim; ++d)
      if (scene.periodic[d])
        {
          if (!is_lattice)
            throw UserError(scene.where_periodic, "only scenes of boxes and images can be periodic");
          check_sides_match(triangulation, scene.bounding_box(), d, scene.where_periodic);
          std::vector<dealii::GridTools::PeriodicFacePair<typename dealii::Triangulation<dim>::cell_iterator>> pairs;
          dealii::GridTools::collect_periodic_faces(triangulation, 2 * d, 2 * d + 1, d, pairs);
          triangulation.add_periodicity(pairs);
        }
  }

  template <int dim>
  void
  Mesh<dim>::make_periodic(const dealii::DoFHandler<dim> &dofs, dealii::AffineConstraints<double> &constraints) const
  {
    for (unsigned int d = 0; d < dim; ++d)
      if (scene.periodic[d])
        dealii::DoFTools::make_periodicity_constraints(dofs, 2 * d, 2 * d + 1, d, constraints);
  }

  template <int dim>
  std::vector<dealii::Point<dim>>
  Mesh<dim>::images(const dealii::Point<dim> &X, const double tolerance) const
  {
    std::vector<dealii::Point<dim>> all{X};
    const auto                      box = scene.bounding_box();
    for (unsigned int d = 0; d < dim; ++d)
      for (const double step : {1., -1.})
        if (scene.periodic[d] && std::abs(X[d] - (step > 0 ? box.lower_bound(d) : box.upper_bound(d))) < tolerance)
          for (std::size_t i = 0, n = all.size(); i < n; ++i)
            all.push_back(all[i] + step * box.side_length(d) * dealii::Point<dim>::unit_vector(d));
    return all;
  }

  template <int dim>
  int
  Mesh<dim>::body_behind(const Cell &cell, const unsigned int face) const
  {
    if (cell->face(face)->boundary_id() != 2 * dim) // on the bodies' bounding box
      return -1;
    dealii::Point<dim> X(cell->face(face)->center() + (cell->face(face)->center() - cell->center()));
    if (is_lattice)
      for (unsigned int d = 0; d < dim; ++d)
        {
          const auto   box  = scene.bounding_box();
          const double size = box.side_length(d) / settings.cells[d];
          X[d]              = box.lower_bound(d) + (std::floor((X[d] - box.lower_bound(d)) / size) + .5) * size;
        }
    for (unsigned int b = scene.bodies.size(); b-- > 0;)
      if (scene.bodies[b].contains(X))
        return scene.bodies[b].rigid ? static_cast<int>(b) : -1;
    return -1;
  }

  template <int dim>
  bool
  Mesh<dim>::is_in(const RefinedRegion<dim> &refined, const Cell &cell) const
  {
    const auto  box    = scene.bounding_box();
    const auto &region = refined.region;
    if (region.kind == Region<dim>::Kind::nearest)
      return cell->bounding_box().point_inside(region.first);
    if (region.is_boundary())
      {
        for (const auto &face : cell->face_iterators())
          {
            bool on_it = face->at_boundary();
            for (const unsigned int v : face->vertex_indices())
              on_it = on_it && region.on_boundary(face->vertex(v), box, 1e-6 * cell->diameter());
            if (on_it)
              return true;
          }
        return false;
      }
    const auto material = scene.material_at(cell->center()).value_or(0);
    bool       inside   = region.contains(cell->center(), material, box);
    for (const unsigned int v : cell->vertex_indices())
      inside |= region.contains(cell->vertex(v), material, box);
    return inside;
  }

  template <int dim>
  void
  Mesh<dim>::refine_regions()
  {
    for (const auto &refined : settings.refined)
      for (unsigned int level = 0, before = 0; level < refined.levels; ++level)
        {
          unsigned int n = 0;
          for (const auto &cell : triangulation.active_cell_iterators())
            if (cell->is_locally_owned() && is_in(refined, cell))
              {
                cell->set_refine_flag();
                ++n;
              }
          n = dealii::Utilities::MPI::sum(n, scene.comm);
          if (n == 0)
            throw UserError(refined.where, "refinement of '" + refined.region.text +
                                             "' selects no cell; enlarge it or move it into the bodies");
          // What the levels to come would make, if the region's cells go on growing as they do.
          constexpr unsigned int enough = 64;
          const unsigned int     left   = refined.levels - level;
          const double           growth = before >= enough ? std::max(1., double(n) / before) : 1.;
          check_size(scene, settings, triangulation.n_global_active_cells() + n * (std::pow(growth, left) - 1.),
                     refined.where);
          before = n;
          triangulation.execute_coarsening_and_refinement();
        }
  }

  template <int dim>
  std::string
  Mesh<dim>::what_cuts(const dealii::BoundingBox<dim> &cell) const
  {
    const auto name = [&](const std::optional<unsigned int> material) {
      return material ? scene.material_names[*material] : "nothing";
    };
    const auto other = fit.other_than_at_centre(cell);
    if (!other)
      return "";
    const auto  centre = cell.center();
    std::string place;
    for (unsigned int d = 0; d < dim; ++d)
      place += (d ? ", " : "") + brief(centre[d]);
    return settings.where_cells + ": the cell at " + place + " m holds " + name(scene.material_at(centre)) + " and " +
           name(*other) + "; choose cells whose edges meet the bodies' edges, or 'Material at = quadrature point'";
  }

  template <int dim>
  void
  Mesh<dim>::find_materials()
  {
    std::string message;
    for (const auto &cell : triangulation.active_cell_iterators())
      if (!cell->is_artificial())
        {
          // A cell that was split off where nothing is, is of the material for which the whole was kept.
          auto ancestor = typename dealii::Triangulation<dim>::cell_iterator(cell);
          auto material = scene.material_at(ancestor->center());
          for (; is_lattice && !material && ancestor->level() > 0; material = scene.material_at(ancestor->center()))
            ancestor = ancestor->parent();
          cell->set_material_id(material.value_or(0));
          for (const auto &body : scene.bodies)
            if (message.empty() && !is_lattice && body.rigid && body.contains(cell->center()))
              message = body.where + ": rigid body '" + body.name +
                        "' lies in a body that is no box or image, out of whose " +
                        "mesh nothing can be cut; move it out, or draw the other body as a box or an image";
          if (!is_lattice || settings.material_place != MaterialPlace::cell || !message.empty() ||
              !cell->is_locally_owned())
            continue;
          message = what_cuts(ancestor->bounding_box());
        }
    Output::throw_if_any(message, scene.comm);
  }

  /// Every body must hold a point of the quadrature, or it would not exist.
  template <int dim>
  void
  Mesh<dim>::check_points() const
  {
    const dealii::FE_Nothing<dim> nothing;
    dealii::FEValues<dim>         values(*cell_mapping, nothing, dealii::QGauss<dim>(settings.n_quadrature_points()),
                                         dealii::update_quadrature_points);
    std::vector<unsigned int>     seen(scene.bodies.size(), 0);
    for (const auto &cell : triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          values.reinit(cell);
          for (const auto &X : values.get_quadrature_points())
            for (unsigned int b = scene.bodies.size(); b-- > 0;)
              if (scene.bodies[b].contains(X))
                {
                  seen[b] = 1;
                  break;
                }
        }
    dealii::Utilities::MPI::max(seen, scene.comm, seen);
    for (unsigned int b = 0; b < scene.bodies.size(); ++b)
      if (const auto &body = scene.bodies[b];
          !body.rigid && !seen[b] && !scene.covered_by_later_body(b, body.bounding_box().center()))
        throw UserError(body.where, "body '" + body.name +
                                      "' lies between the quadrature points of the mesh; use more 'FEM/Cells'");
  }

  template <int dim>
  void
  Mesh<dim>::refine()
  {
    std::vector<CellKey> keys;
    for (const auto &cell : triangulation.active_cell_iterators())
      if (cell->is_locally_owned() && cell->refine_flag_set())
        keys.push_back(cell->id().template to_binary<dim>());
    std::set<CellKey> all;
    for (const auto &part : dealii::Utilities::MPI::all_gather(scene.comm, keys))
      all.insert(part.begin(), part.end());
    refined_cells.push_back(all.size());
    for (const auto &key : all)
      refined_cells.insert(refined_cells.end(), key.begin(), key.end());
    triangulation.execute_coarsening_and_refinement();
    find_materials();
  }

  template <int dim>
  void
  Mesh<dim>::repeat(const std::vector<std::uint64_t> &history)
  {
    for (std::size_t i = 0; i < history.size();)
      {
        std::set<CellKey> keys;
        for (std::uint64_t n = history[i++]; n > 0; --n, i += 4)
          keys.insert(CellKey{
            {unsigned(history[i]), unsigned(history[i + 1]), unsigned(history[i + 2]), unsigned(history[i + 3])}});
        for (const auto &cell : triangulation.active_cell_iterators())
          if (cell->is_locally_owned() && keys.count(cell->id().template to_binary<dim>()) > 0)
            cell->set_refine_flag();
        refine();
      }
  }

  template <int dim>
  double
  Mesh<dim>::smallest_cell() const
  {
    double least = std::numeric_limits<double>::max();
    for (const auto &cell : triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        least = std::min(least, cell->minimum_vertex_distance());
    return dealii::Utilities::MPI::min(least, scene.comm);
  }

  template class Mesh<2>;
  template class Mesh<3>;
} // namespace Stroma::Fem
