#pragma once

#include <stroma/base/types.h>
#include <stroma/grid/free_parts.h>
#include <stroma/scene/scene.h>
#include <stroma/solvers/term.h>

#include <deal.II/base/index_set.h>

#include <array>
#include <functional>
#include <vector>

namespace Stroma::Rigid
{
  /// A body's pose with its derivatives by the unknowns l theta of its rotation.
  template <int dim>
  struct Frame
  {
    Pose<dim>                                            pose;
    dealii::Tensor<2, dim>                               R;
    std::array<dealii::Tensor<2, dim>, n_rotations<dim>> dR;  ///< [1/m]
    std::array<decltype(dR), n_rotations<dim>>           ddR; ///< [1/m^2]

    /// Where the place @p x of space is in the body's frame, as it lay at the start.
    dealii::Point<dim>
    in_body(const dealii::Point<dim> &x) const
    {
      return pose.pivot + transpose(R) * (x - pose.pivot - pose.translation);
    }
  };

  /**
   * The unknowns of a scene's rigid bodies in a balance of forces. Those of a body are its translation U and l theta, with l half
   * the diagonal of its box, so that all are lengths and what is conjugate to them are forces: as many as for two nodes (in
   * the plane the last stands for nothing), which multigrid expects. They follow the unknowns of the material.
   */
  template <int dim>
  class Unknowns
  {
  public:
    using Dof = dealii::types::global_dof_index;

    explicit Unknowns(const Scene<dim> &scene);

    /// Numbers the unknowns after those of the material; the last rank owns them, all know them.
    void number(dealii::IndexSet &owned, dealii::IndexSet &relevant);
    Dof
    size() const
    {
      return scene.rigid_bodies.size() * per_body;
    }

    /// Component @p c of rigid body @p r: along the axes first, then about them.
    Dof
    unknown(const unsigned int r, const unsigned int c) const
    {
      return first + r * per_body + c;
    }
    /// l of rigid body @p r [m].
    double
    length(const unsigned int r) const
    {
      return lengths[r];
    }
    /// Index among the scene's rigid bodies of body @p b, one of them.
    unsigned int index_of(unsigned int b) const;

    /// Whether its drive prescribes the component (or leaves it at rest), and the unknown's value then at time @p t [s].
    bool is_prescribed(unsigned int r, unsigned int c) const;
    /// Bodies and components of which it does so.
    std::vector<std::pair<unsigned int, unsigned int>> all_prescribed() const;
    double                                             prescribed(unsigned int r, unsigned int c, double t) const;
    /// Its rate of change just before, of second order, from values over 2 @p h [s] [m/s].
    double prescribed_rate(unsigned int r, unsigned int c, double t, double h) const;

    /// Whether a body that may turn is among them.
    bool turn() const;

    /// Poses of all bodies by the unknowns of @p u (owned or relevant). Collective, but for relevant ones.
    std::vector<Pose<dim>> poses(const Vector &u) const;
    Frame<dim>             frame(unsigned int r, const Pose<dim> &pose) const;

    /// Adds the loads on the bodies at time @p t to @p external, but for torques: see TurningTerm. Compress afterwards.
    void add_forces(double t, Vector &external) const;

    /// What is conjugate to l theta_k at rotation @p theta of rigid body @p r, of forces on its nodes with the sum
    /// M = f (X - pivot)^T, @p virial, and of a @p torque T on it: (M : dR/dtheta_k + (J^T T)_k)/l [N], with w = J dtheta/dt.
    Axial<dim> conjugate(unsigned int r, const Axial<dim> &theta, const dealii::Tensor<2, dim> &virial,
                         const Axial<dim> &torque) const;

    /// The torque about where the pivot is [N m] to which @p forces [N] are conjugate.
    Axial<dim> torque(unsigned int r, const Axial<dim> &theta, const Axial<dim> &forces) const;

    /// Results of all bodies at @p u, of which the material acts on an owned unknown with @p force(unknown) [N]. Collective.
    std::vector<std::pair<std::string, double>> results(const Vector &u, const std::function<double(Dof)> &force) const;

    /// The bodies' own rows: the diagonal, and something on it where no force has put anything.
    void add_pattern(Solvers::Pattern &pattern) const;
    void fill_empty_rows(Matrix &K, Vector &r, const Solvers::Constraints &constraints) const;

    /// Sets rigid motions about @p centre on the bodies' owned unknowns but those that @p is_held: the translations, then the
    /// rotations by 1/@p length [1/m].
    void set_motions(std::vector<Vector> &modes, const dealii::Point<dim> &centre, double length,
                     const std::function<bool(Dof)> &is_held) const;

    /// Tells @p motions what of the bodies, its pieces from @p first_piece on, @p is_held(unknown).
    void hold(RigidMotions<dim> &motions, unsigned int first_piece, const std::function<bool(Dof)> &is_held) const;
    /// Tells @p add of the loads on each rigid body at time @p t [s], torques as pairs of forces. Local.
    void visit_loads(double t, unsigned int first_piece, const typename FreeParts<dim>::AddForce &add) const;
    void visit_torques(double t, unsigned int first_piece, const typename FreeParts<dim>::AddForce &add) const;

    static constexpr unsigned int per_body = 2 * dim;

  protected:
    /// Columns of J.
    std::array<Axial<dim>, n_rotations<dim>> axes(const Axial<dim> &theta) const;

    const Scene<dim>   &scene;
    Dof                 first = 0;
    std::vector<double> lengths;
  };
} // namespace Stroma::Rigid
