#pragma once

#include <stroma/output/grid_writer.h>
#include <stroma/output/point_writer.h>
#include <stroma/output/state_fields.h>

#include <deal.II/base/mpi.h>

#include <functional>
#include <string>
#include <vector>

namespace Stroma::Output
{
  /// Places of the undeformed scene and values there. Each rank has its own, and any number of them.
  struct Samples
  {
    std::vector<Place>        X;        ///< undeformed places [m]
    std::vector<double>       weight;   ///< undeformed volume that each stands for [m^3]; may be empty
    std::vector<unsigned int> material; ///< index into the scene's materials; may be empty
    std::vector<double>       values;   ///< all components of all asked fields of a place side by side
    std::vector<bool>         found;    ///< whether there is material with values; empty: everywhere
  };

  /**
   * The committed state of a method, to look at: its own sample points, each on the rank that has it, and any place of
   * the scene. Point files, quantiles, means of cells, error norms, probes and comparisons follow from it. It holds
   * until the method goes on.
   */
  class StateView
  {
  public:
    virtual ~StateView() = default;

    /// Number of sample points of this rank, those of walls included. Local.
    virtual std::size_t n_points() const = 0;

    using Visit = std::function<void(const PointState &)>;

    /// Calls @p visit for each sample point of this rank: material points, particles (those of walls last) or quadrature
    /// points. Collective.
    virtual void for_each_point(const Visit &visit) const = 0;

    /// Fills values and found of @p samples, places of this rank; the ranks that know them answer. Collective.
    virtual void sample(const StateFields &fields, Samples &samples) const = 0;

    /// Whether the pressure is known up to a constant only.
    virtual bool
    pressure_level_is_free() const
    {
      return false;
    }
  };

  /// The sample points of this rank with their values; those of walls are left out. Collective.
  Samples own_samples(const StateView &state, const StateFields &fields);

  /// What fields to write, and where.
  struct FieldRequest
  {
    std::string              folder;
    unsigned int             counter;
    std::vector<std::string> point_fields; ///< names without unit
    bool                     grid_fields;
    Format                   format;
    std::vector<std::string> material_names; ///< what the numbers of the field "material" mean
    FileUnits                units;

    /// What a file says of itself. @p positions: in which state places are, "deformed" or "undeformed"
    FileNotes notes(const std::string &positions) const;

    GridFile
    grid_file(const std::string &positions) const
    {
      return {folder, counter, units, notes(positions)};
    }
  };

  /// Names of the records of the points of a state.
  struct PointRecords
  {
    std::string points, walls; ///< of the material; of particles of walls and rigid bodies, "" where there are none
  };

  /// Writes the sample points, where they are now, with the fields that are asked for; those of walls apart. Throws
  /// OutputError on all ranks. Collective.
  PointRecords write_points(const StateView &state, unsigned int dim, const FieldRequest &request, MPI_Comm comm);

  /// Volume-weighted means of fields over the points of each cell of a grid.
  struct CellMeans
  {
    std::vector<StateFields::Number>    numbers; ///< what each is
    std::vector<dealii::Vector<double>> values;
    dealii::Vector<double>              volume; ///< of the points of each cell [m^3]

    std::vector<CellField> fields() const; ///< of the means, which must outlive them
  };
  /// @param n_cells active cells that this rank knows. Collective.
  CellMeans cell_means(const StateView &state, const StateFields &fields, unsigned int n_cells);
} // namespace Stroma::Output
