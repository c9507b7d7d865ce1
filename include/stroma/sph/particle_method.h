#pragma once

#include <stroma/simulation/method.h>
#include <stroma/sph/system.h>

#include <memory>

namespace Stroma::Sph
{
  /// What NSPH and SPH have in common: all but how they step.
  template <int dim>
  class ParticleMethod : public Method
  {
  public:
    void                               setup(const Output::ArchiveReader *archive) override;
    void                               describe(Output::Summary &summary) override;
    void                               save(Output::ArchiveWriter &archive) const override;
    std::unique_ptr<Output::StateView> state(bool with_gradients) override;
    std::string
    write_grid(const Output::FieldRequest &) override
    {
      return "";
    }

  protected:
    /// Declares and reads section NSPH or SPH.
    ParticleMethod(Parameters &p, const Scene<dim> &scene, Dynamics dynamics, double end_time, Timers &timers);

    /// After the particles are there: limits of the step, what can be checked only now. Collective.
    /// @param archive what is continued with the particles in the order that they had there, or nullptr
    virtual void prepare(const Output::ArchiveReader *archive) = 0;
    /// Name, parts and results of the derived method.
    virtual void describe_stepping(Output::Summary &summary) const = 0;

    /// Reactions and energies of the committed state. Collective.
    void collect_scalars(double t);

    const Scene<dim> &scene;
    Timers           &timers;
    const Dynamics    dynamics;
    const double      end_time; ///< [s]
    const Settings    settings;

    std::unique_ptr<System<dim>> system;

  private:
    class View;

    bool                      restore(const Output::ArchiveReader &archive);
    void                      restore_bodies(const Output::ArchiveReader &archive);
    void                      find_geometry();
    void                      collect_sums();
    void                      collect_momenta();
    void                      describe_parts(Output::Summary &summary) const;
    std::vector<unsigned int> used_fields() const;
  };
} // namespace Stroma::Sph
