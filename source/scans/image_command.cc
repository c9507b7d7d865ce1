#include <stroma/base/constants_in_use.h>
#include <stroma/base/log.h>
#include <stroma/base/on_root.h>
#include <stroma/base/unknown_entries.h>
#include <stroma/image/write.h>
#include <stroma/output/text_file.h>
#include <stroma/scans/image_command.h>
#include <stroma/scans/planes.h>
#include <stroma/scans/report.h>
#include <stroma/scene/image_settings.h>
#include <stroma/simulation/problem.h>
#include <stroma/simulation/simulation.h>

#include <filesystem>

namespace Stroma::Scans
{
  namespace
  {
    namespace fs = std::filesystem;

    std::string
    folder_of(const ImageRequest &request)
    {
      return request.output.empty() ? "results/" + fs::path(request.file).stem().string() + "_image" : request.output;
    }

    void
    check_folder(const std::string &folder, const bool overwrite)
    {
      std::error_code code;
      if (!overwrite && fs::exists(folder + "/image.json", code))
        throw UserError(folder,
                        "the folder holds an earlier report of an image; choose another --output, or --overwrite it");
    }

    /// Advice of the reader in the words of this command.
    Image::ReadVolume<float>
    read_alone(const ImageRequest &request)
    {
      try
        {
          return Image::read<float>(request.file, request.reading);
        }
      catch (const UserError &error)
        {
          const std::string text    = error.what();
          const bool        is_size = text.find("\"Voxel size\"") != std::string::npos;
          const bool        is_unit = text.find("'Spacing unit'") != std::string::npos;
          throw UserError(text + (is_size ? " (here: --voxel X,Y,Z in um)" : is_unit ? " (here: --unit)" : ""));
        }
    }

    /// The body of the scene that is an image: @p wanted, or the only one.
    std::string
    image_body(const ParameterFile &scene, const std::string &wanted)
    {
      std::vector<std::string> found;
      for (const auto &name : scene.subsections({"Bodies"}))
        if (const auto *shape = scene.find({"Bodies", name}, "Shape"); shape && shape->value == "image")
          found.push_back(name);
      if (wanted.empty() && found.size() == 1)
        return found.front();
      for (const auto &name : found)
        if (name == wanted)
          return name;
      throw UserError(wanted.empty() ? "--segment " + scene.path() : "--body " + wanted,
                      found.empty() ? "the scene has no body with 'Shape = image'" :
                                      "choose by --body which image of the scene is meant: " + join(found, ", "));
    }

    ParameterFile
    read_scene(const ImageRequest &request, std::string &body, const MPI_Comm comm)
    {
      auto scene = with_assignments(ParameterFile::read(request.scene), request.set).without("Study").without("Fit");
      body = unknown_first([&] { return image_body(scene, request.body); }, [&] { parameter_template(scene, comm); });
      scene.set("Bodies/" + body + "/File=" + ParameterFile::written(request.file));
      return scene;
    }

    Report
    report_on(const Image::ReadVolume<float> &image)
    {
      Report report;
      report.type       = image.type;
      report.size       = image.size;
      report.voxel_size = image.voxel_size;
      report.remarks    = image.remarks;
      report.statistics = statistics_of(image.data);
      return report;
    }

    /// The entries of the body that say how its image becomes material, read again.
    ImageSettings
    settings_of(const ParameterFile &file, const std::string &body, const bool plane)
    {
      Parameters    parameters(file);
      const auto    bodies  = parameters.section("Bodies");
      const auto    section = parameters.section(body);
      ImageSettings settings;
      settings.add(parameters);
      settings.reading.plane = plane;
      return settings;
    }

