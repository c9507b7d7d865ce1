#include <stroma/base/log.h>
#include <stroma/base/on_root.h>
#include <stroma/base/text.h>
#include <stroma/output/archive.h>
#include <stroma/output/folder.h>
#include <stroma/scene/image_report.h>
#include <stroma/simulation/exact_solution.h>
#include <stroma/simulation/problem.h>
#include <stroma/simulation/same_scene.h>
#include <stroma/simulation/saved_run.h>
#include <stroma/simulation/saved_state.h>

#include <algorithm>
#include <filesystem>

namespace Stroma
{
  namespace
  {
    constexpr const char *states_folder = "/states";

    /// Files of the states in a run's folder, in the order of steps, known to all ranks.
    std::vector<std::string>
    list_states(const std::string &folder, const MPI_Comm comm)
    {
      std::vector<std::string> files;
      on_root(comm, [&] {
        std::error_code code;
        if (!std::filesystem::is_directory(folder, code))
          throw UserError(shown(folder), "there is no such folder; give the output folder of a run");
        if (!std::filesystem::exists(folder + "/parameters.prm", code))
          throw UserError(folder, "this is not the output folder of a run (it has no parameters.prm)");
        if (std::filesystem::is_directory(folder + states_folder, code))
          for (const auto &entry : std::filesystem::directory_iterator(folder + states_folder, code))
            if (entry.path().extension() == ".h5" && Output::is_state(entry.path().filename()))
              files.push_back(entry.path().string());
        std::sort(files.begin(), files.end());
        if (files.empty())
          throw UserError(folder, "the run kept no states; run it again with 'Output/Keep states = true'");
      });
      return dealii::Utilities::MPI::broadcast(comm, files, 0);
    }
  } // namespace

  std::string
  state_path(const std::string &folder, const unsigned int step, const MPI_Comm comm)
  {
    on_root(comm, [&] {
      std::error_code code;
      std::filesystem::create_directories(folder + states_folder, code);
      if (code)
        throw OutputError(folder + states_folder, "the folder cannot be made (" + code.message() + ")");
    });
    return folder + states_folder + "/" + Output::state_name(step);
  }

  /// What does not depend on the dimension.
  struct SavedRun::Contents
  {
    virtual ~Contents()                                                                                     = default;
    virtual Method            &load(const Output::ArchiveReader &archive, const std::string &path)          = 0;
    virtual void               let_go()                                                                     = 0;
    virtual const MethodFacts &facts() const                                                                = 0;
    virtual bool               has_exact(const std::string &field) const                                    = 0;
    virtual void exact(const std::string &field, const Output::Place &X, double time, double *values) const = 0;
  };

  template <int dim>
  struct SavedRun::ContentsIn : SavedRun::Contents
  {
    ContentsIn(const ParameterFile &file, const MPI_Comm comm)
      : file(file)
      , problem(file, Parameters::Mode::read, comm, timers)
    {}

    Method &
    load(const Output::ArchiveReader &archive, const std::string &path) override
    {
      check_same_scene(archive, path, problem.parameters, file, file_checksums(*problem.scene),
                       "remove the state, or give the folder of the run that it is of", "Time");
      let_go();
      is_loaded = true;
      load_state(*problem.method, archive, problem.scene->comm);
      return *problem.method;
    }

    void
    let_go() override
    {
      if (is_loaded)
        problem.make_method(timers);
      is_loaded = false;
    }

    const MethodFacts &
    facts() const override
    {
      return problem.method->facts;
    }
    bool
    has_exact(const std::string &field) const override
    {
      return ExactSolution<dim>(*problem.scene).has(field);
    }

    void
    exact(const std::string &field, const Output::Place &X, const double time, double *values) const override
    {
      ExactSolution<dim>(*problem.scene).fill(field, X, time, values);
    }

    const ParameterFile &file;
    Timers               timers;
    Problem<dim>         problem;
    bool                 is_loaded = false;
  };

  SavedRun::SavedRun(const std::string &folder, const MPI_Comm comm)
    : path(folder)
    , comm(comm)
  {
    const auto files = list_states(folder, comm);
    parameters       = ParameterFile::read(folder + "/parameters.prm");
    dim              = dimension_of(parameters);
    if (dim == 2)
      contents = std::make_unique<ContentsIn<2>>(parameters, comm);
    else
      contents = std::make_unique<ContentsIn<3>>(parameters, comm);
    for (const auto &file : files)
      {
        const double time = Output::ArchiveReader(file, comm).attribute_double("time");
        if (!state_times.empty() && time <= state_times.back())
          continue;
        state_times.push_back(time);
        state_files.push_back(file);
      }
  }

  SavedRun::~SavedRun() = default;

  Method &
  SavedRun::at(const double time)
  {
    const auto place = std::find(state_times.begin(), state_times.end(), time) - state_times.begin();
    AssertThrow(static_cast<std::size_t>(place) < state_times.size(), dealii::ExcMessage("no state at this time"));
    const Output::ArchiveReader archive(state_files[place], comm);
    if (!archive.is_same_ranks()) // otherwise each rank's block is checked as it is read
      if (const std::string damage = archive.damage(); !damage.empty())
        throw UserError(state_files[place], "'" + damage + "' is damaged; run it again, or remove the state");
    return contents->load(archive, state_files[place]);
  }

  void
  SavedRun::let_go()
  {
    contents->let_go();
  }

  template <int dimension>
  const Scene<dimension> &
  SavedRun::scene() const
  {
    AssertDimension(dim, dimension);
    return *static_cast<const ContentsIn<dimension> &>(*contents).problem.scene;
  }

  template const Scene<2> &SavedRun::scene() const;
  template const Scene<3> &SavedRun::scene() const;

  const MethodFacts &
  SavedRun::facts() const
  {
    return contents->facts();
  }

  bool
  SavedRun::has_exact(const std::string &field) const
  {
    return contents->has_exact(field);
  }

  void
  SavedRun::exact(const std::string &field, const Output::Place &X, const double time, double *values) const
  {
    contents->exact(field, X, time, values);
  }
} // namespace Stroma
