#pragma once

#include <stroma/base/log.h>
#include <stroma/solvers/grid_system.h>
#include <stroma/solvers/term.h>

namespace Stroma::Solvers
{
  /**
   * The balance of forces of one implicit solve as a sum: f_ext + sum_i f_i(u, v, a) = 0, with v and a as the stage says. The
   * external forces are dead: known with the stage, they need neither tangent nor pattern, and so are a vector, no term.
   */
  class SumOfTerms : public GridSystem
  {
  public:
    SumOfTerms(Timers &timers, MPI_Comm comm);

    StepStatus residual(Vector &r, const Vector &u) override;
    /// An empty @p K is made to fit the unknowns first: whoever never solves has no matrix.
    StepStatus tangent(Matrix &K, Vector &r, const Vector &u) override;
    bool       symmetric() const override;
    double
    force_scale() const override
    {
      return internal_force_norm;
    }
    double
    round_off() const override
    {
      return round_off_norm;
    }

    /// Keeps what the next step starts from, at the u of the last residual(). Collective.
    void commit();

    /// A zero vector over the owned unknowns.
    Vector
    new_vector() const
    {
      return Vector(owned, comm);
    }

    /// Sets the unknowns of @p u (owned) that follow others; it with ghosts, until anything else is asked. Collective.
    const Vector &with_ghosts(Vector &u);

    /// External forces of the stage, empty if there never are any [N], and its time [s].
    const Vector &
    external_forces() const
    {
      return external;
    }
    double
    time() const
    {
      return stage.t;
    }

    /// Sum of all forces on all unknowns from the last residual(): on held ones, minus the reaction.
    const Vector &
    unbalanced_forces() const
    {
      return unbalanced;
    }

    /// The system's vectors and whether they are allocated, for the summary.
    std::vector<std::pair<std::string, bool>> vectors() const;

  protected:
    /// A held unknown that is relevant on this rank.
    struct Held
    {
      dealii::types::global_dof_index dof;
      double                          target; ///< in this stage [m]
    };

    /// What motions of a scene have besides displacements.
    struct Rates
    {
      bool velocity = false, acceleration = false;
    };

    /// Makes vectors over new unknowns. Collective.
    void reinit(const dealii::IndexSet &owned, const dealii::IndexSet &relevant, Rates rates, bool has_external);

    /// Makes @p K fit the present unknowns, if it is empty. Collective.
    void shape(Matrix &K) const;

    /// Sets the motion with ghosts to that of the stage at @p u.
    void find_motion(const Vector &u);

    /// The forces of all terms at the motion found, into the unbalanced ones. Collective.
    StepStatus sum_terms();

    /// Sets the unknowns of @p u that follow others from those. Collective.
    virtual void
    tie(Vector & /*u*/) const
    {}
    /// The same of a velocity or an acceleration at the u of the last tie(). Collective.
    virtual void
    tie_rate(Vector & /*v*/) const
    {}
    /// Moves forces on unknowns that follow others to those, as far as terms have not. Collective.
    virtual void
    condense(Vector & /*force*/)
    {}
    /// Ties and held unknowns, the latter with inhomogeneity @p jump (by position in held). Closed.
    virtual Constraints constraints(const std::vector<double> &jump) const = 0;
    /// Ties and held unknowns with all entries that the former may ever have. Closed.
    virtual Constraints
    pattern_constraints() const
    {
      return constraints(std::vector<double>(held.size(), 0.));
    }
    /// Adds rows of the pattern that belong to no term.
    virtual void
    add_pattern(Pattern & /*pattern*/) const
    {}
    /// Whether the tangent is still the one assembled last. Collective.
    virtual bool
    is_assembled(const std::vector<double> & /*jump*/)
    {
      return false;
    }
    /// Fills rows of the compressed tangent that no term has filled. Collective.
    virtual void
    fill_empty_rows(Matrix & /*K*/, Vector & /*r*/, const Constraints & /*constraints*/) const
    {}

    Timers             &timers;
    MPI_Comm            comm;
    dealii::IndexSet    owned, relevant;
    std::vector<Term *> terms; ///< in the order in which they are summed up
    std::vector<Held>   held;
    Stage               stage;
    Motion              motion; ///< with ghosts
    Vector              unbalanced;
    Vector              external; ///< forces of the stage; empty if there never are any

  private:
    double internal_force_norm = 0., round_off_norm = 0.;
  };
} // namespace Stroma::Solvers
