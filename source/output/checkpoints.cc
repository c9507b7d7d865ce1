#include <stroma/base/log.h>
#include <stroma/output/archive.h>
#include <stroma/output/checkpoints.h>
#include <stroma/output/collective.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <vector>

namespace Stroma::Output
{
  namespace
  {
    namespace fs = std::filesystem;

    /// Steps of the checkpoints in a folder, newest first.
    std::vector<unsigned long>
    steps_in(const std::string &folder)
    {
      const std::regex           name("checkpoint_([0-9]{1,9})\\.h5");
      std::vector<unsigned long> steps;
      std::error_code            code;
      for (const fs::directory_entry &entry : fs::directory_iterator(folder, code))
        {
          std::smatch       match;
          const std::string file = entry.path().filename().string();
          if (std::regex_match(file, match, name))
            steps.push_back(std::stoul(match[1]));
        }
      std::sort(steps.rbegin(), steps.rend());
      return steps;
    }

    /// What an interrupted run left behind.
    void
    remove_temporaries(const std::string &folder)
    {
      const std::regex name("checkpoint_[0-9]+\\.h5\\.tmp");
      std::error_code  ignored;
      for (const fs::directory_entry &entry : fs::directory_iterator(folder, ignored))
        if (std::regex_match(entry.path().filename().string(), name))
          fs::remove(entry.path(), ignored);
    }

    /// What is wrong with a checkpoint, or "". Collective.
    std::string
    damage_of(const std::string &path, const MPI_Comm comm)
    {
      try
        {
          const std::string damaged = ArchiveReader(path, comm).damage();
          return damaged.empty() ? "" : path + ": '" + damaged + "' is damaged";
        }
      catch (const UserError &error)
        {
          return error.what();
        }
    }
  } // namespace

  Checkpoints::Checkpoints(const std::string &folder, const MPI_Comm comm)
    : folder(folder)
    , comm(comm)
  {}

  std::string
  Checkpoints::path(const unsigned int step) const
  {
    return folder + "/checkpoint_" + std::to_string(step) + ".h5";
  }

  void
  Checkpoints::remove_old() const
  {
    on_root(comm, [&] {
      const auto      steps = steps_in(folder);
      std::error_code ignored;
      for (std::size_t i = n_kept; i < steps.size(); ++i)
        fs::remove(path(steps[i]), ignored);
      remove_temporaries(folder);
    });
  }

  std::string
  Checkpoints::latest() const
  {
    // Rank 0's directory listing counts: that of another machine may lag behind.
    for (const unsigned long step : dealii::Utilities::MPI::broadcast(comm, steps_in(folder)))
      {
        const std::string damage = damage_of(path(step), comm);
        if (damage.empty())
          return path(step);
        Log::warning(damage + "; an older checkpoint is looked for");
      }
    return "";
  }
} // namespace Stroma::Output