    template <int dim>
    Report
    segmented(const ImageRequest &request, const ParameterFile &file, const std::string &name, const MPI_Comm comm)
    {
      Timers             timers;
      const Problem<dim> problem(file, Parameters::Mode::read, comm, timers);
      const auto         settings = settings_of(file, name, dim == 2);
      Report             report;
      on_root(comm, [&] {
        for (unsigned int b = 0; b < problem.scene->bodies.size(); ++b)
          if (problem.scene->bodies[b].name == name)
            {
              auto image          = Image::read<float>(request.file, settings.reading);
              report              = report_on(image);
              report.segmentation = segmentation_of(*problem.scene, b, settings, request.labels, std::move(image));
            }
      });
      return report;
    }

    Report
    alone(const ImageRequest &request, Image::Volume<float> &grey)
    {
      auto         image  = read_alone(request);
      const Report report = report_on(image);
      grey                = std::move(image);
      return report;
    }

    /// Throws UserError if the segmentation cannot go there, or is there what is read.
    void
    check_written(const ImageRequest &request, const std::string &written)
    {
      std::error_code code;
      if (!request.written.empty() || fs::is_directory(fs::path(written).parent_path(), code))
        Image::check_target(written, request.overwrite);
      for (const auto &read : {request.file, request.labels.file})
        if (fs::equivalent(read, written, code))
          throw UserError(
            written, "the segmentation would be written over an image that is read; give another --write or --output");
    }

    /// What an earlier report has left and this one does not write.
    void
    remove_earlier(const std::string &folder, const std::string &kept)
    {
      std::error_code code;
      for (const auto &name : {"histogram.csv", "pieces.csv", "image.json", "segmentation.nrrd", "planes.png",
                               "histogram.png", "plane_xy_scan.pgm", "plane_xz_scan.pgm", "plane_yz_scan.pgm",
                               "plane_xy_materials.pgm", "plane_xz_materials.pgm", "plane_yz_materials.pgm"})
        if (const fs::path path = fs::path(folder) / name; !fs::equivalent(path, kept, code))
          fs::remove(path, code);
    }

    void
    write(const Report &report, const Image::Volume<float> &grey, const std::string &folder, const bool overwrite)
    {
      const auto &of  = report.statistics.percentiles;
      const auto &all = report.segmentation ? report.segmentation->grey : grey;
      write_planes(folder, "scan", all, of.front().second, of.back().second);
      Output::write_atomically(folder + "/histogram.csv", histogram_table(report.statistics.histogram));
      if (report.segmentation)
        {
          write_planes(folder, "materials", report.segmentation->labels, 0, 255);
          Output::write_atomically(folder + "/pieces.csv", pieces_table(*report.segmentation));
          Image::write(report.written, report.segmentation->labels, overwrite, report.segmentation->space);
        }
      Output::write_atomically(folder + "/image.json", json_of(report));
    }
  } // namespace

  std::string
  describe_image(const ImageRequest &request, const MPI_Comm comm)
  {
    const std::string    folder  = folder_of(request);
    const std::string    written = request.written.empty() ? folder + "/segmentation.nrrd" : request.written;
    Report               report;
    Image::Volume<float> grey;
    on_root(comm, [&] {
      check_folder(folder, request.overwrite);
      if (!request.scene.empty()) // before the work
        check_written(request, written);
    });
    if (request.scene.empty())
      on_root(comm, [&] { report = alone(request, grey); });
    else
      {
        std::string         body;
        const ParameterFile scene = read_scene(request, body, comm);
        report                    = dimension_of(scene) == 2 ? segmented<2>(request, scene, body, comm) :
                                                               segmented<3>(request, scene, body, comm);
        report.scene              = request.scene;
        report.written            = written;
      }
    report.file = request.file;
    on_root(comm, [&] {
      std::error_code code;
      fs::create_directories(folder, code);
      if (!fs::is_directory(folder, code))
        throw UserError("--output " + folder, "the folder cannot be made; choose another");
      remove_earlier(folder, request.file);
      write(report, grey, folder, request.overwrite);
      Log::line(text_of(report));
    });
    return folder;
  }
} // namespace Stroma::Scans
