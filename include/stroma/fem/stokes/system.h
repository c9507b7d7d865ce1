#pragma once

#include <stroma/fem/loads.h>
#include <stroma/fem/stokes/cell.h>
#include <stroma/fem/stokes/space.h>
#include <stroma/fem/stokes/viscosity.h>

#include <deal.II/base/quadrature_lib.h>

#include <functional>

namespace Stroma::Fem
{
  /// Velocity and pressure at one time, on owned unknowns.
  struct StokesFlow
  {
    Vector v; ///< [m/s]
    Vector p; ///< [Pa]
  };

  /// How an implicit stage sees time: dv/dt = rate v + velocity_known, dp/dt = rate p + pressure_known. rate = 0 where
  /// nothing depends on the past; the vectors are then empty, as is velocity_known without inertia.
  struct StokesRates
  {
    double rate = 0.; ///< [1/s]
    Vector velocity_known, pressure_known;
  };

  /// The matrices of [A B^T; B -C], with rows and columns of held and tied unknowns replaced by a positive diagonal.
  struct StokesMatrices
  {
    Matrix A; ///< viscosity, and inertia
    Matrix B; ///< minus the divergence
    Matrix C; ///< compressibility; not made where all fluids are incompressible
    Matrix S; ///< what preconditions the pressure: mass over the viscosity of longitudinal waves, plus C
    Matrix
      L; ///< the same where inertia outweighs viscosity: gradients over rate and density, plus C; only with inertia
  };

  /**
   * Stokes' equations in weak form:
   *   rho (dv/dt, w) + (viscous stress, grad w) - (p, div w) = (b, w) + (t, w) on the boundary,
   *   -(div v, q) - (1/K) (dp/dt, q) = 0,
   * for the fluid at rest: places do not move with it (Eulerian, small displacement), and nothing is carried with the
   * flow. In two dimensions all integrals are over the scene's thickness, so that forces come out in N.
   */
  template <int dim>
  class StokesSystem
  {
  public:
    /// Throws UserError for loads that act on nothing. Collective.
    StokesSystem(const StokesSpace<dim> &space, const Settings<dim> &settings);

    /// Fills @p m for stages of this @p rate. Collective.
    void assemble(StokesMatrices &m, double rate) const;

    /// Loads at time @p t [s]. Collective.
    void set_time(double t);

    /// Right-hand sides minus left-hand sides on all unknowns that are not tied: on held ones, minus the reaction [N],
    /// and for the pressure [m^3/s]. Collective.
    void residual(StokesFlow &r, const StokesFlow &flow, const StokesRates &rates) const;

    /// The same without loads and a past: of the homogeneous equations. Collective.
    void homogeneous_residual(StokesFlow &r, const StokesFlow &flow, double rate) const;

    /// Whether the pressure is determined only up to a constant with the matrices @p m. Collective.
    bool level_is_free(const StokesMatrices &m) const;

    /// Takes a flux through the boundary that div v = 0 does not allow (of the interpolated velocities) out of @p r.
    void make_compatible(Vector &r) const;
    /// Shifts @p p to zero mean.
    void remove_mean(Vector &p) const;

    /// What is known at a quadrature point.
    struct Point
    {
      dealii::Point<dim>     X;
      dealii::Tensor<1, dim> v;        ///< [m/s]
      dealii::Tensor<2, dim> G;        ///< gradient of v [1/s]
      double                 p;        ///< [Pa]
      double                 JxW;      ///< [m^3]
      unsigned int           material; ///< index into the scene's materials
    };
    using Iterator = typename dealii::Triangulation<dim>::active_cell_iterator;
    using Visit    = std::function<void(const Iterator &, const Point &)>;

    /// Calls @p visit for each point of @p quadrature in the owned cells.
    void for_each_point(const StokesFlow &flow, const dealii::Quadrature<dim> &quadrature, const Visit &visit) const;

    /// The flow with the values of neighbouring ranks' cells, for evaluate(). Collective.
    StokesFlow with_ghosts(const StokesFlow &flow) const;

    /// The points of the quadrature of @p values in a cell that is owned or a ghost. @param flow with ghosts
    void evaluate(std::vector<Point> &points, const StokesFlow &flow, StokesCell<dim> &values,
                  const Iterator &cell) const;

    bool
    is_compressible() const
    {
      return compressible;
    }
    bool
    has_inertia() const
    {
      return settings.inertia;
    }
    const StokesViscosity &
    viscosity(const unsigned int material) const
    {
      return viscosities[material];
    }
    /// The quadrature of the equations.
    const dealii::QGauss<dim> &
    quadrature() const
    {
      return cell_quadrature;
    }

    const StokesSpace<dim> &space;

  private:
    unsigned int
    material(const Iterator &cell, const dealii::Point<dim> &X) const
    {
      return space.mesh.material(cell, X);
    }
    void subtract_left_hand_sides(StokesFlow &r, const StokesFlow &flow, const StokesRates &rates) const;
    void make_patterns(StokesMatrices &m, double rate) const;
    void add_velocity(const StokesCell<dim> &values, const Iterator &cell, StokesMatrices &m, double rate) const;
    void add_pressure(const StokesCell<dim> &values, const Iterator &cell, StokesMatrices &m, double rate) const;
    void check_loads() const;

    const Scene<dim>            &scene;
    const Settings<dim>         &settings;
    std::vector<StokesViscosity> viscosities; ///< of each material
    dealii::QGauss<dim>          cell_quadrature;
    bool                         compressible = false;
    double                       thickness    = 1.; ///< [m]
    std::unique_ptr<Loads<dim>>  loads;             ///< if there are any
    Vector                       external;          ///< [N]
    Vector                       volumes;           ///< of the pressure's shape functions [m^3]
  };
} // namespace Stroma::Fem
