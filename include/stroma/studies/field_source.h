#pragma once

#include <stroma/base/errors.h>
#include <stroma/simulation/saved_run.h>
#include <stroma/studies/scene_geometry.h>

namespace Stroma::Studies
{
  /// Places of this rank that belong together with those of the others, with a name: "points", or the text of a line.
  struct PlaceSet
  {
    std::string     name;
    Output::Samples samples;
    std::size_t     first = 0; ///< of the rank's places, where these are a block of them
  };

  /// Where the values of a comparison come from: a run, an exact solution or a stored reference. All is collective.
  class FieldSource
  {
  public:
    virtual ~FieldSource() = default;

    /// For messages: "run results/a".
    virtual std::string name() const = 0;

    /// When values are known [s]; empty: at any time.
    virtual std::vector<double> times() const = 0;

    virtual std::vector<Output::Field> fields() = 0;

    /// By what its scene is known.
    virtual const SceneFrame &frame() const = 0;

    /// The only places where values are known at @p time; empty if they are known everywhere.
    virtual std::vector<PlaceSet>
    own_places(double /*time*/) const
    {
      return {};
    }

    /// Fills values and found of a set of places, whose samples have values of @p fields side by side afterwards.
    virtual void sample(const std::vector<std::string> &fields, double time, PlaceSet &places) = 0;
  };

  /// A run that kept its states.
  class RunSource : public FieldSource
  {
  public:
    /// Throws UserError if the folder holds no run or no states.
    RunSource(const std::string &folder, MPI_Comm comm);

    std::string
    name() const override
    {
      return "run " + folder;
    }
    std::vector<double>
    times() const override
    {
      return run.times();
    }
    std::vector<Output::Field>
    fields() override
    {
      return known;
    }
    const SceneFrame &
    frame() const override
    {
      return geometry->frame;
    }
    void sample(const std::vector<std::string> &fields, double time, PlaceSet &places) override;

    /// The method's own points of this rank with their values.
    Output::Samples own_samples(const std::vector<std::string> &fields, double time);

    /// Frees the memory of the state loaded last, which is read again where it is asked for again. Collective.
    void let_go();

    std::string                    folder;
    MPI_Comm                       comm;
    SavedRun                       run;
    std::unique_ptr<SceneGeometry> geometry;

  private:
    /// The state at the kept time nearest to @p time.
    const Output::StateView &at(double time, bool with_gradients);

    Method                            *method = nullptr; ///< loaded last
    std::unique_ptr<Output::StateView> view;             ///< of it
    double                             loaded_time   = 0.;
    bool                               has_gradients = false; ///< at its own points
    std::vector<Output::Field>         known;
  };

  /// Section 'Exact solution' of a run's parameter file.
  class ExactSource : public FieldSource
  {
  public:
    /// @param run must outlive this. Throws UserError if its scene has no exact solution.
    explicit ExactSource(RunSource &run);

    std::string
    name() const override
    {
      return "the exact solution";
    }
    std::vector<double>
    times() const override
    {
      return {};
    }
    std::vector<Output::Field>
    fields() override
    {
      return known;
    }
    const SceneFrame &
    frame() const override
    {
      return run.frame();
    }
    void sample(const std::vector<std::string> &fields, double time, PlaceSet &places) override;

  private:
    RunSource                 &run;
    std::vector<Output::Field> known;
  };

  /// What "B" on the command line means for run @p a: the word exact, a run's folder or a stored reference. Throws
  /// UserError, also if it is of another scene than @p a.
  std::unique_ptr<FieldSource> open_source(const std::string &what, RunSource &a, MPI_Comm comm);

  /// Names of fields, for messages.
  std::vector<std::string> names_of(const std::vector<Output::Field> &fields);

  /// Numbers a place of all these fields of a source.
  unsigned int n_components(FieldSource &source, const std::vector<std::string> &fields);
} // namespace Stroma::Studies
