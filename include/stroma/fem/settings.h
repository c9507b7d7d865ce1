#pragma once

#include <stroma/base/parameters.h>
#include <stroma/rigid/contact_settings.h>
#include <stroma/scene/scene.h>
#include <stroma/solvers/time_scheme.h>

namespace Stroma::Fem
{
  enum class Kinematics
  {
    finite, ///< balance in the deformed shape
    small   ///< linear strains, balance in the undeformed shape
  };

  /// How a cell sees its change of volume.
  enum class Dilatation
  {
    full,     ///< at each quadrature point
    projected ///< onto polynomials of one degree less: the remedy against locking near incompressibility, see SolidCell
  };

  /// Where a cell's material is looked up.
  enum class MaterialPlace
  {
    cell,            ///< the mesh must fit the bodies
    quadrature_point ///< the mesh need not fit them; accuracy is then of first order at interfaces
  };

  /// A part of the scene whose cells are split.
  template <int dim>
  struct RefinedRegion
  {
    std::string  where;
    Region<dim>  region;
    unsigned int levels = 1;
  };

  /// The `FEM` section.
  template <int dim>
  class Settings
  {
  public:
    /// Declares and reads the entries of the current section that @p scene (a solid or a fluid) has. Throws UserError.
    void add(Parameters &p, const Scene<dim> &scene);

    /// Gauss points along each axis of a cell.
    unsigned int
    n_quadrature_points() const
    {
      return quadrature_points > 0 ? quadrature_points : degree + 1;
    }

    std::vector<unsigned int>       cells;
    unsigned int                    degree            = 2; ///< of the displacement; of the velocity in a fluid
    unsigned int                    quadrature_points = 0; ///< along each axis; 0: degree + 1
    bool                            inertia           = false;
    Solvers::Order                  order = Solvers::Order::statics; ///< of a solid, from viscosity and inertia
    Solvers::TimeSchemeSettings     scheme;
    Kinematics                      kinematics     = Kinematics::finite;
    Dilatation                      dilatation     = Dilatation::full;
    MaterialPlace                   material_place = MaterialPlace::cell;
    std::vector<RefinedRegion<dim>> refined;
    unsigned int                    error_cycles   = 0;  ///< refinements by Kelly's estimate
    double                          error_fraction = .2; ///< of the cells, refined in each cycle
    Rigid::ContactSettings          contact;
    std::string                     where_cells;
  };
} // namespace Stroma::Fem
