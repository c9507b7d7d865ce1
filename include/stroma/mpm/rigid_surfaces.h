#pragma once

#include <stroma/grid/free_parts.h>
#include <stroma/mpm/active_cells.h>

namespace Stroma::Mpm
{
  /**
   * Rigid bodies to which the material is bonded: springs between the material and places on the body's surface, which move as
   * the body does, each of stiffness 100 M A / h, with M the modulus of longitudinal waves of the material there, A the
   * place's share of the surface and h the smallest side of a cell. Within the body nothing has unknowns but the cells that
   * its surface cuts (with B-splines their neighbours too). The motion of the bodies is prescribed and the grid is never reset.
   */
  template <int dim>
  class RigidSurfaces : public Solvers::Term
  {
  public:
    RigidSurfaces(const Scene<dim> &scene, const BackgroundGrid<dim> &grid, ActiveCells<dim> &cells);

    /// Finds the places in the present cells. Throws UserError for a body that touches no material. Collective.
    void rebuild();

    void
    add_pattern(Solvers::Pattern &, const Solvers::Constraints &) const override
    {} // that of the cells
    StepStatus add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage) override;
    StepStatus add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage,
                           const Solvers::Constraints &constraints) override;
    double     round_off() const override;

    /// Motion of the bodies at time @p t, and the forces and torques by which they act on the material, from the last
    /// add_force(). Collective.
    std::vector<std::pair<std::string, double>> results(double t) const;

    /// Adds the forces of this rank to those of the supports that move the bodies, by support [N].
    void add_reactions(std::vector<dealii::Tensor<1, dim>> &of_supports) const;

    /// Tells @p motions which places of the pieces are held.
    void hold(RigidMotions<dim> &motions, const ConnectedParts<dim> &parts) const;

  private:
    /// A place on a surface, in a cell of this rank.
    struct Spring
    {
      unsigned int                      body; ///< of the scene's rigid ones
      dealii::Point<dim>                X;    ///< [m]
      const ActiveCell<dim>            *cell;
      typename ActiveCells<dim>::Shapes shapes;
      double                            stiffness; ///< [N/m]
    };

    dealii::Tensor<1, dim> gap(const Spring &spring, const Solvers::Motion &motion, const Solvers::Stage &stage) const;

    const Scene<dim>                   &scene;
    const BackgroundGrid<dim>          &grid;
    ActiveCells<dim>                   &cells;
    const double                        h;
    std::vector<Spring>                 springs;
    std::vector<dealii::Tensor<1, dim>> force; ///< of this rank [N]
    std::vector<Rigid::Axial<dim>>      torque;
    double                              squares = 0.;
  };
} // namespace Stroma::Mpm
