#pragma once

#include <stroma/materials/material_block.h>
#include <stroma/materials/viscosity.h>
#include <stroma/mpm/linear_shape.h>
#include <stroma/mpm/points.h>
#include <stroma/solid/momentum_kernel.h>

#include <vector>

namespace Stroma::Mpm
{
  /**
   * The points of one cell, gathered into contiguous arrays and ordered by material, with their kinematics under the
   * present grid displacement:
   *   F_D = I + sum_g u_g (x) grad S_g,   F = F_D F^r   (2)
   * and the gradients g_a = F_D^{-T} grad S_a that the momentum kernel takes (grad S_a itself for published forces). With
   * projected dilatation F is Fbar of Solid::ProjectedDilatation. In scenes with viscosity also
   *   L = sum_g v_g (x) g_g.
   */
  template <int dim>
  class CellPoints : public Materials::MaterialBlock
  {
  public:
    using Handler  = typename Points<dim>::Handler;
    using Shape    = LinearShape<dim>;
    using Gradient = std::array<Solid::Lanes<dim>, dim>;
    using Nodal    = std::array<Solid::Lanes<dim>, dim>; ///< at the nodes, by component

    CellPoints(const Scene<dim> &scene, const Points<dim> &points, const BackgroundGrid<dim> &grid,
               const Settings<dim> &settings);

    /// Gathers the points of a cell under the grid displacement @p u of its nodes [m] and their velocity @p v [m/s]; without
    /// one (nullptr), a viscous scene takes the velocity gradients that the points keep.
    /// Returns inverted_point if some det F_D <= 0, not_finite if some F_D is not finite.
    StepStatus gather(const typename dealii::Triangulation<dim>::active_cell_iterator &cell, const Nodal &u,
                      const Nodal *v = nullptr);

    /// Stores the history found by evaluate(next_step).
    void keep_history();

    /// J sigma_v of a point, zero where its material has no viscosity [Pa].
    dealii::Tensor<2, 3>
    viscous_stress(const unsigned int p, const unsigned int material) const
    {
      return J[p] * Materials::viscous_stress(scene.media[material], L[p]);
    }

    /// Displacement of point @p p by the grid since the last rebase [m].
    dealii::Tensor<1, dim>
    grid_displacement(const unsigned int p, const std::array<Solid::Lanes<dim>, dim> &u) const
    {
      dealii::Tensor<1, dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = Solid::sum<dim>(u[d] * shape[p].value);
      return result;
    }

    const bool                          is_viscous; ///< some material of the scene is
    std::vector<double>                 V;          ///< initial volume [m^3]
    std::vector<Shape>                  shape;      ///< on the grid since the last rebase
    std::vector<Gradient>               g;
    Gradient                            g_mean; ///< over the cell, only with projected dilatation
    std::vector<dealii::Tensor<2, dim>> F_D;
    std::vector<dealii::Tensor<2, 3>>   L;        ///< velocity gradient [1/s], only of viscous scenes, as
    std::vector<double>                 J;        ///< det F, without any projection
    std::vector<double *>               values;   ///< the point's stored numbers
    std::vector<dealii::Point<dim>>     location; ///< at the last reset

  private:
    void order_by_material(const typename Handler::particle_iterator_range &range);
    void resize(unsigned int n);
    void find_deformation(unsigned int p);
    void find_velocity_gradient(unsigned int p, const Nodal *v);
    void project_dilatation();

    const Scene<dim>         &scene;
    const Points<dim>        &points;
    dealii::Tensor<1, dim>    inverse_size;
    const Settings<dim>      &settings;
    std::vector<unsigned int> count, next;
  };
} // namespace Stroma::Mpm
