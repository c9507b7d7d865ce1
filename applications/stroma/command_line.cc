// The commands of `stroma`: run | check | template | compare | study | fit | image | phantom.

#include <stroma/base/characters.h>
#include <stroma/base/constants_in_use.h>
#include <stroma/base/errors.h>
#include <stroma/base/log.h>
#include <stroma/base/memory.h>
#include <stroma/base/output_error.h>
#include <stroma/base/signals.h>
#include <stroma/base/text.h>
#include <stroma/image/phantom.h>
#include <stroma/image/write.h>
#include <stroma/scans/image_command.h>
#include <stroma/simulation/simulation.h>
#include <stroma/studies/fit.h>
#include <stroma/studies/picture.h>
#include <stroma/studies/reference_file.h>
#include <stroma/studies/report.h>
#include <stroma/studies/sweep.h>

#include <deal.II/base/mpi.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <functional>
#include <iostream>
#include <optional>
#include <sstream>

#include "command_line.h"
#include "wrong_words.h"

namespace
{
  using namespace Stroma;

  constexpr int user_error = 1, run_failed = 2;

  /// What `run`, `check` and `template` share.
  struct SceneOptions
  {
    std::string              file;
    std::vector<std::string> set;

    void
    add(CLI::App &app, const bool file_required)
    {
      auto *option = app.add_option("FILE", file, "parameter file (.prm)");
      if (file_required)
        option->required();
      app.add_option("--set", set, "override an entry: Section/name=value (may be repeated)")
        ->type_size(1)
        ->allow_extra_args(false);
    }

    ParameterFile
    read() const
    {
      return with_assignments(file.empty() ? ParameterFile::parse("", "template") : ParameterFile::read(file), set);
    }
  };

  int
  exit_code(const RunStatus status)
  {
    return status == RunStatus::finished ? 0 : status == RunStatus::stopped ? stopped_by_signal : run_failed;
  }

  /// An unset variable in a script must not mean the default.
  std::string
  is_a_name(const std::string &folder)
  {
    return folder.empty() ? "the name of a folder is empty" : "";
  }

  /// The scene of a study or fit can be run by itself.
  ParameterFile
  scene_alone(const ParameterFile &whole)
  {
    return whole.without("Study").without("Fit");
  }

  /// `run` and `check`
  struct RunCommand
  {
    SceneOptions scene;
    RunOptions   options;

    explicit RunCommand(const bool only_check)
    {
      options.check = only_check;
    }

    void
    add(CLI::App &app)
    {
      scene.add(app, true);
      if (options.check)
        return;
      app.add_option("--output", options.output, "folder for the results (default: results/<name of FILE>)")
        ->check(is_a_name);
      app.add_flag("--resume", options.resume, "continue from the newest checkpoint in the folder");
      app.add_flag("--overwrite", options.overwrite, "replace earlier results in the folder");
    }

    int
    run()
    {
      const auto whole    = scene.read();
      const auto file     = scene_alone(whole);
      const bool is_study = options.check && !whole.where({"Study"}).empty();
      const auto n_runs   = is_study ? Studies::check_study(whole.without("Fit"), MPI_COMM_WORLD) : 0;
      if (options.check && !whole.where({"Fit"}).empty())
        Studies::check_fit(whole.without("Study"), MPI_COMM_WORLD);
      const auto result = run_simulation(file, options, MPI_COMM_WORLD);
      if (result.status == RunStatus::checked)
        {
          Log::line(scene.file + ": usable; " +
                    (result.summary.n_points > 0 ? counted(result.summary.n_points, "point") + ", " : "") +
                    counted(result.summary.n_cells, "cell") + ", " + counted(result.summary.n_dofs, "unknown") +
                    (is_study ? "; its study has " + counted(n_runs, "run") : ""));
          return 0;
        }
      std::ostringstream table;
      result.summary.print(table);
      Log::line(table.str());
      Log::line("Results in " + result.folder);
      if (result.status == RunStatus::failed)
        Log::warning(result.summary.status +
                     (result.is_saved ? "; the last good state is saved in " + result.folder : ""));
      return exit_code(result.status);
    }
  };

