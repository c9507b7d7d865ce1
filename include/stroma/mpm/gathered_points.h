#pragma once

#include <stroma/materials/material_block.h>
#include <stroma/materials/viscosity.h>
#include <stroma/mpm/two_moment_points.h>

namespace Stroma::Mpm
{
  /**
   * The points of one cell, gathered into contiguous arrays and ordered by material, with their kinematics under the
   * present grid displacement:
   *   F_D = I + sum_g u_g (x) grad S_g,   F = F_D F^r   (2)
   * With projected dilatation F is Fbar of Solid::ProjectedDilatation. In scenes with viscosity also
   *   L = sum_g v_g (x) g_g,  g_a = F_D^{-T} grad S_a.
   */
  template <int dim>
  class GatheredPoints : public Materials::MaterialBlock
  {
  public:
    GatheredPoints(const Scene<dim> &scene, const Points<dim> &points);
    virtual ~GatheredPoints() = default;

    /// Displacement by the grid since the last rebase [m], of a point and at the place @p xi of the unit cell.
    virtual dealii::Tensor<1, dim> displacement(unsigned int p) const               = 0;
    virtual dealii::Tensor<1, dim> displacement(const dealii::Point<dim> &xi) const = 0;

    /// Stores the history found by evaluate(next_step).
    void keep_history();

    /// Initial volume [m^3].
    double
    initial_volume(const unsigned int p) const
    {
      return points.weight.stored() ? values[p][points.volume.first] : V[p];
    }

    /// J sigma_v of a point, zero where its material has no viscosity [Pa].
    dealii::Tensor<2, 3>
    viscous_stress(const unsigned int p, const unsigned int material) const
    {
      return J[p] * Materials::viscous_stress(scene.media[material], L[p]);
    }

    const bool                          is_viscous; ///< some material of the scene is
    std::vector<double>                 V;          ///< initial volume [m^3], weighed for sums over the cell
    std::vector<dealii::Tensor<2, dim>> F_D;
    std::vector<dealii::Tensor<2, 3>>   L;        ///< velocity gradient [1/s], only of viscous scenes, as
    std::vector<double>                 J;        ///< det F, without any projection
    std::vector<double *>               values;   ///< the point's stored numbers, where points are kept
    std::vector<dealii::Point<dim>>     location; ///< at the last reset
    std::vector<dealii::Point<dim>>     xi;       ///< in the unit cell, then

  protected:
    /// All points of a cell, where points are kept.
    void gather_points(const ActiveCell<dim> &active);
    /// Those found in images, counted by @p standing.
    void gather_found(const ActiveCell<dim> &active, const TwoMomentPoints<dim> &standing);
    /// Those that stand for the points of an active cell; they store nothing.
    void gather_standing(const TwoMomentPoints<dim> &standing, unsigned int number);
    void find_deformation(unsigned int p);

    const Points<dim> &points;

  private:
    void resize(unsigned int n);
    void order_by_material();

    const Scene<dim>         &scene;
    std::vector<unsigned int> count, next; ///< by material
  };

  /// F = F_D F^r (2).
  template <int dim>
  inline void
  GatheredPoints<dim>::find_deformation(const unsigned int p)
  {
    dealii::Tensor<2, dim> total = F_D[p];
    if (points.deformation.stored())
      total = F_D[p] * points.deformation_of(values[p]);
    F[p] = 0.;
    if constexpr (dim == 2)
      F[p][2][2] = 1.;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int k = 0; k < dim; ++k)
        F[p][i][k] = total[i][k];
  }
} // namespace Stroma::Mpm
