#include <stroma/base/log.h>
#include <stroma/rigid/contact_term.h>

#include <algorithm>
#include <limits>

namespace Stroma::Rigid
{
  namespace
  {
    void
    warn_of_unborne(const std::string &body)
    {
      Log::warning("rigid body '" + body +
                   "' touches nothing, and nothing bears its load; prescribe how it moves, or end the run before");
    }
  } // namespace

  template <int dim>
  ContactTerm<dim>::ContactTerm(const Scene<dim> &scene, const Unknowns<dim> &unknowns)
    : scene(scene)
    , unknowns(unknowns)
  {}

  template <int dim>
  void
  ContactTerm<dim>::rebuild(const ContactSettings &settings, const bool inertia, const double cell_size,
                            const std::function<std::vector<ContactPoint<dim>>(const Contact &)> &points_of)
  {
    contacts.clear();
    for (const auto &contact : scene.contacts)
      contacts.emplace_back(scene, contact, settings, inertia, cell_size, unknowns, points_of(contact));
  }

  template <int dim>
  void
  ContactTerm<dim>::add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const
  {
    for (const auto &contact : contacts)
      contact.add_pattern(pattern, constraints);
  }

  template <int dim>
  StepStatus
  ContactTerm<dim>::add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &)
  {
    summed = 0.;
    if (contacts.empty())
      return StepStatus::ok;
    last.reinit(r);
    for (const auto &contact : contacts)
      {
        contact.add_force(last, motion.u);
        summed += contact.summed_force(motion.u);
      }
    last.compress(dealii::VectorOperation::add);
    r += last;
    return StepStatus::ok;
  }

  template <int dim>
  StepStatus
  ContactTerm<dim>::add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &,
                                const Solvers::Constraints &constraints)
  {
    for (const auto &contact : contacts)
      contact.add_tangent(K, r, motion.u, constraints);
    return StepStatus::ok;
  }

  template <int dim>
  double
  ContactTerm<dim>::round_off() const
  {
    return std::numeric_limits<double>::epsilon() * summed;
  }

  template <int dim>
  bool
  ContactTerm<dim>::symmetric() const
  {
    return std::none_of(scene.contacts.begin(), scene.contacts.end(),
                        [](const auto &contact) { return contact.type == Contact::Type::coulomb; });
  }

  template <int dim>
  void
  ContactTerm<dim>::set_stage(const double v_factor)
  {
    for (auto &contact : contacts)
      contact.set_stage(v_factor);
  }

  template <int dim>
  void
  ContactTerm<dim>::start_step(const Vector &u)
  {
    for (auto &contact : contacts)
      contact.start_step(u);
  }

  template <int dim>
  void
  ContactTerm<dim>::restore()
  {
    for (auto &contact : contacts)
      contact.restore();
  }

  template <int dim>
  StepStatus
  ContactTerm<dim>::approach(Vector &u, const Vector &external, const double t)
  {
    StepStatus status = StepStatus::ok;
    for (auto &contact : contacts)
      if (!contact.approach(u, external, t))
        {
          warn_of_unborne(contact.body_name());
          status = StepStatus::not_borne;
        }
    return status;
  }

  template <int dim>
  bool
  ContactTerm<dim>::update(const Vector &u)
  {
    bool again = false;
    for (auto &contact : contacts)
      again |= contact.update(u);
    return again;
  }

  template <int dim>
  StepStatus
  ContactTerm<dim>::failure() const
  {
    StepStatus status = StepStatus::diverged;
    for (const auto &contact : contacts)
      if (contact.is_unborne())
        {
          warn_of_unborne(contact.body_name());
          status = StepStatus::not_borne;
        }
    return status;
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  ContactTerm<dim>::scalars(const Vector &u, const Vector &balanced) const
  {
    std::vector<std::pair<std::string, double>> all;
    for (const auto &contact : contacts)
      for (const auto &scalar : contact.scalars(u, balanced))
        all.push_back(scalar);
    return all;
  }

  template <int dim>
  void
  ContactTerm<dim>::save(Output::ArchiveWriter &archive) const
  {
    for (const auto &contact : contacts)
      contact.save(archive);
  }

  template <int dim>
  void
  ContactTerm<dim>::load(const Output::ArchiveReader &archive)
  {
    for (auto &contact : contacts)
      contact.load(archive);
  }

  template class ContactTerm<2>;
  template class ContactTerm<3>;
} // namespace Stroma::Rigid
