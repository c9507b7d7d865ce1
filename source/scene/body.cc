#include <stroma/base/memory.h>
#include <stroma/base/on_root.h>
#include <stroma/base/text.h>
#include <stroma/image/crop.h>
#include <stroma/image/merge.h>
#include <stroma/image/phantom.h>
#include <stroma/image/read.h>
#include <stroma/image/segment.h>
#include <stroma/scene/body.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

namespace Stroma
{
  namespace
  {
    enum class Interpretation
    {
      labels,
      threshold
    };

    /// The entries that say how an image becomes material.
    struct ImageSettings
    {
      std::string                 file;
      std::vector<double>         voxel_size;
      std::vector<double>         corner;
      double                      spacing_unit = 1e-6;
      std::vector<unsigned int>   crop_first, crop_size;
      Interpretation              interpretation  = Interpretation::labels;
      double                      lower_threshold = std::nan(""), upper_threshold = std::nan("");
      Image::Connectivity         connectivity = Image::Connectivity::faces;
      std::vector<unsigned int>   merge        = {1, 1, 1};
      std::vector<std::string>    materials;
      Image::PhantomSettings      phantom;
      std::string                 where_file, where_threshold, where_materials, where_crop, where_merge, folder;

      void add(Parameters &p);
      void add_phantom(Parameters &p);
    };

    void
    ImageSettings::add(Parameters &p)
    {
      p.add("File", file, "image (TIFF, NRRD, NIfTI or MHA), found from here or from this file's folder; or 'phantom'",
            true);
      p.add("Voxel size", voxel_size, "edges of a voxel; empty: as the image says (never for TIFF)", "m",
            Range::positive());
      p.add("Corner", corner, "lower corner of the first voxel; empty: 0", "m", Range::any());
      p.add_choice<double>("Spacing unit", spacing_unit, "unit of the spacing stored in the image",
                           {{"um", 1e-6}, {"mm", 1e-3}, {"nm", 1e-9}, {"m", 1.}});
      p.add("Crop first", crop_first, "first voxel to use in x, y, z; empty: all voxels", Range::non_negative());
      p.add("Crop size", crop_size, "number of voxels to use in x, y, z", Range::at_least(1));
      p.add("Voxels per point", merge, "voxels merged into one in x, y, z, by majority", Range::at_least(1), 3);
      p.add_choice<Interpretation>("Interpretation", interpretation, "values are labels, or grey values to be thresholded",
                                   {{"labels", Interpretation::labels}, {"threshold", Interpretation::threshold}});
      if (interpretation == Interpretation::threshold)
        {
          p.add("Lower threshold", lower_threshold, "grey value from which a voxel joins a structure", "", Range::any());
          p.add("Upper threshold", upper_threshold, "grey value that a structure must reach somewhere", "", Range::any());
          p.add_choice<Image::Connectivity>("Connectivity", connectivity, "voxels that touch by faces, or also by edges and corners",
                                            {{"faces", Image::Connectivity::faces}, {"full", Image::Connectivity::full}});
        }
      p.add("Materials", materials, "label: material (or 'empty') for each label; a threshold gives labels 0 and 1");
      where_file      = p.where("File");
      where_threshold = p.where("Upper threshold");
      where_materials = p.where("Materials");
      where_crop      = p.where("Crop size");
      where_merge     = p.where("Voxels per point");
      if (materials.empty() && p.get_mode() == Parameters::Mode::read)
        throw UserError(p.where_section(), "'Materials' is missing; give 'label: material' for each label of the image");
      if (!voxel_size.empty() && voxel_size.size() != 3)
        throw UserError(p.where("Voxel size"), "'Voxel size' takes three lengths, for x, y and z");
      if (!corner.empty() && corner.size() != 3)
        throw UserError(p.where("Corner"), "'Corner' takes three coordinates, x, y and z");
      if (crop_first.size() != crop_size.size() || (!crop_size.empty() && crop_size.size() != 3))
        throw UserError(where_crop, "'Crop first' and 'Crop size' each take three whole numbers, or both are left out");
      add_phantom(p);
    }

