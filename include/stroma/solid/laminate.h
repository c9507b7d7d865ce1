#pragma once

#include <stroma/base/lanes.h>
#include <stroma/materials/material_block.h>
#include <stroma/solid/interface.h>

#include <deal.II/lac/full_matrix.h>

namespace Stroma::Solid
{
  /**
   * A composite cell: the deformation gradient of its points jumps at the interface of two materials,
   *   F_p = F_p(u) + s_p a (x) N,
   * by the jump a that makes the cell's energy least, so that tractions are the same on both sides in the mean:
   *   R(a) = sum_p V_p s_p P_p N = 0,     P N = tau g,   g = F^-T N.
   * One jump a cell, found by Newton's method within each evaluation; the stiffness of the nodes is condensed with
   *   K_aa = sum_p V_p s_p^2 [ g . Jc . g + (g . tau . g) I ],
   *   K_ba = sum_p V_p s_p   [ g_b . Jc . g + (g_b . tau . g) I ],     K_bc -= K_ba K_aa^-1 K_ac.
   * A plane interface through the cell between layers of uniform deformation is exact at any angle. Known as laminate or
   * composite voxel: Kabel, Merkert & Schneider 2015; of finite strain: Keshav, Fritzen & Kabel 2022.
   */
  template <int dim>
  class Laminate
  {
  public:
    /// Finds the jump at the interface and adds it to the deformation gradients of @p block, whose points have the volumes
    /// @p V [m^3]. Returns the status of the points if there is no jump with which all of them can be.
    StepStatus solve(const Interface<dim> &interface, const std::vector<double> &V, Materials::MaterialBlock &block);

    /// a [-], of the last solve().
    const dealii::Tensor<1, dim> &
    jump() const
    {
      return a;
    }

    /// F + s a (x) N of a point whose material is on the side @p s.
    static void
    add_jump(dealii::Tensor<2, 3> &F, const double s, const dealii::Tensor<1, dim> &a, const dealii::Tensor<1, dim> &N)
    {
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int k = 0; k < dim; ++k)
          F[i][k] += s * a[i] * N[k];
    }

    /// Takes the jump out of a cell's stiffness, unknowns ordered node by node. @p block as solve() has left it, with its
    /// tangents evaluated; @p g gradients F^-T grad S_b of its points.
    template <unsigned int n>
    void condense(const Interface<dim> &interface, const std::vector<double> &V, const Materials::MaterialBlock &block,
                  const std::vector<std::array<Lanes<n>, dim>> &g, dealii::FullMatrix<double> &K) const;

  private:
    using Vector = dealii::Tensor<1, dim>;
    using Square = dealii::Tensor<2, dim>;

    StepStatus evaluate(const Interface<dim> &interface, Materials::MaterialBlock &block, const Vector &trial);
    double     sum_residual(const Interface<dim> &interface, const std::vector<double> &V,
                            const Materials::MaterialBlock &block, Vector &R) const;
    Square     stiffness(const Interface<dim> &interface, const std::vector<double> &V,
                         const Materials::MaterialBlock &block) const;

    Vector                            a;
    std::vector<dealii::Tensor<2, 3>> F; ///< of the nodes
  };
} // namespace Stroma::Solid
