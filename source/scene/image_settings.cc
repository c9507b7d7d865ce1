#include <stroma/base/text.h>
#include <stroma/scene/image_settings.h>

#include <algorithm>

namespace Stroma
{
  namespace
  {
    const std::string threshold_words =
      "a number, 'Otsu', 'triangle' (both from the histogram), or 'percentile P', the "
      "value that P % of the voxels are below";

    void
    add_threshold_entry(Parameters &p, const std::string &name, const std::string &meaning, Image::Threshold &threshold)
    {
      using Kind = Image::Threshold::Kind;
      std::string text;
      p.add(name, text, meaning + ": " + threshold_words, true);
      const std::string percentile = "percentile ";
      if (text.empty())
        return;
      if (text == "Otsu" || text == "triangle")
        {
          threshold.kind = text == "Otsu" ? Kind::otsu : Kind::triangle;
          return;
        }
      const bool is_share = text.compare(0, percentile.size(), percentile) == 0;
      try
        {
          threshold.value = p.parse_number(name, is_share ? text.substr(percentile.size()) : text, "",
                                           is_share ? Range::closed(0, 100) : Range::any());
          threshold.kind  = is_share ? Kind::percentile : Kind::given;
        }
      catch (const UserError &)
        {
          throw UserError(p.where(name), "'" + name + "' was given as '" + shown(text) + "'; it must be " +
                                           threshold_words + ", with P of 0 to 100");
        }
    }
  } // namespace

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
    if (p.get_mode() == Parameters::Mode::document)
      return add_phantom(p);
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
    add_smoothing(p);
    add_threshold_entry(p, "Lower threshold", "grey value from which a voxel joins a structure", segment.lower);
    add_threshold_entry(p, "Upper threshold", "grey value that a structure must reach somewhere", segment.upper);
    p.add_choice<Image::Connectivity>("Connectivity", segment.connectivity,
                                      "voxels that touch by faces, or also by edges and corners",
                                      {{"faces", Image::Connectivity::faces}, {"full", Image::Connectivity::full}});
    add_cleaning(p);
  }

  void
  ImageSettings::add_smoothing(Parameters &p)
  {
    using Image::Smoothing;
    p.add_choice<Smoothing>("Smoothing", segment.smoothing, "of the grey values, before the thresholds",
                            {{"none", Smoothing::none},
                             {"median", Smoothing::median},
                             {"Gaussian", Smoothing::gaussian}});
    if (segment.smoothing == Smoothing::median)
      {
        std::vector<unsigned int> radius(segment.median_radius.begin(), segment.median_radius.end());
        p.add("Median radius", radius, "voxels to each side in x, y, z of the box whose median is taken",
              Range::closed(0, 10), 3);
        std::copy(radius.begin(), radius.end(), segment.median_radius.begin());
      }
    if (segment.smoothing == Smoothing::gaussian)
      {
        segment.deviation = std::numeric_limits<double>::quiet_NaN();
        p.add("Gaussian width", segment.deviation, "standard deviation of the Gaussian", "m", Range::positive());
      }
  }

  void
  ImageSettings::add_cleaning(Parameters &p)
  {
    p.add("Closing radius", segment.closing_radius,
          "gaps of the structure that a ball of this radius cannot get into are filled (after the thresholds); 0: none",
          "m", Range::non_negative());
    p.add("Smallest piece", segment.smallest_piece,
          "voxels that a connected piece of the structure must have, smaller ones are left out; 0: all stay");
    p.add("Largest piece only", segment.largest_only, "keep only the largest connected piece of the structure");
    where_pieces = p.where(segment.largest_only ? "Largest piece only" : "Smallest piece");
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