  /// The folder of a command that makes many runs, and what becomes of what is in it. @param what the command makes, in a word
  template <typename Options>
  void
  add_folder(CLI::App &app, Options &options, const std::string &what)
  {
    app.add_option("--output", options.output, "folder for the results (default: results/<name of FILE>)")
      ->check(is_a_name);
    app.add_flag("--resume", options.resume, "go on with an interrupted " + what + " in the folder");
    app.add_flag("--overwrite", options.overwrite, "replace earlier results in the folder");
  }

  /// `study`
  struct StudyCommand
  {
    SceneOptions          scene;
    Studies::StudyOptions options;

    void
    add(CLI::App &app)
    {
      scene.add(app, true);
      add_folder(app, options, "study");
      app.add_option("--at-once", options.at_once, "runs at the same time, each on its share of the ranks")
        ->capture_default_str();
    }

    int
    run()
    {
      return exit_code(Studies::run_study(scene.read().without("Fit"), options, MPI_COMM_WORLD));
    }
  };

  /// `fit`
  struct FitCommand
  {
    SceneOptions        scene;
    Studies::FitOptions options;

    void
    add(CLI::App &app)
    {
      scene.add(app, true);
      add_folder(app, options, "fit");
      app.add_option("--at-once", options.at_once,
                     "runs at the same time, each on its share of the ranks (default: as many as there are ranks)");
    }

    int
    run()
    {
      return exit_code(Studies::run_fit(scene.read(), options, MPI_COMM_WORLD));
    }
  };

  /// `template`
  struct TemplateCommand
  {
    SceneOptions scene;

    void
    add(CLI::App &app)
    {
      scene.add(app, false);
    }

    int
    run()
    {
      Log::line(parameter_template(scene_alone(scene.read()), MPI_COMM_WORLD));
      return 0;
    }
  };

  /// `compare`
  struct CompareCommand
  {
    std::string             a, b, output, save;
    Studies::CompareOptions options;

    void
    add(CLI::App &app)
    {
      using Points = Studies::CompareOptions::Points;
      app.add_option("A", a, "folder of a run that kept its states ('Output/Keep states = true')")->required();
      app
        .add_option("B", b,
                    "folder of such a run, a reference stored by --save, or the word exact (section 'Exact solution')")
        ->required();
      app.add_option("--output", output, "folder for tables and picture (default: A/compare)")->check(is_a_name);
      app.add_option("--fields", options.fields, "fields to compare (default: all that both have)")->delimiter(',');
      app.add_option("--times", options.times, "times [s] (default: all that both have)")->delimiter(',');
      app.add_option("--points", options.points, "A: A's own points; grid: a lattice over the bodies (default: A)")
        ->transform(CLI::CheckedTransformer(std::map<std::string, Points>{{"A", Points::run}, {"grid", Points::grid}}));
      app.add_option("--grid", options.grid, "cells of the lattice along each axis")->delimiter(',');
      const auto texts = [&](const std::string &name, std::vector<std::string> &list, const std::string &meaning) {
        app.add_option(name, list, meaning)->type_size(1)->allow_extra_args(false);
      };
      texts("--region", options.regions, "norms in a region too, as in 'Where', in m (may be repeated)");
      texts("--line", options.lines, "profiles along \"x, y : x, y\" [m] (may be repeated)");
      app.add_option("--samples", options.n_samples, "places along a line")->capture_default_str();
      app.add_option("--save", save, "store B's values at the places of this comparison in this file, for later ones");
    }

    int
    run()
    {
      options.keep_b = !save.empty();
      if (options.keep_b)
        Studies::check_reference_target(save, MPI_COMM_WORLD);
      Studies::RunSource a_source(a, MPI_COMM_WORLD);
      const auto         b_source   = Studies::open_source(b, a_source, MPI_COMM_WORLD);
      const auto         comparison = Studies::compare(a_source, *b_source, options);
      const std::string  folder     = output.empty() ? a + "/compare" : output;
      Studies::write_report(comparison, folder, MPI_COMM_WORLD);
      if (!save.empty())
        Studies::write_reference(save, comparison, MPI_COMM_WORLD);
      Studies::draw_picture("plot_compare.py", folder, MPI_COMM_WORLD);
      Log::line(Studies::table_of(comparison));
      Log::line("Results in " + folder);
      return 0;
    }
  };

