#include <stroma/base/log.h>
#include <stroma/mpm/rigid_surfaces.h>
#include <stroma/mpm/surface_places.h>
#include <stroma/rigid/contact.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <limits>
#include <unordered_map>

namespace Stroma::Mpm
{
  namespace
  {
    /// Places on a surface along the side of a cell.
    constexpr double places_per_cell = 2.;

    /// Stiffness of the bond, over modulus times area over the side of a cell. Much more locks the cells that the surface cuts
    /// (of linear functions all their nodes then follow the body), much less lets the body slip.
    constexpr double bond = 100.;

    /// How far from the surface the material is looked for, over the side of a cell.
    constexpr double next_to = 1e-6;
  } // namespace

  template <int dim>
  RigidSurfaces<dim>::RigidSurfaces(const Scene<dim> &scene, const BackgroundGrid<dim> &grid,
                                    const ActiveCells<dim> &cells, const Rigid::Unknowns<dim> &unknowns)
    : scene(scene)
    , grid(grid)
    , cells(cells)
    , unknowns(unknowns)
    , h(*std::min_element(grid.box().cell_size.begin_raw(), grid.box().cell_size.end_raw()))
  {}

  template <int dim>
  void
  RigidSurfaces<dim>::rebuild()
  {
    springs.clear();
    if (scene.rigid_bodies.empty())
      return;
    const auto                                                &box = grid.box();
    std::unordered_map<std::uint64_t, const ActiveCell<dim> *> by_number;
    for (const auto &active : cells)
      by_number.emplace(box.cell_number(active.cell->center()), &active);
    std::vector<unsigned int> count(scene.rigid_bodies.size(), 0), n_beside(count);
    std::vector<unsigned int> bonded;
    const unsigned int        rank = dealii::Utilities::MPI::this_mpi_process(scene.comm),
                       n_ranks     = dealii::Utilities::MPI::n_mpi_processes(scene.comm);
    unsigned int n_places          = 0;
    for (unsigned int b = 0; b < scene.rigid_bodies.size(); ++b)
      if (!Rigid::has_contact(scene, scene.rigid_bodies[b].body))
        bonded.push_back(b);
    for (const unsigned int b : bonded)
      for (const auto &place : surface_places(scene.bodies[scene.rigid_bodies[b].body], h / places_per_cell))
        {
          const dealii::Point<dim> outside = place.X + next_to * h * place.normal;
          const dealii::Point<dim> inside  = place.X - next_to * h * place.normal;
          const auto found      = box.contains(outside) ? by_number.find(box.cell_number(outside)) : by_number.end();
          const bool is_counted = n_places++ % n_ranks == rank; // each rank counts a share, wherever its cells are
          if (found == by_number.end() && !is_counted)
            continue;
          const auto material = scene.material_at(outside);
          if (!material || scene.covered_by_later_body(scene.rigid_bodies[b].body, inside))
            continue;
          n_beside[b] += is_counted;
          if (found == by_number.end())
            continue;
          Spring spring{b, cells.carried(*found->second, place.X), found->second, 0.};
          spring.stiffness = bond * scene.materials[*material]->p_wave_modulus() * place.area *
                             (dim == 2 ? scene.thickness : 1.) / h;
          springs.push_back(spring);
          ++count[b];
        }
    dealii::Utilities::MPI::sum(count, scene.comm, count);
    dealii::Utilities::MPI::sum(n_beside, scene.comm, n_beside);
    for (const unsigned int b : bonded)
      if (count[b] == 0)
        throw UserError(scene.rigid_bodies[b].where,
                        "rigid body '" + scene.rigid_bodies[b].name + "' touches no material; move it or remove it");
      else if (count[b] < n_beside[b])
        Log::warning("rigid body '" + scene.rigid_bodies[b].name + "' is bonded to " + std::to_string(count[b]) +
                     " of " + std::to_string(n_beside[b]) +
                     " places of its surface that have material beside them: in the cells " +
                     "of the others there is no material point; use smaller 'MPM/Cells' or more 'MPM/Points per cell'");
  }

  /// Those of all rigid bodies, at @p u.
  template <int dim>
  std::vector<Rigid::Coupling<dim>>
  RigidSurfaces<dim>::couplings(const Vector &u) const
  {
    std::vector<Rigid::Coupling<dim>> all;
    for (unsigned int b = 0; b < scene.rigid_bodies.size(); ++b)
      {
        all.emplace_back(scene, unknowns, b);
        all.back().set_pose(u);
      }
    return all;
  }

  template <int dim>
  void
  RigidSurfaces<dim>::add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const
  {
    for (const auto &spring : springs)
      Rigid::Coupling<dim>(scene, unknowns, spring.body).add_pattern(pattern, constraints, spring.point);
  }

  template <int dim>
  StepStatus
  RigidSurfaces<dim>::add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &)
  {
    squares           = 0.;
    const auto bodies = couplings(motion.u);
    for (const auto &[b, point, cell, k] : springs)
      {
        const auto                   x = bodies[b].place(point, motion.u);
        const dealii::Tensor<1, dim> d = x - point.X;
        bodies[b].add_force(r, point, x, -k * d);
        // of the places, whose difference is the gap
        squares += std::pow(2. * k * (point.largest(motion.u) + (x - bodies[b].frame().pose.pivot).norm() + d.norm()),
                            2);
      }
    return StepStatus::ok;
  }

  template <int dim>
  StepStatus
  RigidSurfaces<dim>::add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &,
                                  const Solvers::Constraints &constraints)
  {
    const auto                   bodies = couplings(motion.u);
    const dealii::Tensor<2, dim> I      = dealii::unit_symmetric_tensor<dim>();
    for (const auto &[b, point, cell, k] : springs)
      {
        const auto x = bodies[b].place(point, motion.u);
        bodies[b].add_tangent(K, r, constraints, point, x, -k * (x - point.X), k * I);
      }
    return StepStatus::ok;
  }

  template <int dim>
  double
  RigidSurfaces<dim>::round_off() const
  {
    return std::numeric_limits<double>::epsilon() * std::sqrt(dealii::Utilities::MPI::sum(squares, scene.comm));
  }

  template <int dim>
  void
  RigidSurfaces<dim>::join(RigidMotions<dim> &motions, const ConnectedParts<dim> &parts) const
  {
    for (const auto &spring : springs)
      for (unsigned int c = 0; c < dim; ++c)
        motions.join(parts.piece_of(spring.cell->cell), parts.size() + spring.body, spring.point.X, c);
  }

  template class RigidSurfaces<2>;
  template class RigidSurfaces<3>;
} // namespace Stroma::Mpm
