#pragma once

#include <stroma/rigid/contact_set.h>

#include <functional>

namespace Stroma::Rigid
{
  /// The forces of all contacts of a scene, on the material and on the rigid bodies.
  template <int dim>
  class ContactTerm : public Solvers::Term
  {
  public:
    ContactTerm(const Scene<dim> &scene, const Unknowns<dim> &unknowns);

    /// @param inertia whether bodies with a mass are borne by it while they touch nothing @param points_of of this rank that may touch the body of a contact, without state. Throws UserError if a body lies in
    /// the material at the start. Collective.
    void rebuild(const ContactSettings &settings, bool inertia, double cell_size,
                 const std::function<std::vector<ContactPoint<dim>>(const Contact &)> &points_of);

    void add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const override;
    /// Collective.
    StepStatus add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage) override;
    StepStatus add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage,
                           const Solvers::Constraints &constraints) override;
    double     round_off() const override;
    /// What slides has a friction that follows the pressure, which no potential gives.
    bool symmetric() const override;

    bool
    empty() const
    {
      return contacts.empty();
    }
    /// The force of the last add_force() [N]; empty without contacts.
    const Vector &
    force() const
    {
      return last;
    }

    /// What ContactSet does, for all of them; displacements are of relevant unknowns, but for the first guess @p u.
    void       set_stage(double v_factor);
    void       start_step(const Vector &u);
    void       restore();
    StepStatus approach(Vector &u, const Vector &external, double t);
    bool       update(const Vector &u);
    /// Why a step has failed whose rounds have not come to an end; warns of bodies whose loads nothing bears.
    StepStatus                                  failure() const;
    std::vector<std::pair<std::string, double>> scalars(const Vector &u, const Vector &balanced) const;
    void                                        save(Output::ArchiveWriter &archive) const;
    void                                        load(const Output::ArchiveReader &archive);

  private:
    const Scene<dim>            &scene;
    const Unknowns<dim>         &unknowns;
    std::vector<ContactSet<dim>> contacts;
    Vector                       last;
    double                       summed = 0.; ///< [N]
  };
} // namespace Stroma::Rigid