  /// `image`
  struct ImageCommand
  {
    Scans::ImageRequest   request;
    std::array<double, 3> voxel = {{0, 0, 0}}; ///< [um]
    double                unit  = 0;

    void
    add(CLI::App &app)
    {
      app.add_option("FILE", request.file, "image (TIFF, NRRD, NIfTI or MetaImage)")->required();
      app.add_option("--output", request.output, "folder for the results (default: results/<name of FILE>_image)")
        ->check(is_a_name);
      app.add_flag("--overwrite", request.overwrite, "replace earlier results in the folder");
      auto *segment = app.add_option("--segment", request.scene, "segment it as the image of this parameter file");
      add_reading(app, segment);
      app.add_option("--set", request.set, "override an entry of that file: Section/name=value (may be repeated)")
        ->type_size(1)
        ->allow_extra_args(false)
        ->needs(segment);
      app.add_option("--body", request.body, "the body of that file that is meant, if several are images")
        ->needs(segment);
      app
        .add_option("--write", request.written,
                    "file for the segmentation: .nrrd, .mha or .tif (default: in the folder)")
        ->needs(segment);
      auto *labels = app.add_option("--labels", request.labels.file, "compare with this label image: Dice and Jaccard")
                       ->needs(segment);
      app
        .add_option("--label-materials", request.labels.materials,
                    "its labels, as in 'Materials' (default: as in the file)")
        ->needs(labels);
    }

    /// A scene says these itself.
    void
    add_reading(CLI::App &app, CLI::Option *segment)
    {
      app.add_option("--voxel", voxel, "voxel edges X,Y,Z [um], as a TIFF needs")
        ->check(CLI::PositiveNumber)
        ->delimiter(',')
        ->excludes(segment);
      app.add_option("--unit", unit, "unit of the stored spacing: um, mm, nm or m")
        ->transform(
          CLI::CheckedTransformer(std::map<std::string, double>{{"um", 1e-6}, {"mm", 1e-3}, {"nm", 1e-9}, {"m", 1.}}))
        ->excludes(segment);
      app
        .add_flag("--stored-axes", request.reading.stored_axes,
                  "x, y, z are the axes as stored, whatever the header says")
        ->excludes(segment);
      app.add_option("--channel", request.reading.channel, "channel of several, counted from 1")->excludes(segment);
      app.add_option("--frame", request.reading.frame, "time frame of several, counted from 1")->excludes(segment);
    }

    int
    run()
    {
      if (voxel[0] != 0)
        request.reading.voxel_size = std::array<double, 3>{{1e-6 * voxel[0], 1e-6 * voxel[1], 1e-6 * voxel[2]}};
      if (unit > 0)
        request.reading.spacing_unit = unit;
      request.reading.plane    = true; // a slice needs no edge across
      const std::string folder = Scans::describe_image(request, MPI_COMM_WORLD);
      Studies::draw_picture("plot_image.py", folder, MPI_COMM_WORLD);
      Log::line("Results in " + folder);
      return 0;
    }
  };

  /// `phantom`
  struct PhantomCommand
  {
    std::string            path;
    bool                   overwrite = false;
    Image::PhantomSettings settings;
    double                 micrometre = 1e-6;

    void
    add(CLI::App &app)
    {
      settings.voxel_size = {{1., 1., 1.}};
      settings.radius     = 3.;
      settings.blur       = 1.;
      app.add_option("FILE", path, "image to write: .nrrd, .mha or .tif; the labels go to <name>_label beside it")
        ->required();
      app.add_option("--size", settings.size, "voxels in x, y, z")->delimiter(',')->capture_default_str();
      app.add_option("--voxel", settings.voxel_size, "voxel edges [um]")->delimiter(',')->capture_default_str();
      app.add_option("--fraction", settings.vessel_fraction, "share of voxels that are vessel, (0, 0.5]")
        ->capture_default_str();
      app.add_option("--radius", settings.radius, "mean vessel radius [um]")->capture_default_str();
      app.add_option("--blur", settings.blur, "standard deviation of the blur [um]")->capture_default_str();
      app.add_option("--noise", settings.noise, "standard deviation of the noise over the contrast")
        ->capture_default_str();
      app.add_option("--seed", settings.seed, "the same seed gives the same phantom")->capture_default_str();
      app.add_flag("--overwrite", overwrite, "replace existing files");
    }

