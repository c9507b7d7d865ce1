#pragma once

#include <stroma/output/state_view.h>
#include <stroma/scene/voxel_materials.h>
#include <stroma/simulation/output_settings.h>

namespace Stroma
{
  /**
   * Writes fields on the voxels of an image, in the place that its file gives them: of each voxel the mean of its sample points
   * by their volume, nan where there are none. @p also is shown each point as well. Returns the name of the first file. Throws OutputError on all ranks.
   * Collective.
   */
  std::string write_image_fields(const Output::StateView &state, const VoxelMaterials &image,
                                 const OutputSettings &settings, const Output::FieldRequest &request, unsigned int dim,
                                 const Output::StateView::Visit &also, MPI_Comm comm);
} // namespace Stroma
