#pragma once

#include <stroma/mpm/active_cells.h>
#include <stroma/mpm/gathered_points.h>

#include <functional>

namespace Stroma::Mpm
{
  /// Internal forces, f_int of (7), cell by cell from the points of each, with the viscous stress of their materials.
  template <int dim>
  class CellForces : public Solvers::Term
  {
  public:
    /// For the grid's shape functions.
    static std::unique_ptr<CellForces> make(const Scene<dim> &scene, const Settings<dim> &settings,
                                            const BackgroundGrid<dim> &grid, const Points<dim> &points,
                                            ActiveCells<dim> &cells);

    /// For the present cells and points.
    virtual void rebuild() = 0;

    /// Kinds of the owned cells, see for_each_kind(); empty if none shares its stiffness.
    virtual const std::vector<unsigned int> &kinds() const = 0;

    /// Where cells that a material fills alike share their stiffness (Settings::shares_stiffness): calls @p visit(kind, matrix) for
    /// each kind of such cells, equal in size, material and integration, with the stiffness at the mean deformation gradient of
    /// all cells of that material. Collective.
    using VisitKind = std::function<void(unsigned int kind, const dealii::FullMatrix<double> &K_cell)>;
    virtual StepStatus for_each_kind(const Solvers::Motion &motion, const Solvers::Stage &stage,
                                     const VisitKind &visit) = 0;

    /// Calls @p visit(cell, matrix) with the stiffness of each owned cell of no kind at @p motion, unknowns node by node.
    using VisitStiffness = std::function<void(const ActiveCell<dim> &active, const dealii::FullMatrix<double> &K_cell)>;
    virtual StepStatus for_each_stiffness(const Solvers::Motion &motion, const Solvers::Stage &stage,
                                          const VisitStiffness &visit) = 0;

    /// Strain energy at the last add_force() [J]. Collective.
    virtual double strain_energy() const = 0;

    /// Calls @p visit(cell, points) for each owned cell with all its points, under the motion @p motion; the worst status on
    /// this rank is returned.
    using Visit = std::function<StepStatus(const ActiveCell<dim> &active, GatheredPoints<dim> &points)>;
    virtual StepStatus for_each_cell(const Solvers::Motion &motion, const Solvers::Stage &stage,
                                     const Visit &visit) = 0;

    /// The worst status of all points of this rank's cells under the motion @p motion, of a scene whose solve may see fewer.
    virtual StepStatus check_all_points(const Solvers::Motion &motion, const Solvers::Stage &stage) = 0;

    /// Calls @p visit(cell, jumps) for each owned cell with an interface: by material, how far its deformation gradient is
    /// from that of the nodes.
    using VisitJumps =
      std::function<void(const ActiveCell<dim> &active, const std::vector<dealii::Tensor<2, dim>> &jumps)>;
    virtual StepStatus for_each_jump(const Solvers::Motion &motion, const Solvers::Stage &stage,
                                     const VisitJumps &visit) = 0;
  };
} // namespace Stroma::Mpm