    void
    ImageSettings::add_phantom(Parameters &p)
    {
      const auto                section = p.section("Phantom", "the synthetic microvessels of 'File = phantom'");
      std::vector<unsigned int> size(phantom.size.begin(), phantom.size.end());
      std::vector<double>       voxel(phantom.voxel_size.begin(), phantom.voxel_size.end());
      p.add("Size", size, "number of voxels in x, y, z", Range::at_least(1), 3);
      p.add("Voxel size", voxel, "edges of a voxel", "m", Range::positive(), 3);
      p.add("Vessel fraction", phantom.vessel_fraction, "share of the voxels that are vessel", "", Range{0, .5, true, false});
      p.add("Radius", phantom.radius, "mean vessel radius", "m", Range::positive());
      p.add("Blur", phantom.blur, "standard deviation of the blur", "m", Range::non_negative());
      p.add("Noise", phantom.noise, "standard deviation of the noise over the contrast", "", Range::non_negative());
      p.add("Seed", phantom.seed, "the same seed gives the same phantom");
      std::copy(size.begin(), size.end(), phantom.size.begin());
      std::copy(voxel.begin(), voxel.end(), phantom.voxel_size.begin());
    }

    std::array<unsigned int, 3>
    triple(const std::vector<unsigned int> &v)
    {
      return {{v[0], v[1], v[2]}};
    }

    /// Grey values or labels, as stored.
    Image::Volume<std::uint16_t>
    load(const ImageSettings &settings)
    {
      if (settings.file == "phantom")
        {
          Memory::require_here(Image::memory_of_phantom(settings.phantom), "", "this phantom");
          const auto phantom = Image::make_phantom(settings.phantom);
          const auto &source =
            settings.interpretation == Interpretation::labels ? phantom.labels : phantom.image;
          Image::Volume<std::uint16_t> volume;
          volume.size       = source.size;
          volume.voxel_size = source.voxel_size;
          volume.origin     = source.origin;
          volume.data.assign(source.data.begin(), source.data.end());
          return volume;
        }
      std::string path = settings.file;
      if (!std::filesystem::exists(path) && std::filesystem::exists(settings.folder + "/" + path))
        path = settings.folder + "/" + path;
      std::optional<std::array<double, 3>> voxel_size;
      if (!settings.voxel_size.empty())
        voxel_size = {{settings.voxel_size[0], settings.voxel_size[1], settings.voxel_size[2]}};
      return Image::read(path, voxel_size, settings.spacing_unit);
    }

    /// Runs @p work; puts the place of the entry before the message of a UserError.
    template <typename Work>
    auto
    at(const std::string &where, const Work &work)
    {
      try
        {
          return work();
        }
      catch (const UserError &error)
        {
          throw UserError(where, error.what());
        }
      catch (const std::filesystem::filesystem_error &error)
        {
          throw UserError(where, shown(error.path1().string()) + ": " + error.code().message());
        }
    }

    Image::Volume<std::uint16_t>
    labelled(const ImageSettings &settings)
    {
      auto volume = at(settings.where_file, [&] { return load(settings); });
      if (!settings.crop_size.empty())
        volume = at(settings.where_crop, [&] {
          return Image::crop(volume, triple(settings.crop_first), triple(settings.crop_size));
        });
      if (settings.interpretation == Interpretation::threshold)
        {
          const auto segmented = at(settings.where_threshold, [&] {
            return Image::hysteresis_threshold(volume, settings.lower_threshold, settings.upper_threshold,
                                               settings.connectivity);
          });
          volume.data.assign(segmented.data.begin(), segmented.data.end());
        }
      return at(settings.where_merge, [&] { return Image::merge_labels(volume, triple(settings.merge)); });
    }

    /// label -> material index, from "0: collagen, 255: vessel".
    std::map<unsigned int, std::uint8_t>
    label_map(const ImageSettings &settings, const std::vector<std::string> &names)
    {
      std::map<unsigned int, std::uint8_t> map;
      for (const auto &text : settings.materials)
        {
          const auto  parts = split(text, ':');
          std::size_t used  = 0;
          int         label = -1;
          try
            {
              label = std::stoi(parts.at(0), &used);
            }
          catch (const std::exception &)
            {}
          const auto found = parts.size() == 2 ? std::find(names.begin(), names.end(), parts[1]) : names.end();
          const bool empty = parts.size() == 2 && parts[1] == "empty";
          if (label < 0 || used != parts[0].size() || (found == names.end() && !empty))
            throw UserError(settings.where_materials, "'Materials' has '" + text +
                                                        "'; each part must be 'label: material', with a material of: " +
                                                        join(names, ", ") + ", empty");
          map[label] = empty ? VoxelMaterials::empty : static_cast<std::uint8_t>(found - names.begin());
        }
      return map;
    }

