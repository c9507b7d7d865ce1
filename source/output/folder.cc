#include <stroma/base/errors.h>
#include <stroma/output/collective.h>
#include <stroma/output/folder.h>

#include <deal.II/base/utilities.h>

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <vector>

namespace Stroma::Output
{
  namespace
  {
    namespace fs = std::filesystem;

    const std::regex checkpoint_name("checkpoint_[0-9]+\\.h5");
    const std::regex state_name_form("state_[0-9]{8}\\.h5(\\.tmp)?");

    /// Names of the plain files and links in a folder; none if it does not exist.
    std::vector<std::string>
    files_in(const std::string &folder)
    {
      std::vector<std::string> names;
      std::error_code          code;
      for (const fs::directory_entry &entry : fs::directory_iterator(folder, code))
        if (const auto type = entry.symlink_status(code).type();
            type == fs::file_type::regular || type == fs::file_type::symlink)
          names.push_back(entry.path().filename().string());
      return names;
    }

    bool
    is_link(const std::string &path)
    {
      std::error_code code;
      return fs::is_symlink(fs::symlink_status(path, code));
    }

    void
    remove_own_files(const std::string &folder)
    {
      const std::string states = folder + "/states";
      if (is_link(states))
        throw UserError(states, "this is a link, and files beyond it are not removed; remove the link");
      std::error_code ignored;
      for (const std::string &name : files_in(folder))
        if (RunFolder::is_ours(name))
          fs::remove(folder + "/" + name, ignored);
      for (const std::string &name : files_in(states))
        if (is_state(name))
          fs::remove(states + "/" + name, ignored);
      fs::remove(states, ignored); // if it is empty
    }

    void
    create(const std::string &folder)
    {
      std::error_code code, ignored;
      fs::create_directories(folder, code);
      if (!fs::is_directory(folder, ignored))
        throw UserError(folder, "the output folder cannot be made (" +
                                  (code ? code.message() : "a file of this name exists") +
                                  "); choose another --output");
    }

    /// By a file of a new name, so that nothing is written over.
    void
    check_writable(const std::string &folder)
    {
      std::string probe = folder + "/.stroma_probe_XXXXXX";
      const int   file  = mkstemp(probe.data());
      const bool  good  = file >= 0 && write(file, "probe", 5) == 5;
      if (file >= 0)
        {
          close(file);
          unlink(probe.c_str());
        }
      if (!good)
        throw UserError(folder, "the output folder is not writable (or its disk is full); choose another --output");
    }

    /// What can be known without making the folder.
    void
    check_possible(const std::string &folder)
    {
      std::error_code code;
      fs::path        there = fs::absolute(folder, code).lexically_normal();
      while (!there.empty() && fs::status(there, code).type() == fs::file_type::not_found && there.has_relative_path())
        there = there.parent_path();
      const auto type = fs::status(there, code).type();
      if (type == fs::file_type::none || type == fs::file_type::unknown)
        throw UserError(folder, "the output folder cannot be made (" + code.message() + "); choose another --output");
      if (type != fs::file_type::directory)
        throw UserError(folder,
                        "the output folder cannot be made (a file of this name exists); choose another --output");
      if (access(there.c_str(), W_OK | X_OK) != 0)
        throw UserError(folder, "the output folder is not writable (or its disk is full); choose another --output");
      if (fs::path(folder).filename() == "states" && holds_results(fs::path(folder).parent_path().string()))
        throw UserError("--output " + folder, "this is where a run keeps its states; choose another --output");
    }

    /// A run must not write over the file that it was read from.
    void
    check_not_input(const std::string &folder, const std::string &parameter_file)
    {
      std::error_code code;
      if (fs::equivalent(folder + "/parameters.prm", parameter_file, code))
        throw UserError("--output " + folder, "the run would write over its own input " + parameter_file +
                                                "; copy that file to another place or choose another --output");
    }

    std::string
    default_name(const FolderRequest &request, const unsigned int n)
    {
      return "results/" + fs::path(request.parameter_file).stem().string() + (n == 1 ? "" : "-" + std::to_string(n));
    }

    std::string
    newest_default(const FolderRequest &request)
    {
      std::string     newest;
      std::error_code code;
      for (unsigned int n = 1; fs::is_directory(default_name(request, n), code); ++n)
        newest = default_name(request, n);
      if (newest.empty())
        throw UserError("--resume", "there is no folder " + default_name(request, 1) +
                                      " to continue; give --output or run without --resume");
      return newest;
    }

    /// Makes the folder itself, so that two runs started together never take the same one.
    std::string
    unused_default(const FolderRequest &request)
    {
      create("results");
      for (unsigned int n = 1;; ++n)
        {
          const std::string name = default_name(request, n);
          std::error_code   code;
          if (fs::create_directory(name, code))
            return name;
          std::error_code ignored;
          if (code && !fs::exists(name, ignored))
            throw UserError(name, "the output folder cannot be made (" + code.message() + "); choose another --output");
        }
    }

