#pragma once

#include <stroma/solvers/grid_system.h>

#include <deal.II/base/index_set.h>

/**
 * A chain of n nonlinear springs of length 1 between nodes 0 ... n on all ranks. A spring of stretch l carries the
 * force k (l - l^-2), with k = 1 and 2 in turn, and is turned inside out at l <= 0. Node 0 is fixed; node n is either
 * moved to a prescribed place or pulled by a force.
 */
class SpringChain : public Stroma::Solvers::GridSystem
{
public:
  /// @param foundation stiffness of a further, linear spring from each node to its first place
  explicit SpringChain(unsigned int n, double foundation = 0.);

  void move_end(double displacement);
  void pull_end(double force);

  Stroma::StepStatus residual(Stroma::Vector &r, const Stroma::Vector &u) override;
  Stroma::StepStatus tangent(Stroma::Matrix &K, Stroma::Vector &r, const Stroma::Vector &u) override;
  double
  force_scale() const override
  {
    return scale;
  }
  double
  round_off() const override
  {
    return noise;
  }

  Stroma::Vector vector() const;
  Stroma::Matrix matrix() const;

  /// Stretch of a spring of stiffness k under @p force.
  static double stretch(double force, double k);
  /// Value of node @p i on all ranks.
  double value(const Stroma::Vector &v, unsigned int i) const;

  Stroma::Vector last_u; ///< of the last residual()

private:
  double
  stiffness(unsigned int spring) const
  {
    return spring % 2 == 0 ? 1. : 2.;
  }
  double
  prescribed(unsigned int node) const
  {
    return node == 0 ? 0. : end_displacement;
  }
  bool
  constrained(unsigned int node) const
  {
    return node == 0 || (node == n && end_is_moved);
  }
  double get_stretch(unsigned int spring) const;

  unsigned int     n;
  double           foundation;
  dealii::IndexSet owned, relevant;
  Stroma::Vector   ghosted;
  bool             end_is_moved     = true;
  double           end_displacement = 0., end_force = 0., scale = 0., noise = 0.;
};