    VoxelMaterials
    voxel_materials(const ImageSettings &settings, const std::vector<std::string> &names)
    {
      const auto     map    = label_map(settings, names);
      const auto     volume = labelled(settings);
      VoxelMaterials voxels;
      voxels.size       = volume.size;
      voxels.voxel_size = volume.voxel_size;
      for (unsigned int d = 0; d < 3; ++d)
        voxels.corner[d] = settings.corner.empty() ? 0. : settings.corner[d];
      std::vector<std::size_t> count(1 << 16, 0);
      for (const auto label : volume.data)
        ++count[label];
      std::vector<std::uint8_t> table(1 << 16, VoxelMaterials::empty);
      for (unsigned int label = 0; label < count.size(); ++label)
        if (map.count(label) > 0)
          table[label] = map.at(label);
        else if (count[label] > 0)
          throw UserError(settings.where_materials,
                          "the image has " + grouped(count[label]) + " voxels of label " + std::to_string(label) +
                            ", which 'Materials' does not name; add '" + std::to_string(label) +
                            ": material' or '" + std::to_string(label) + ": empty'" +
                            (settings.interpretation == Interpretation::labels ?
                               ", or set 'Interpretation = threshold' for grey values" : ""));
      for (const auto &[label, material] : map)
        if (label >= count.size() || count[label] == 0)
          throw UserError(settings.interpretation == Interpretation::threshold ? settings.where_threshold :
                                                                                 settings.where_materials,
                          "no voxel has label " + std::to_string(label) + ", so " +
                            (material == VoxelMaterials::empty ? "the empty space" : "material '" + names[material] + "'") +
                            " would not exist; change " +
                            (settings.interpretation == Interpretation::threshold ? "the thresholds" : "'Materials'"));
      voxels.material.resize(volume.data.size());
      std::transform(volume.data.begin(), volume.data.end(), voxels.material.begin(),
                     [&](const std::uint16_t label) { return table[label]; });
      return voxels;
    }

    void
    broadcast(VoxelMaterials &voxels, const MPI_Comm comm)
    {
      std::array<double, 9> shape;
      for (unsigned int d = 0; d < 3; ++d)
        {
          shape[d]     = voxels.size[d];
          shape[3 + d] = voxels.voxel_size[d];
          shape[6 + d] = voxels.corner[d];
        }
      MPI_Bcast(shape.data(), 9, MPI_DOUBLE, 0, comm);
      for (unsigned int d = 0; d < 3; ++d)
        {
          voxels.size[d]       = static_cast<unsigned int>(shape[d]);
          voxels.voxel_size[d] = shape[3 + d];
          voxels.corner[d]     = shape[6 + d];
        }
      const std::size_t layer = std::size_t(voxels.size[0]) * voxels.size[1];
      voxels.material.resize(layer * voxels.size[2]);
      for (unsigned int z = 0; z < voxels.size[2]; ++z)
        MPI_Bcast(voxels.material.data() + z * layer, static_cast<int>(layer), MPI_BYTE, 0, comm);
    }
  } // namespace

  namespace
  {
    /// Twice the area of the triangle a, b, c; positive if they go round anticlockwise.
    template <int dim>
    double
    turn(const dealii::Point<dim> &a, const dealii::Point<dim> &b, const dealii::Point<dim> &c)
    {
      return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    }
  } // namespace

