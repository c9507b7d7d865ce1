#pragma once

#include <stroma/studies/compare.h>

namespace Stroma::Studies
{
  /// Values of a run or of an exact solution at fixed places, kept in one HDF5 file (output/archive.h) so that later runs
  /// can be compared with it when it is gone.
  class ReferenceSource : public FieldSource
  {
  public:
    /// Throws UserError if the file is no such reference.
    ReferenceSource(const std::string &path, MPI_Comm comm);

    std::string
    name() const override
    {
      return "reference " + path;
    }
    std::vector<double>
    times() const override
    {
      return known_times;
    }
    std::vector<Output::Field>
    fields() override
    {
      return known_fields;
    }
    const SceneFrame &
    frame() const override
    {
      return scene;
    }
    std::vector<PlaceSet> own_places(double time) const override;
    void                  sample(const std::vector<std::string> &fields, double time, PlaceSet &places) override;

  private:
    std::size_t nearest(double time) const;

    std::string                        path;
    SceneFrame                         scene;
    std::vector<Output::Field>         known_fields;
    std::vector<double>                known_times;
    std::vector<std::vector<PlaceSet>> places; ///< of each time, with values
  };

  /// Throws UserError if write_reference() would replace a file that is no reference, or has no folder to write to. Collective.
  void check_reference_target(const std::string &path, MPI_Comm comm);

  /// Writes what compare() kept of B. Throws OutputError on all ranks if the file cannot be written. Collective.
  void write_reference(const std::string &path, const Comparison &comparison, MPI_Comm comm);
} // namespace Stroma::Studies