    int
    run()
    {
      for (double &edge : settings.voxel_size)
        edge *= micrometre;
      settings.radius *= micrometre;
      settings.blur *= micrometre;
      const auto dot    = path.find_last_of('.');
      const auto labels = dot == std::string::npos ? path + "_label" :
                                                     path.substr(0, dot) + "_label" + path.substr(dot);
      if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
        {
          Memory::require_here(Image::memory_of_phantom(settings), "--size", "a phantom of this size");
          for (const auto &target : {path, labels}) // before the work
            Image::check_target(target, overwrite);
          const auto phantom = Image::make_phantom(settings);
          Image::write(path, phantom.image, overwrite);
          Image::write(labels, phantom.labels, overwrite);
        }
      Log::line("wrote " + path + " and " + labels);
      return 0;
    }
  };

  /// Says the error in one line of a length that people read: what it quotes may be megabytes.
  int
  end_with(const std::exception &error, const int code)
  {
    constexpr std::size_t longest = 4000;
    const std::string     text    = printable(with_short_words(error.what()));
    if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::cerr << "stroma: " << (text.size() <= longest ? text : text.substr(0, longest) + "...") << std::endl;
    return code;
  }

  /// Returns the exit code if there is nothing to run.
  std::optional<int>
  parse(CLI::App &app, int argc, char **argv)
  {
    try
      {
        app.parse(argc, argv);
        return std::nullopt;
      }
    catch (const CLI::ParseError &error)
      {
        const bool is_help = error.get_exit_code() == 0;
        if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
          {
            if (is_help)
              app.exit(error);
            else
              std::cerr << "stroma: " << wrong_words(app, error, {argv + 1, argv + argc}) << "; see stroma --help"
                        << std::endl;
          }
        return is_help ? 0 : user_error;
      }
  }

  int
  dispatch(int argc, char **argv)
  {
    CLI::App app(
      "Stroma: implicit mechanics of cells and tissue, from an image or a drawn scene to stresses and forces");
    app.require_subcommand(1);
    app.set_version_flag("--version", STROMA_VERSION);

    bool                                                     quiet = false;
    std::vector<std::pair<CLI::App *, std::function<int()>>> commands;

    const auto add = [&](auto &command, const std::string &name, const std::string &meaning, const bool may_be_quiet) {
      auto *subcommand = app.add_subcommand(name, meaning);
      command.add(*subcommand);
      if (may_be_quiet)
        subcommand->add_flag("--quiet", quiet, "print nothing but warnings and errors");
      commands.emplace_back(subcommand, [&command] { return command.run(); });
    };
    RunCommand      run(false), check(true);
    CompareCommand  compare;
    StudyCommand    study;
    FitCommand      fit;
    TemplateCommand documented;
    ImageCommand    image;
    PhantomCommand  phantom;
    add(run, "run", "solve a scene", true);
    add(check, "check", "read a scene and say whether it can be run, without running it", false);
    add(compare, "compare", "say how far run A is from B: a run, a stored reference or exact", true);
    add(study, "study", "solve a scene for all cases and values that its section Study lists; error against time",
        true);
    add(fit, "fit", "find constants that make a scene's results equal to measured ones, with confidence intervals",
        true);
    add(documented, "template", "print a documented parameter file (of FILE's scene, or a general one)", false);
    add(image, "image", "say what an image holds, suggest thresholds, and segment it by a scene", true);
    add(phantom, "phantom", "write a synthetic microvessel image with its true labels", false);

    if (const auto code = parse(app, argc, argv))
      return *code;
    Log::start(quiet);
    const auto given = std::find_if(commands.begin(), commands.end(),
                                    [](const auto &command) { return bool(*command.first); });
    return given->second();
  }
} // namespace

int
Stroma::run_command_line(int argc, char **argv)
{
  try
    {
      return dispatch(argc, argv);
    }
  catch (const UserError &error)
    {
      return end_with(error, user_error);
    }
  catch (const OutputError &error)
    {
      return end_with(error, run_failed);
    }
}
