#pragma once

#include <stroma/image/read.h>
#include <stroma/scans/segmentation.h>

#include <mpi.h>

#include <string>
#include <vector>

namespace Stroma::Scans
{
  /// What `stroma image` is asked.
  struct ImageRequest
  {
    std::string              file;
    Image::ReadOptions       reading;           ///< where no scene says it
    std::string              output;            ///< folder, or empty: results/<stem of file>_image
    bool                     overwrite = false; ///< replace an earlier report
    std::string              scene;             ///< parameter file that segments it, or empty
    std::vector<std::string> set;               ///< its entries to override
    std::string              body;              ///< that the file is for; may be empty if only one is an image
    LabelRequest             labels;
    std::string              written; ///< file of the segmentation, or empty: <output>/segmentation.nrrd
  };

  /**
   * Says what an image holds, and how a scene segments it: prints it, and leaves image.json, histogram.csv, pieces.csv, the
   * segmentation and middle planes in a folder. Throws UserError and OutputError. Collective; rank 0 works.
   * @return the folder
   */
  std::string describe_image(const ImageRequest &request, MPI_Comm comm);
} // namespace Stroma::Scans
