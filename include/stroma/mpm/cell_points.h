#pragma once

#include <stroma/mpm/gathered_points.h>
#include <stroma/mpm/interfaces.h>
#include <stroma/mpm/two_moment_points.h>
#include <stroma/solid/laminate.h>
#include <stroma/solid/momentum_kernel.h>

namespace Stroma::Mpm
{
  /// Which points of a cell are gathered: those that the solve takes, which may be fewer, or all that there are.
  enum class Gathered
  {
    for_solve,
    all_points
  };

  /// The points of one cell with n nodes, with their shape functions and the gradients g_a = F_D^{-T} grad S_a that the
  /// momentum kernel takes (grad S_a itself for published forces).
  template <int dim, unsigned int n>
  class CellPoints : public GatheredPoints<dim>
  {
  public:
    using Gradient = std::array<Lanes<n>, dim>;
    using Nodal    = std::array<Lanes<n>, dim>; ///< at the nodes, by component

    CellPoints(const Scene<dim> &scene, const Points<dim> &points, const BackgroundGrid<dim> &grid,
               const Settings<dim> &settings);

    /// For the active cells of @p grid.
    void rebuild(const BackgroundGrid<dim> &grid);

    /// Gathers the points of a cell under the grid displacement @p u of its nodes [m] and their velocity @p v [m/s]; without
    /// one (nullptr), a viscous scene takes the velocity gradients that the points keep.
    /// At an interface the deformation gradients jump as Solid::Laminate says, found from the points of the solve.
    /// Returns inverted_point if some det F_D <= 0, not_finite if some F_D is not finite.
    StepStatus gather(const ActiveCell<dim> &active, Gathered which, const Nodal &u, const Nodal *v = nullptr);

    /// Whether det F_D > 0 at every place of the cell that was gathered, on each side of an interface, as far as its corners
    /// tell: false where they leave that open.
    bool no_place_is_inverted() const;

    /// Of the active cells, where they share their stiffness: numbers from 0 of cells that one material fills with the same
    /// points, or TwoMomentPoints::no_kind. Empty if none does.
    const std::vector<unsigned int> &
    kinds() const
    {
      return kind_of_cell;
    }
    unsigned int
    n_kinds() const
    {
      return standing.n_kinds();
    }
    unsigned int
    material_of_kind(const unsigned int kind) const
    {
      return standing.material_of_kind(kind);
    }

    /// Of the cell that was gathered.
    bool
    has_interface() const
    {
      return interface != nullptr;
    }
    /// s_m a (x) N by material.
    std::vector<dealii::Tensor<2, dim>> jumps() const;
    /// Solid::Laminate::condense(), where there is an interface.
    void condense_jump(dealii::FullMatrix<double> &K_cell) const;

    dealii::Tensor<1, dim> displacement(unsigned int p) const override;
    dealii::Tensor<1, dim> displacement(const dealii::Point<dim> &xi) const override;

    Nodal                 u; ///< under which the points were gathered [m]
    std::vector<Gradient> g;
    Gradient              g_mean; ///< over the cell, only with projected dilatation

  private:
    void       gather_for_solve();
    void       gather_all();
    void       add_gradient_shift();
    void       find_gradients();
    void       find_series();
    void       find_gradients_by_series();
    void       find_kinematics(unsigned int p);
    StepStatus check_gradient(unsigned int p) const;
    StepStatus finish(Gathered which, const Nodal *v);
    void       add_jump();
    void       find_velocity_gradient(unsigned int p, const Nodal *v);
    void       project_dilatation();

    const ShapeFunctionsOf<dim, n> &functions;
    const Settings<dim>            &settings;
    const unsigned int              n_materials;
    const dealii::Tensor<1, dim>    cell_size;           ///< [m]
    const bool                      whole_voxels;        ///< count in the moments of all cells, not their points
    const ActiveCell<dim>          *cell      = nullptr; ///< of the points
    const Solid::Interface<dim>    *interface = nullptr; ///< in it
    TwoMomentPoints<dim>            standing;
    std::vector<unsigned int>       kind_of_cell;
    Interfaces<dim>                 interfaces;
    Solid::Laminate<dim>            laminate;
    std::vector<Stencil<dim, n>>    shape;             ///< on the grid since the last rebase; not of points by series
    bool                            by_series = false; ///< linear functions, and points found in images
    /// u = sum_s series_s prod_d xi_d where bit d of s is set, by component [m]
    std::array<std::array<double, n>, dim> series;
  };
} // namespace Stroma::Mpm
