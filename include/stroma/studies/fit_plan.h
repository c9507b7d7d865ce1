#pragma once

#include <stroma/base/parameter_file.h>
#include <stroma/studies/least_squares.h>
#include <stroma/studies/measured.h>

#include <deal.II/base/mpi.h>

#include <string>
#include <vector>

namespace Stroma::Studies
{
  /// One curve that was measured.
  struct DataSet
  {
    std::string     name, where, file;
    MeasuredColumns columns;
    Measured        measured;
    unsigned int    scene = 0; ///< number of the FitScene whose run it is compared with
  };

  /// A scene whose run is compared with data: how it differs from that of the file.
  struct FitScene
  {
    std::string              name; ///< of the first data set that has it
    std::vector<std::string> set;  ///< "Section/name=value"
  };

  /// Section Fit.
  struct FitPlan
  {
    std::vector<Unknown>  unknowns; ///< constants
    std::vector<DataSet>  data;
    std::vector<FitScene> scenes;
    double                difference = 1e-3; ///< for derivatives: change of a constant over itself
    unsigned int          most       = 50;   ///< steps at most

    unsigned int n_data() const;
  };

  /**
   * Reads section Fit and the files of data that it names:
   *   subsection Fit
   *     subsection Parameters
   *       subsection ratio                        # a constant of section Constants
   *         set Lower = 1
   *         set Upper = 10
   *         set Start = 3                         # default: its value in section Constants
   *         set Scale = logarithmic               # or linear
   *       end
   *     end
   *     subsection Data
   *       subsection scan_1
   *         set File      = forces.csv
   *         set Against   = strain_y              # or time_s
   *         set Quantity  = reaction_force_y_N    # any column of series.csv
   *         set Deviation = deviation_N           # optional: column of standard deviations
   *         set Set       = Bodies/construct/File = scan_1.nrrd   # optional: how this scene differs
   *       end
   *     end
   *   end
   * Throws UserError for what cannot be done. Collective.
   */
  FitPlan read_fit_plan(const ParameterFile &file, MPI_Comm comm);
} // namespace Stroma::Studies
