#include <stroma/base/errors.h>
#include <stroma/output/collective.h>
#include <stroma/output/folder.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <vector>

namespace Stroma::Output
{
  namespace
  {
    namespace fs = std::filesystem;

    const std::regex checkpoint_name("checkpoint_[0-9]+\\.h5");

    /// Names of the plain files in a folder; none if it does not exist.
    std::vector<std::string>
    files_in(const std::string &folder)
    {
      std::vector<std::string> names;
      std::error_code          code;
      for (const fs::directory_entry &entry : fs::directory_iterator(folder, code))
        if (entry.is_regular_file(code))
          names.push_back(entry.path().filename().string());
      return names;
    }

    bool
    holds_results(const std::string &folder)
    {
      for (const std::string &name : files_in(folder))
        if (name == "summary.json" || name == "series.csv" || std::regex_match(name, checkpoint_name))
          return true;
      return false;
    }

    void
    remove_own_files(const std::string &folder)
    {
      for (const std::string &name : files_in(folder))
        if (RunFolder::is_ours(name))
          fs::remove(folder + "/" + name);
      for (const std::string &name : files_in(folder + "/states"))
        if (fs::path(name).extension() == ".h5")
          fs::remove(folder + "/states/" + name);
    }

    void
    create(const std::string &folder)
    {
      std::error_code code;
      fs::create_directories(folder, code);
      if (!fs::is_directory(folder))
        throw UserError(folder, "the output folder cannot be made ("
                                    + (code ? code.message() : "a file of this name exists")
                                    + "); choose another --output");
    }

    void
    check_writable(const std::string &folder)
    {
      const std::string probe = folder + "/.stroma_probe";
      const bool        good  = static_cast<bool>(std::ofstream(probe) << "probe" << std::flush);
      std::error_code   ignored;
      fs::remove(probe, ignored);
      if (!good)
        throw UserError(folder, "the output folder is not writable (or its disk is full); choose another --output");
    }

    std::string
    default_name(const FolderRequest &request, const unsigned int n)
    {
      return "results/" + fs::path(request.parameter_file).stem().string() + (n == 1 ? "" : "-" + std::to_string(n));
    }

    std::string
    newest_default(const FolderRequest &request)
    {
      std::string newest;
      for (unsigned int n = 1; fs::is_directory(default_name(request, n)); ++n)
        newest = default_name(request, n);
      if (newest.empty())
        throw UserError("--resume", "there is no folder " + default_name(request, 1)
                                        + " to continue; give --output or run without --resume");
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
        if (code && !fs::exists(name))
          throw UserError(name, "the output folder cannot be made (" + code.message() + "); choose another --output");
      }
    }

    std::string
    given_folder(const FolderRequest &request)
    {
      const std::string &name = request.output;
      if (request.resume && !fs::is_directory(name))
        throw UserError("--output " + name, "there is no such folder to resume; run without --resume");
      if (!request.resume && !request.overwrite && holds_results(name))
        throw UserError("--output " + name, "the folder holds results; choose another folder, or --resume to continue, "
                                            "or --overwrite to replace");
      return name;
    }

    std::string
    choose(const FolderRequest &request)
    {
      if (request.resume && request.overwrite)
        throw UserError("--resume", "cannot be combined with --overwrite; give one of them");
      if (!request.output.empty())
        return given_folder(request);
      if (request.resume)
        return newest_default(request);
      return request.overwrite ? default_name(request, 1) : unused_default(request);
    }
  } // namespace

  RunFolder::RunFolder(const FolderRequest &request, const MPI_Comm comm)
  {
    on_root(comm,
                 [&]
                 {
                   folder = choose(request);
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
    static const std::regex ours("(summary\\.json|series\\.csv|parameters\\.prm"
                                 "|checkpoint_[0-9]+\\.h5"
                                 "|(points|grid|bodies)_[0-9]{4,}(\\.[0-9]+)*\\.(vtu|pvtu|h5|xdmf)"
                                 "|(points|grid|bodies)\\.(pvd|xdmf))(\\.tmp)?");
    return std::regex_match(name, ours);
  }
} // namespace Stroma::Output
