#pragma once

#include <stroma/rigid/unknowns.h>

namespace Stroma::Rigid
{
  /// A point of the material by the unknowns that carry it: x = X + sum of weight times u of nodes.
  template <int dim>
  struct CarriedPoint
  {
    struct Node
    {
      std::array<dealii::types::global_dof_index, dim> dofs;
      double                                           weight;
    };
    dealii::Point<dim> X;
    std::vector<Node>  nodes;

    /// Its displacement and the largest component of those of its nodes in @p u, which holds them all.
    dealii::Tensor<1, dim> displacement(const Vector &u) const;
    double                 largest(const Vector &u) const;
  };

  /**
   * What acts between points of the material and one rigid body: a force f(x') on the point, in the body's frame, where the point is
   * at x' = pivot + R^T (x - pivot - U). The forces on the point's unknowns and on U and l theta are f . dx'/dq; where f comes
   * from a potential of x' the tangent is symmetric, however the body turns.
   */
  template <int dim>
  class Coupling
  {
  public:
    using Vec = dealii::Tensor<1, dim>;

    /// @param r index among the scene's rigid bodies
    Coupling(const Scene<dim> &scene, const Unknowns<dim> &unknowns, unsigned int r);

    /// Takes the body to where @p u (relevant unknowns) has it.
    void set_pose(const Vector &u);
    /// Turns it on from there by @p change of the rotation [rad].
    void turn(const Axial<dim> &change);
    const Frame<dim> &
    frame() const
    {
      return now;
    }

    /// x' of a point in @p u.
    dealii::Point<dim>
    place(const CarriedPoint<dim> &point, const Vector &u) const
    {
      return now.in_body(point.X + point.displacement(u));
    }

    /// Adds the force @p f at @p x (both in the body's frame) on the point to @p r, and what it does to the body. Compress afterwards.
    void add_force(Vector &r, const CarriedPoint<dim> &point, const dealii::Point<dim> &x, const Vec &f) const;

    /// Adds its tangent to @p K, with @p S = -df/dx', and the share of jumps to @p r.
    void add_tangent(Matrix &K, Vector &r, const Solvers::Constraints &constraints, const CarriedPoint<dim> &point,
                     const dealii::Point<dim> &x, const Vec &f, const dealii::Tensor<2, dim> &S) const;

    void add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints,
                     const CarriedPoint<dim> &point) const;

  private:
    std::vector<dealii::types::global_dof_index> dofs(const CarriedPoint<dim> &point) const;

    const Unknowns<dim> &unknowns;
    const unsigned int   body;
    const bool           turns;
    Frame<dim>           now;
  };
} // namespace Stroma::Rigid
