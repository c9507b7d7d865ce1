#pragma once

#include <stroma/output/pvd.h>
#include <stroma/scene/voxel_materials.h>
#include <stroma/simulation/method.h>
#include <stroma/simulation/output_settings.h>

#include <map>

namespace Stroma
{
  /// The field files of a run in its folder: numbered records, and lists of them by time. All functions are collective.
  class FieldFiles
  {
  public:
    /// @param image of the scene's first body that is one, or nullptr
    FieldFiles(const OutputSettings &settings, const std::string &folder, unsigned int dim,
               const std::vector<std::string> &material_names, const VoxelMaterials *image, MPI_Comm comm);

    /// Takes over the lists up to @p time [s], of a run that goes on from there after @p n_records of its records. Records that
    /// a stop has written after its checkpoint keep their numbers. Returns whether there are any of that time.
    bool resume(double time, unsigned int n_records);

    /// Whether writing walks over all points of a state, to the same ones that results are of.
    bool
    visits_points() const
    {
      return !settings.image_fields.empty();
    }

    /// Writes the committed state of @p method. Throws OutputError. @p also is shown each point where that is so.
    void write(Method &method, const Output::StateView::Visit &also = {});

    /// Number of the next record.
    unsigned int
    counter() const
    {
      return number;
    }

  private:
    Output::PvdSeries &list(const std::string &file_name);

    const OutputSettings          &settings;
    const std::string              folder;
    const unsigned int             dim;
    const std::vector<std::string> material_names;
    const VoxelMaterials *const    image;
    const bool                     has_gradients; ///< whether those of points are written, or what follows from them
    const MPI_Comm                 comm;
    unsigned int                   number = 0;
    std::map<std::string, Output::PvdSeries> lists; ///< by file name
  };
} // namespace Stroma
