#include "image_settings.h"

#include <algorithm>

namespace Stroma
{
  void
  ImageSettings::add(Parameters &p)
  {
    p.add_file("File", file,
               "image (TIFF, NRRD, NIfTI or MetaImage), found from here or from this file's folder; or 'phantom'",
               "phantom");
    add_spacing(p);
    p.add("Channel", reading.channel, "channel to use of several, counted from 1; 0: the image has one");
    p.add("Frame", reading.frame, "time frame to use of several, counted from 1; 0: the image has one");
    p.add("Crop first", crop_first, "first voxel to use in x, y, z; empty: all voxels", Range::non_negative());
    p.add("Crop size", crop_size, "number of voxels to use in x, y, z", Range::at_least(1));
    p.add("Voxels per point", merge, "voxels merged into one in x, y, z, by majority; changes the materials' fractions",
          Range::at_least(1), 3);
    add_threshold(p);
    p.add("Materials", materials,
          "label: material (or 'empty') for each label, also '3-7: material' and 'all others: material'; "
          "a threshold gives labels 0 and 1");
    where_file      = p.where("File");
    where_threshold = p.where("Upper threshold");
    where_materials = p.where("Materials");
    where_crop      = p.where("Crop size");
    where_merge     = p.where("Voxels per point");
    if (materials.empty() && p.get_mode() == Parameters::Mode::read)
      throw UserError(p.where_section(), "'Materials' is missing; give 'label: material' for each label of the image");
    if (crop_first.size() != crop_size.size() || (!crop_size.empty() && crop_size.size() != 3))
      throw UserError(where_crop, "'Crop first' and 'Crop size' each take three whole numbers, or both are left out");
    add_phantom(p);
  }

  void
  ImageSettings::add_spacing(Parameters &p)
  {
    std::vector<double> voxel_size, corner_given;
    double              unit = 0;
    p.add("Voxel size", voxel_size, "edges of a voxel along x, y, z; empty: as the image says (never for TIFF)", "m",
          Range::positive());
    p.add_choice<double>("Spacing unit", unit,
                         "unit of the spacing stored in the image; another one than the image names is an error",
                         {{"image or um", 0.}, {"um", 1e-6}, {"mm", 1e-3}, {"nm", 1e-9}, {"m", 1.}});
    p.add_choice<bool>(
      "Axes", reading.stored_axes,
      "x, y, z are the coordinates of the image's header (NIfTI: right, front, top; others: as their "
      "space says; its origin is not used), or its columns, rows (y downwards in a viewer) and slices as "
      "stored",
      {{"header", false}, {"stored", true}});
    p.add("Corner", corner_given, "lower corner of the first voxel; empty: 0", "m", Range::any());
    if (!voxel_size.empty() && voxel_size.size() != 3)
      throw UserError(p.where("Voxel size"), "'Voxel size' takes three lengths, for x, y and z");
    if (!corner_given.empty() && corner_given.size() != 3)
      throw UserError(p.where("Corner"), "'Corner' takes three coordinates, x, y and z");
    if (!voxel_size.empty())
      reading.voxel_size = std::array<double, 3>{{voxel_size[0], voxel_size[1], voxel_size[2]}};
    if (unit > 0)
      reading.spacing_unit = unit;
    std::copy(corner_given.begin(), corner_given.end(), corner.begin());
  }

  void
  ImageSettings::add_threshold(Parameters &p)
  {
    p.add_choice<bool>("Interpretation", threshold, "values are labels, or grey values to be thresholded",
                       {{"labels", false}, {"threshold", true}});
    if (!threshold)
      return;
    p.add("Lower threshold", lower_threshold, "grey value from which a voxel joins a structure", "", Range::any());
    p.add("Upper threshold", upper_threshold, "grey value that a structure must reach somewhere", "", Range::any());
    p.add_choice<Image::Connectivity>("Connectivity", connectivity,
                                      "voxels that touch by faces, or also by edges and corners",
                                      {{"faces", Image::Connectivity::faces}, {"full", Image::Connectivity::full}});
  }

  void
  ImageSettings::add_phantom(Parameters &p)
  {
    const auto                section = p.section("Phantom", "the synthetic microvessels of 'File = phantom'");
    std::vector<unsigned int> size(phantom.size.begin(), phantom.size.end());
    std::vector<double>       voxel(phantom.voxel_size.begin(), phantom.voxel_size.end());
    p.add("Size", size, "number of voxels in x, y, z", Range::at_least(1), 3);
    p.add("Voxel size", voxel, "edges of a voxel", "m", Range::positive(), 3);
    p.add("Vessel fraction", phantom.vessel_fraction, "share of the voxels that are vessel", "",
          Range{0, .5, true, false});
    p.add("Radius", phantom.radius, "mean vessel radius", "m", Range::positive());
    p.add("Blur", phantom.blur, "standard deviation of the blur", "m", Range::non_negative());
    p.add("Noise", phantom.noise, "standard deviation of the noise over the contrast", "", Range::non_negative());
    p.add("Seed", phantom.seed, "the same seed gives the same phantom");
    std::copy(size.begin(), size.end(), phantom.size.begin());
    std::copy(voxel.begin(), voxel.end(), phantom.voxel_size.begin());
  }
} // namespace Stroma
