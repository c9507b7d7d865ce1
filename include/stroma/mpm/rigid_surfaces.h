#pragma once

#include <stroma/grid/free_parts.h>
#include <stroma/mpm/active_cells.h>

namespace Stroma::Mpm
{
  /**
   * Rigid bodies to which the material is bonded: springs between the material and places on the body's surface, which move as
   * the body does, each of stiffness 100 M A / h, with M the modulus of longitudinal waves of the material there, A the
   * place's share of the surface and h the smallest side of a cell. Within the body nothing has unknowns but the cells that
   * its surface cuts (with B-splines their neighbours too). The grid is never reset.
   */
  template <int dim>
  class RigidSurfaces : public Solvers::Term
  {
  public:
    RigidSurfaces(const Scene<dim> &scene, const BackgroundGrid<dim> &grid, const ActiveCells<dim> &cells,
                  const Rigid::Unknowns<dim> &unknowns);

    /// Finds the places in the present cells, of all bodies but those of contacts. Throws UserError for a body that touches
    /// no material. Collective.
    void rebuild();

    void       add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const override;
    StepStatus add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage) override;
    StepStatus add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage,
                           const Solvers::Constraints &constraints) override;
    double     round_off() const override;

    /// Tells @p motions which places of the pieces are joined to bodies, which are numbered after them.
    void join(RigidMotions<dim> &motions, const ConnectedParts<dim> &parts) const;

  private:
    /// A place on a surface, in a cell of this rank.
    struct Spring
    {
      unsigned int             body; ///< of the scene's rigid ones
      Rigid::CarriedPoint<dim> point;
      const ActiveCell<dim>   *cell;
      double                   stiffness; ///< [N/m]
    };

    std::vector<Rigid::Coupling<dim>> couplings(const Vector &u) const;

    const Scene<dim>           &scene;
    const BackgroundGrid<dim>  &grid;
    const ActiveCells<dim>     &cells;
    const Rigid::Unknowns<dim> &unknowns;
    const double                h;
    std::vector<Spring>         springs;
    double                      squares = 0.;
  };
} // namespace Stroma::Mpm
