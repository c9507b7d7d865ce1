#pragma once

#include <stroma/fem/fit.h>
#include <stroma/fem/settings.h>

#include <deal.II/distributed/tria.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/mapping.h>
#include <deal.II/lac/affine_constraints.h>

#include <array>

namespace Stroma::Fem
{
  /**
   * A mesh that fits the scene's bodies, shared out over the ranks by p4est. Bodies of boxes and images share one lattice
   * over their bounding box, without the cells that hold no material, at their centres if they need not fit (so that the
   * surface of a rigid inclusion is boundary); a single ring, quadrilateral or ball has a mesh of its own.
   */
  template <int dim>
  class Mesh
  {
  public:
    using Cell = typename dealii::Triangulation<dim>::active_cell_iterator;

    /// Makes and refines the mesh as the settings say. Throws UserError if it does not resolve a body. Collective.
    Mesh(const Scene<dim> &scene, const Settings<dim> &settings);

    const dealii::Mapping<dim> &
    mapping() const
    {
      return *cell_mapping;
    }

    /// Whether all cells are boxes.
    bool
    is_a_lattice() const
    {
      return is_lattice;
    }

    /// Whether the cells need not fit the bodies.
    bool
    is_cut() const
    {
      return settings.material_place == MaterialPlace::quadrature_point;
    }

    /// Index of the scene's material at @p X in @p cell, as 'Material at' says.
    unsigned int
    material(const Cell &cell, const dealii::Point<dim> &X) const
    {
      const unsigned int of_cell = cell->material_id();
      return is_cut() ? scene.material_at(X).value_or(of_cell) : of_cell;
    }

    /// The scene's body that is rigid and lies behind this face of the boundary, or -1: the one that took the lattice's cell
    /// there out of the mesh, or fills the hole that a fitted mesh leaves.
    int body_behind(const Cell &cell, unsigned int face) const;

    /// @p X and, on a side where the scene repeats (up to @p tolerance [m]), its periodic images.
    std::vector<dealii::Point<dim>> images(const dealii::Point<dim> &X, double tolerance) const;

    /// Ties the unknowns of opposite sides in the scene's periodic directions. Constraints must not be closed yet.
    void make_periodic(const dealii::DoFHandler<dim> &dofs, dealii::AffineConstraints<double> &constraints) const;

    /// Splits the cells that are flagged. Collective.
    void refine();

    /// Cells split by refine() so far, for a checkpoint, one cycle after the other. Collective.
    const std::vector<std::uint64_t> &
    history() const
    {
      return refined_cells;
    }

    /// Does the same again to a new mesh.
    void repeat(const std::vector<std::uint64_t> &history);

    /// Smallest distance between vertices of a cell [m]. Collective.
    double smallest_cell() const;

    dealii::parallel::distributed::Triangulation<dim> triangulation; ///< material_id: index of the scene's material

  private:
    using CellKey = std::array<unsigned int, 4>; ///< dealii::CellId in binary

    void              make_lattice();
    void              make_periodic_faces();
    void              refine_regions();
    bool              is_in(const RefinedRegion<dim> &refined, const Cell &cell) const;
    void              find_materials();
    void              check_points() const;
    std::vector<bool> filled_cells() const;
    /// Complaint about a cell that two materials share, or material and nothing; empty if there is none.
    std::string what_cuts(const dealii::BoundingBox<dim> &cell) const;

    const Scene<dim>                     &scene;
    const Settings<dim>                  &settings;
    const Fit<dim>                        fit;
    std::unique_ptr<dealii::Mapping<dim>> cell_mapping;
    bool                                  is_lattice     = false;
    unsigned int                          initial_splits = 0; ///< of all coarse cells
    std::vector<std::uint64_t>            refined_cells;      ///< count, keys, count, keys, ...
  };
} // namespace Stroma::Fem