  template <int dim>
  void
  Body<dim>::add(Parameters &p, const std::string &body_name, const std::vector<std::string> &materials,
                 const MPI_Comm comm)
  {
    name  = body_name;
    where = p.where_section();
    p.add_choice<Shape>("Shape", shape, "a volume image, or a drawn shape",
                        {{"image", Shape::image},
                         {"box", Shape::box},
                         {"ball", Shape::ball},
                         {"ring", Shape::ring},
                         {"quadrilateral", Shape::quadrilateral}});
    if (shape == Shape::image)
      {
        ImageSettings settings;
        const std::string where_file = p.where("File");
        settings.folder = where_file.substr(0, std::max<std::size_t>(1, where_file.find_last_of('/') + 1));
        if (where_file.find('/') == std::string::npos)
          settings.folder = ".";
        settings.add(p);
        image_source = settings.file;
        if (p.get_mode() == Parameters::Mode::document)
          {
            voxels.size = {{1, 1, 1}};
            return;
          }
        on_root(comm, [&] { voxels = voxel_materials(settings, materials); });
        broadcast(voxels, comm);
        if (dim == 2 && voxels.size[2] != 1)
          throw UserError(settings.where_file, "a 2D scene needs one slice, but the image has " +
                                                 std::to_string(voxels.size[2]) +
                                                 "; choose one with 'Crop first' and 'Crop size' (size 1 in z)");
        return;
      }
    add_drawn(p);
    bool is_rigid = false;
    p.add("Rigid", is_rigid, "a rigid body, that moves without turning, instead of a piece of material");
    rigid = is_rigid;
    if (rigid && shape != Shape::box && shape != Shape::ball)
      throw UserError(p.where("Rigid"), "a rigid body must be a box or a ball");
    if (rigid)
      return;
    std::vector<std::pair<std::string, unsigned int>> choices;
    for (unsigned int m = 0; m < materials.size(); ++m)
      choices.emplace_back(materials[m], m);
    p.add_choice<unsigned int>("Material", material, "what it is made of", choices);
    if (p.given("Initial velocity") || p.get_mode() == Parameters::Mode::document)
      initial_velocity.add(p, "Initial velocity", "velocity at the start, for motion with inertia", "m/s", false);
  }

  template <int dim>
  void
  Body<dim>::add_drawn(Parameters &p)
  {
    if (dim == 3 && (shape == Shape::ring || shape == Shape::quadrilateral))
      throw UserError(p.where("Shape"), "a ring or a quadrilateral is for two dimensions; use a box or a ball");
    const auto point = [&](const std::string &entry, const std::string &meaning, const double start) {
      std::vector<double> values(dim, start);
      p.add(entry, values, meaning, "m", Range::any(), dim);
      dealii::Point<dim> read;
      for (unsigned int d = 0; d < dim; ++d)
        read[d] = values[d];
      return read;
    };
    switch (shape)
      {
        case Shape::box:
          first  = point("Lower corner", "corner with the smallest coordinates", 0.);
          second = point("Upper corner", "corner with the largest coordinates", 1.);
          for (unsigned int d = 0; d < dim; ++d)
            if (first[d] >= second[d])
              throw UserError(p.where("Upper corner"), "'Upper corner' must lie above 'Lower corner' in every direction");
          break;
        case Shape::ball:
          first  = point("Centre", "centre", 0.);
          radius = std::nan("");
          p.add("Radius", radius, "radius", "m", Range::positive());
          break;
        case Shape::ring:
          {
            first  = point("Centre", "centre", 0.);
            radius = inner_radius = std::nan("");
            p.add("Inner radius", inner_radius, "inner radius", "m", Range::positive());
            p.add("Outer radius", radius, "outer radius", "m", Range::positive());
            std::vector<double> given{0., 90.};
            p.add("Angles", given, "from, to, anticlockwise from the x axis, in degrees", "", Range::closed(-360, 360), 2);
            angles = {{given[0], given[1]}};
            if (!(inner_radius < radius))
              throw UserError(p.where("Outer radius"), "'Outer radius' must be larger than 'Inner radius'");
            if (!(angles[0] < angles[1] && angles[1] - angles[0] < 360))
              throw UserError(p.where("Angles"), "'Angles' must increase, by less than 360 degrees");
            break;
          }
        case Shape::quadrilateral:
          {
            std::vector<double> given(8, std::nan(""));
            p.add("Corners", given, "x, y of the four corners, anticlockwise", "m", Range::any(), 8);
            for (unsigned int v = 0; v < 4; ++v)
              for (unsigned int d = 0; d < 2; ++d)
                corners[v][d] = given[2 * v + d];
            for (unsigned int v = 0; v < 4 && p.get_mode() == Parameters::Mode::read; ++v)
              if (!(turn(corners[v], corners[(v + 1) % 4], corners[(v + 2) % 4]) > 0))
                throw UserError(p.where("Corners"), "'Corners' must go round anticlockwise and be convex");
            break;
          }
        case Shape::image:
          break;
      }
  }

