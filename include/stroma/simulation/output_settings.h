#pragma once

#include <stroma/base/parameters.h>
#include <stroma/image/scalar_images.h>
#include <stroma/output/point_writer.h>

namespace Stroma
{
  /// The `Output` section.
  struct OutputSettings
  {
    unsigned int             fields_every = 0; ///< steps; 0: only the end
    std::vector<double>      fields_at;        ///< times that are met and written [s]
    std::vector<std::string> point_fields = {"displacement",  "velocity", "von_mises", "pressure",
                                             "cauchy_stress", "J",        "material"};
    std::vector<std::string> by_material, by_body; ///< fields whose mean and quantiles are told of each
    std::vector<std::string> image_fields;         ///< on the voxels of the scene's image
    Image::ScalarFormat      image_format = Image::ScalarFormat::nrrd;
    bool                     grid_fields  = true;
    Output::Format           format       = Output::Format::vtu;
    Output::FileUnits        units;                    ///< of field files
    unsigned int             checkpoint_every = 0;     ///< steps; 0: never
    bool                     keep_states      = false; ///< for `stroma compare`

    /// @param known names of the method's point fields @param of_images of those that it has for voxels
    void add(Parameters &p, const std::vector<std::string> &known, const std::vector<std::string> &of_images);

  private:
    void add_images(Parameters &p, const std::vector<std::string> &of_images);
  };
} // namespace Stroma
