#include <stroma/base/text.h>
#include <stroma/simulation/output_settings.h>

#include <algorithm>

namespace Stroma
{
  /// With them the default is to write no other fields.
  void
  OutputSettings::add_images(Parameters &p, const std::vector<std::string> &of_images)
  {
    p.add(
      "Image fields", image_fields,
      "fields on the voxels of the scan, an image each in its place, of displacement, von_mises, pressure, "
      "cauchy_stress, J, ...; no number (nan) where there is no material. Fields of points and of the grid are then "
      "written only if they are asked for");
    p.add_choice<Image::ScalarFormat>(
      "Image format", image_format,
      "of image fields, single precision: NRRD (3D Slicer, Fiji, napari), TIFF stacks (Fiji), or VTI (ParaView)",
      {{"nrrd", Image::ScalarFormat::nrrd}, {"tiff", Image::ScalarFormat::tiff}, {"vti", Image::ScalarFormat::vti}});
    if (image_fields.empty())
      return;
    if (of_images.empty())
      throw UserError(p.where("Image fields"),
                      "'Image fields' go with 'Method = mpm', 'Points at = lattice' and one body with 'Shape = image'");
    for (const auto &name : image_fields)
      if (std::find(of_images.begin(), of_images.end(), name) == of_images.end())
        throw UserError(p.where("Image fields"),
                        "'Image fields' names '" + shown(name) + "'; it must be of: " + join(of_images, ", "));
    point_fields.clear();
    grid_fields = false;
  }

  void
  OutputSettings::add(Parameters &p, const std::vector<std::string> &known, const std::vector<std::string> &of_images)
  {
    const auto is_unknown = [&](const std::string &name) {
      return std::find(known.begin(), known.end(), name) == known.end();
    };
    const auto add_fields = [&](const std::string &entry, std::vector<std::string> &names, const std::string &meaning) {
      p.add(entry, names, meaning + ", of: " + join(known, ", ") + "; or none");
      if (names.size() == 1 && names[0] == "none")
        names.clear();
      for (const auto &name : names)
        if (is_unknown(name))
          throw UserError(p.where(entry), "'" + entry + "' names '" + shown(name) +
                                            "'; it must be of: " + join(known, ", ") + ", or 'none'");
    };
    // Not every method has the fields that are written by default.
    point_fields.erase(std::remove_if(point_fields.begin(), point_fields.end(), is_unknown), point_fields.end());
    add_images(p, of_images);
    p.add("Fields every", fields_every, "steps between field files, from the start on; 0: only at the end");
    p.add("Fields at", fields_at, "times of further field files, besides start and end; steps end there", "s",
          Range::positive());
    add_fields("Point fields", point_fields, "fields at points");
    add_fields("Results by material", by_material, "mean, quantiles and histogram at the end, of each material");
    add_fields("Results by body", by_body, "mean, quantiles and histogram at the end, of each body");
    p.add("Grid fields", grid_fields, "write displacement, forces and cell averages on the grid");
    p.add_choice<Output::Format>("Format", format, "files of points: VTU for ParaView, or HDF5 with XDMF",
                                 {{"vtu", Output::Format::vtu}, {"xdmf", Output::Format::xdmf}});
    bool of_scene = false;
    p.add_choice<bool>("Units", of_scene, "of places and fields in field files: SI, or the scene's (section Units)",
                       {{"SI", false}, {"scene", true}});
    units = of_scene ? Output::FileUnits(p) : Output::FileUnits();
    p.add("Checkpoint every", checkpoint_every,
          "steps between checkpoints; 0: none (a stopped or failed run always saves)");
    p.add("Keep states", keep_states,
          "keep the whole state at every field file but that of the start, for 'stroma compare'");
  }
} // namespace Stroma