  template <int dim>
  dealii::BoundingBox<dim>
  Body<dim>::bounding_box() const
  {
    dealii::Point<dim> lower = first, upper = second;
    for (unsigned int d = 0; d < dim; ++d)
      switch (shape)
        {
          case Shape::image:
            lower[d] = voxels.corner[d];
            upper[d] = voxels.corner[d] + voxels.size[d] * voxels.voxel_size[d];
            break;
          case Shape::ball:
            lower[d] = first[d] - radius;
            upper[d] = first[d] + radius;
            break;
          case Shape::ring:
            {
              lower[d] = std::numeric_limits<double>::max();
              upper[d] = std::numeric_limits<double>::lowest();
              const auto include = [&](const double angle) {
                for (const double r : {inner_radius, radius})
                  {
                    // The exact value on the axes, so that sides there are found.
                    const double quarter = angle / 90. - d;
                    const double part = std::fmod(quarter, 1.) == 0. ? std::vector<double>{1, 0, -1, 0}[(int(quarter) % 4 + 4) % 4] :
                                                                       std::cos(quarter * dealii::numbers::PI_2);
                    lower[d] = std::min(lower[d], first[d] + r * part);
                    upper[d] = std::max(upper[d], first[d] + r * part);
                  }
              };
              include(angles[0]);
              include(angles[1]);
              for (int quarter = -4; quarter <= 4; ++quarter)
                if (angles[0] <= 90. * quarter && 90. * quarter <= angles[1])
                  include(90. * quarter);
              break;
            }
          case Shape::quadrilateral:
            lower[d] = std::min({corners[0][d], corners[1][d], corners[2][d], corners[3][d]});
            upper[d] = std::max({corners[0][d], corners[1][d], corners[2][d], corners[3][d]});
            break;
          case Shape::box:
            break;
        }
    return dealii::BoundingBox<dim>({lower, upper});
  }

  template <int dim>
  std::optional<unsigned int>
  Body<dim>::voxel_material(const dealii::Point<dim> &X) const
  {
    std::array<unsigned int, 3> index{{0, 0, 0}};
    for (unsigned int d = 0; d < dim; ++d)
      index[d] = std::min(voxels.size[d] - 1,
                          static_cast<unsigned int>(std::max(0., (X[d] - voxels.corner[d]) / voxels.voxel_size[d])));
    const auto found = voxels.at(index[0], index[1], index[2]);
    return found == VoxelMaterials::empty ? std::nullopt : std::optional<unsigned int>(found);
  }

  template <int dim>
  bool
  Body<dim>::contains(const dealii::Point<dim> &X) const
  {
    const double r = X.distance(first);
    switch (shape)
      {
        case Shape::image:
          return bounding_box().point_inside(X) && voxel_material(X);
        case Shape::box:
          return bounding_box().point_inside(X);
        case Shape::ball:
          return r <= radius;
        case Shape::ring:
          {
            double angle = std::atan2(X[1] - first[1], X[0] - first[0]) * 180. / dealii::numbers::PI;
            while (angle < angles[0])
              angle += 360.;
            return inner_radius <= r && r <= radius && angle <= angles[1];
          }
        case Shape::quadrilateral:
          {
            bool inside = true;
            for (unsigned int v = 0; v < 4; ++v)
              inside &= turn(corners[v], corners[(v + 1) % 4], X) >= 0;
            return inside;
          }
      }
    return false;
  }

  template <int dim>
  std::optional<unsigned int>
  Body<dim>::material_at(const dealii::Point<dim> &X) const
  {
    if (rigid || !contains(X))
      return std::nullopt;
    return shape == Shape::image ? voxel_material(X) : std::optional<unsigned int>(material);
  }

  template class Body<2>;
  template class Body<3>;
} // namespace Stroma
