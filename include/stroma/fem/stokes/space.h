#pragma once

#include <stroma/fem/mesh.h>

#include <stroma/base/types.h>

#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>

#include <map>
#include <string>
#include <vector>

namespace Stroma::Fem
{
  /**
   * Taylor-Hood unknowns on a mesh: velocities of degree k, pressures of degree k - 1, both continuous, with hanging
   * nodes and periodic sides; and which velocities the scene's supports and rigid bodies hold.
   */
  template <int dim>
  class StokesSpace
  {
  public:
    /// Throws UserError for supports that hold nothing, contradict each other or are not for fluids. Collective.
    StokesSpace(const Mesh<dim> &mesh, const Scene<dim> &scene, const Settings<dim> &settings, double end_time);

    /// Who holds velocities: a support, or a rigid body.
    struct Holder
    {
      std::string name;
      int         support; ///< index into the scene's supports, or -1
      int         rigid;   ///< index into the scene's rigid bodies, or -1
    };

    struct HeldUnknown
    {
      dealii::types::global_dof_index dof; ///< owned, and not tied to others
      unsigned int                    holder, component;
      dealii::Point<dim>              X; ///< [m]

      bool
      operator<(const HeldUnknown &other) const
      {
        return holder < other.holder;
      }
    };

    /// Sets the held entries of @p v to their velocities at time @p t [s] and distributes to tied unknowns. Collective.
    void impose(Vector &v, double t) const;

    /// The same with what makes their rate of change, @p factor v + @p known, that of the prescribed velocities just before
    /// @p t, from values over 2 @p h [s].
    void impose_rate(Vector &v, double t, double factor, const Vector &known, double h) const;

    /// Throws UserError if a uniform or rigid motion of the fluid is left undetermined. Collective.
    void check_determined() const;

    /// Translations, and rotations where no fluid resists them; zero on constrained unknowns.
    std::vector<Vector> free_motions() const;

    Vector
    new_velocity() const
    {
      return Vector(owned_velocity, scene.comm);
    }
    Vector
    new_pressure() const
    {
      return Vector(owned_pressure, scene.comm);
    }

    /// Place of each unknown of @p dofs that this rank owns, in their order.
    std::vector<dealii::Point<dim>> places(const dealii::DoFHandler<dim> &dofs) const;
    /// Component of each owned velocity unknown.
    std::vector<unsigned int> components() const;

    const Mesh<dim>  &mesh;
    const Scene<dim> &scene;

    dealii::FESystem<dim>   velocity_element;
    dealii::FE_Q<dim>       pressure_element;
    dealii::DoFHandler<dim> velocity_dofs, pressure_dofs;
    dealii::IndexSet        owned_velocity, relevant_velocity, owned_pressure, relevant_pressure;

    dealii::AffineConstraints<double> tied_velocity;  ///< hanging nodes and periodic sides
    dealii::AffineConstraints<double> fixed_velocity; ///< the same, and held unknowns at zero
    dealii::AffineConstraints<double> tied_pressure;

    std::vector<Holder>      holders;
    std::vector<HeldUnknown> held;

  private:
    using Cell = typename dealii::DoFHandler<dim>::active_cell_iterator;
    struct Found;

    void                   distribute_unknowns();
    void                   tie(const dealii::DoFHandler<dim> &dofs, const dealii::IndexSet &relevant,
                               dealii::AffineConstraints<double> &constraints) const;
    void                   list_holders();
    void                   find_held(double end_time);
    void                   find_on_boundary(const Cell &cell, Found &found) const;
    void                   find_inside(const Cell &cell, Found &found) const;
    void                   close_constraints();
    bool                   is_held_by(const Cell &cell, unsigned int face, const Holder &holder) const;
    dealii::Tensor<1, dim> velocity_of(const Holder &holder, const dealii::Point<dim> &X, double t) const;
    bool                   rotations_are_free(unsigned int axis) const;
  };
} // namespace Stroma::Fem
