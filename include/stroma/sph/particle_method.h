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
    void setup(const Output::ArchiveReader *archive) override;
    std::vector<std::pair<std::string, double>>      scalars() const override { return committed_scalars; }
    std::vector<std::pair<std::string, std::string>> write_fields(const FieldRequest &request) override;
    void                                             describe(Output::Summary &summary) override;
    void                                             save(Output::ArchiveWriter &archive) const override;
    std::vector<double>                              times_to_meet() const override { return {}; }
    std::vector<SampledField>                        sampled_fields() const override;
    void                                             sample(const std::vector<std::string> &fields, Samples &samples) override;
    Samples                                          own_samples(const std::vector<std::string> &fields) override;
    std::vector<std::string>                         known_point_fields() const override;

  protected:
    /// Declares and reads section NSPH or SPH.
    ParticleMethod(Parameters &p, const Scene<dim> &scene, Dynamics dynamics, double end_time, Timers &timers);

    /// After the particles are there: limits of the step, what can be checked only now. Collective.
    /// @param archive what is continued, on the same ranks and from the geometry that it has; or nullptr
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
    double                       time = 0.; ///< of the committed state [s]

  private:
    void restore(const Output::ArchiveReader &archive);
    bool restore_geometry(const Output::ArchiveReader &archive);
    void find_geometry();
    void restore_scalars(const Output::ArchiveReader &archive);
    void save_geometry(Output::ArchiveWriter &archive) const;
    void collect_sums();
    void describe_parts(Output::Summary &summary) const;
    void stress_results(Output::Summary &summary) const;
    void error_results(Output::Summary &summary) const;
    void vector_error(const std::string &name, const SpaceTimeVector<dim> &solution, Output::Summary &summary) const;
    std::vector<unsigned int> used_fields() const;

    std::vector<std::pair<std::string, double>> committed_scalars;
  };
} // namespace Stroma::Sph