    std::string
    given_folder(const FolderRequest &request)
    {
      const std::string &name = request.output;
      std::error_code    code;
      if (request.resume && !fs::is_directory(name, code))
        throw UserError("--output " + name, "there is no such folder to resume; run without --resume");
      if (!request.resume)
        check_not_input(name, request.parameter_file);
      if (!request.resume && !request.overwrite && holds_results(name))
        throw UserError("--output " + name, "the folder holds results; choose another folder, or --resume to continue, "
                                            "or --overwrite to replace");
      check_possible(name);
      return name;
    }

    /// The folder, or "" where the first unused one is to be taken.
    std::string
    choose(const FolderRequest &request)
    {
      if (request.resume && request.overwrite)
        throw UserError("--resume", "cannot be combined with --overwrite; give one of them");
      if (!request.output.empty())
        return given_folder(request);
      if (request.resume)
        return newest_default(request);
      check_possible(default_name(request, 1));
      if (!request.overwrite)
        return "";
      check_not_input(default_name(request, 1), request.parameter_file);
      return default_name(request, 1);
    }
  } // namespace

  RunFolder::RunFolder(const FolderRequest &request, const MPI_Comm comm)
    : request(request)
    , comm(comm)
  {
    on_root(comm, [&] { folder = choose(request); });
    folder = dealii::Utilities::MPI::broadcast(comm, folder, 0);
  }

  void
  RunFolder::open()
  {
    on_root(comm, [&] {
      if (folder.empty())
        folder = unused_default(request);
      create(folder);
      check_writable(folder);
      if (request.overwrite)
        remove_own_files(folder);
    });
    folder = dealii::Utilities::MPI::broadcast(comm, folder, 0);
  }

  bool
  RunFolder::is_ours(const std::string &name)
  {
    static const std::regex ours(
      "(summary\\.json|(series|histograms)\\.csv|parameters\\.prm|study_run\\.json|(study|fit)\\.(csv|txt|json)"
      "|checkpoint_[0-9]+\\.h5"
      "|(points|walls|grid)_[0-9]{4,}(\\.[0-9]+)*\\.(vtu|pvtu|h5|xdmf)"
      "|voxels(_[A-Za-z0-9_]+)?_[0-9]{4,}\\.(nrrd|tif|vti)"
      "|(points|walls|grid|voxels)\\.(pvd|xdmf))(\\.tmp)?");
    return std::regex_match(name, ours);
  }

  bool
  holds_results(const std::string &folder)
  {
    static const std::regex results("(summary|study|study_run|fit)\\.json|(series|study|fit)\\.csv|parameters\\.prm");
    for (const std::string &name : files_in(folder))
      if (std::regex_match(name, results) || std::regex_match(name, checkpoint_name))
        return true;
    return false;
  }

  void
  remove_run(const std::string &folder)
  {
    if (is_link(folder))
      throw UserError(folder, "this is a link, and files beyond it are not removed; remove the link");
    remove_own_files(folder);
    std::error_code ignored;
    fs::remove(folder, ignored); // if it is empty
  }

  void
  remove_later_steps(const std::string &folder, const unsigned int step, const MPI_Comm comm)
  {
    static const std::regex number("(checkpoint|state)_([0-9]{1,9})\\.h5");
    on_root(comm, [&] {
      std::error_code ignored;
      for (const std::string &place : {folder, folder + "/states"})
        if (place == folder || !is_link(place))
          for (const std::string &name : files_in(place))
            if (std::smatch match; std::regex_match(name, match, number) && std::stoul(match[2]) > step)
              fs::remove(place + "/" + name, ignored);
    });
  }

  std::vector<std::string>
  series_files(const std::string &folder, const MPI_Comm comm)
  {
    static const std::regex  series("(points|walls|grid|voxels)\\.(pvd|xdmf)");
    std::vector<std::string> files;
    if (dealii::Utilities::MPI::this_mpi_process(comm) == 0)
      for (const std::string &name : files_in(folder))
        if (std::regex_match(name, series))
          files.push_back(name);
    return dealii::Utilities::MPI::broadcast(comm, files, 0);
  }

  std::string
  path_inside(const std::string &folder, const std::string &name, const std::string &where)
  {
    constexpr std::size_t longest        = 200; // leaves room for endings
    const bool            has_bad_letter = std::any_of(name.begin(), name.end(), [](const unsigned char c) {
      return c < 0x20 || c == 0x7f || c == '/' || c == '\\';
    });
    if (name.empty() || name[0] == '.' || name.size() > longest || has_bad_letter)
      throw UserError(where, "'" + name.substr(0, 60) + (name.size() > 60 ? "..." : "") +
                               "' cannot be the name of a folder; give one of 1 to " + std::to_string(longest) +
                               " letters without slashes that does not begin with a full stop");
    return folder + "/" + name;
  }

  std::string
  state_name(const unsigned int step)
  {
    return "state_" + dealii::Utilities::int_to_string(step, 8) + ".h5";
  }

  bool
  is_state(const std::string &name)
  {
    return std::regex_match(name, state_name_form);
  }
} // namespace Stroma::Output
