#pragma once

#include <stroma/base/parameter_file.h>
#include <stroma/studies/compare.h>

#include <string>
#include <vector>

namespace Stroma::Studies
{
  /// An entry of the scene and the values that it takes.
  struct Varied
  {
    std::string              name; ///< of its section
    std::string              parameter;
    std::vector<std::string> values;
    std::vector<double>      numbers; ///< the values, or what they grow by; not a number where they are words
    std::vector<std::string> only;    ///< names of the cases that it applies to; empty: all
    std::string              where;
  };

  /// A curve: a name and what it sets ("Section/name=value").
  struct StudyCase
  {
    std::string              name; ///< empty if the study has no cases
    std::vector<std::string> set;
    std::string              where;
  };

  /// Which norm makes the error of the table.
  enum class ErrorNorm
  {
    L2,
    H1,
    max
  };

  /// Sections Error and Reference of a study.
  struct ErrorPlan
  {
    bool                     wanted = false;
    std::string              against; ///< "exact", "reference" (a run of its own) or a path
    ErrorNorm                norm = ErrorNorm::L2;
    CompareOptions           compare;
    std::vector<std::string> reference; ///< what the reference run sets
    std::string              where_reference;
    std::string              key; ///< all entries as text: the same key gives the same errors
  };

  /// One run of a study.
  struct PlannedRun
  {
    unsigned int             in_case = 0;
    std::vector<std::string> values;           ///< of each Varied; "-" where it does not apply
    std::vector<std::string> set;              ///< "Section/name=value"
    std::string              folder;           ///< name below the study's folder
    std::string              curve;            ///< the case and all values but that of `axis`
    int                      axis        = -1; ///< the last Varied that applies
    int                      coarser     = -1; ///< the run with the axis' previous value
    double                   axis_number = 0.; ///< value along the axis
  };

  struct StudyPlan
  {
    std::vector<std::string> results;       ///< columns
    std::string              where_results; ///< of what names them in the file; empty: they are the default
    std::vector<std::string> published;     ///< of the first result, one a run, or none
    unsigned int             repeat       = 3;
    double                   repeat_below = 5.; ///< wall time [s]
    std::vector<StudyCase>   cases;
    std::vector<Varied>      varied;
    int                      averaged = -1; ///< number of the Varied over which means are taken; -1: none
    ErrorPlan                error;
    std::vector<PlannedRun>  runs;
  };

  /// Reads section Study. Throws UserError for what cannot be done, first for what is unknown in the whole file; the values
  /// themselves are not tried. Collective.
  StudyPlan read_plan(const ParameterFile &file, MPI_Comm comm);

  /// "Method = fem, MPM/Cells = 8, 8" -> {"Method = fem", "MPM/Cells = 8, 8"}: a part without '=' belongs to the one before.
  std::vector<std::string> assignments(const std::string &text);
} // namespace Stroma::Studies
