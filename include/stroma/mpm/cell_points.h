#pragma once

#include <stroma/mpm/gathered_points.h>
#include <stroma/solid/momentum_kernel.h>

namespace Stroma::Mpm
{
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

    /// Gathers the points of a cell under the grid displacement @p u of its nodes [m] and their velocity @p v [m/s]; without
    /// one (nullptr), a viscous scene takes the velocity gradients that the points keep.
    /// Returns inverted_point if some det F_D <= 0, not_finite if some F_D is not finite.
    StepStatus gather(const ActiveCell<dim> &active, const Nodal &u, const Nodal *v = nullptr);

    dealii::Tensor<1, dim> displacement(unsigned int p) const override;
    dealii::Tensor<1, dim> displacement(const dealii::Point<dim> &xi) const override;

    Nodal                 u; ///< under which the points were gathered [m]
    std::vector<Gradient> g;
    Gradient              g_mean; ///< over the cell, only with projected dilatation

  private:
    StepStatus find_kinematics(unsigned int p);
    void       find_velocity_gradient(unsigned int p, const Nodal *v);
    void       project_dilatation();

    const ShapeFunctionsOf<dim, n> &functions;
    const Settings<dim>            &settings;
    const ActiveCell<dim>          *cell = nullptr; ///< of the points
    std::vector<Stencil<dim, n>>    shape;          ///< on the grid since the last rebase
  };
} // namespace Stroma::Mpm
