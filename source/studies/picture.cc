#include <stroma/base/log.h>
#include <stroma/studies/picture.h>

#include <deal.II/base/mpi.h>

#include <cstdlib>
#include <filesystem>

namespace Stroma::Studies
{
  namespace
  {
    namespace fs = std::filesystem;

    /// The folder of the scripts: beside an installed program, or in the source tree.
    fs::path
    script_folder()
    {
      std::error_code code;
      const auto      installed = fs::read_symlink("/proc/self/exe", code).parent_path() / STROMA_INSTALLED_PLOT_DIR;
      return fs::is_directory(installed, code) ? installed.lexically_normal() : fs::path(STROMA_PLOT_DIR);
    }

    std::string
    quoted(const std::string &word)
    {
      std::string text = "'";
      for (const char c : word)
        text += c == '\'' ? std::string("'\\''") : std::string(1, c);
      return text + "'";
    }

    std::string
    command(const std::string &script, const std::string &folder)
    {
      std::error_code code;
      return (fs::exists("/usr/bin/python3", code) ? "/usr/bin/python3 " : "python3 ") +
             quoted((script_folder() / script).string()) + " " + quoted(folder);
    }
  } // namespace

  void
  draw_picture(const std::string &script, const std::string &folder, const MPI_Comm comm)
  {
    if (dealii::Utilities::MPI::this_mpi_process(comm) == 0)
      {
        const std::string line = command(script, folder);
        if (std::system((line + " > /dev/null 2>&1").c_str()) != 0)
          Log::line("No picture was drawn; it needs python3 with numpy and matplotlib, and " + line +
                    " says what is missing");
      }
    MPI_Barrier(comm);
  }
} // namespace Stroma::Studies
