#pragma once

#include "../output/temporary_folder.h"

#include <stroma/methods/table.h>
#include <stroma/output/collective.h>
#include <stroma/simulation/simulation.h>

#include <map>

namespace Stroma
{
  /// What the made-up method is told to do.
  struct MadeUpOrders
  {
    double     longest_step = 1e9, last_time = 1e9; ///< longer steps, and all beyond this time, fail [s]
    StepStatus failure = StepStatus::diverged;      ///< beyond the last time
    bool       refuses = false;                     ///< to be set up
  };

  /// A method whose state is one number, the sum of the squares of its steps: it tells how a run was stepped. It fails when
  /// it is told to.
  class MadeUpMethod : public Method
  {
  public:
    static inline MadeUpOrders orders;

    /// Makes it known under the name 'made up', and forgets all orders.
    static void
    start()
    {
      static const bool once = [] {
        add_method<2>({"made up", "sums up its steps", "Made up",
                       [](Parameters &p, const Scene<2> &scene, const Solvers::StepSettings &,
                          Timers &) -> std::unique_ptr<Method> {
                         const auto section = p.section("Made up");
                         return std::make_unique<MadeUpMethod>(scene.comm);
                       },
                       [](Parameters &, const Scene<2> &) {}});
        return true;
      }();
      (void)once;
      orders = MadeUpOrders();
      Log::start(true);
    }

    explicit MadeUpMethod(const MPI_Comm comm)
      : comm(comm)
    {
      facts.sampled_fields = {"displacement"};
    }

    void
    setup(const Output::ArchiveReader *archive) override
    {
      if (orders.refuses)
        throw UserError("the made-up method refuses");
      if (archive)
        sum = Output::gather_all(archive->read_double("sum"), comm).at(0);
      else
        scalars = {{"sum_s2", sum}}; // not where it is resumed: the run loop puts them back
    }

    StepStatus
    advance(const double t, const double t_next, StepWork &work) override
    {
      ++n_calls;
      if (t_next > orders.last_time)
        return orders.failure;
      if (t_next - t > orders.longest_step)
        return StepStatus::diverged;
      work.newton_iterations = 1;
      sum += (t_next - t) * (t_next - t);
      time    = t_next;
      scalars = {{"sum_s2", sum}};
      return StepStatus::ok;
    }

    void
    describe(Output::Summary &summary) override
    {
      summary.results["calls"] = n_calls;
    }

    void
    save(Output::ArchiveWriter &archive) const override
    {
      const std::vector<double> mine(dealii::Utilities::MPI::this_mpi_process(comm) == 0 ? 1 : 0, sum);
      archive.write("sum", dealii::make_array_view(mine));
    }

    std::unique_ptr<Output::StateView>
    state(bool) override
    {
      return std::make_unique<View>(sum);
    }

    std::string
    write_grid(const Output::FieldRequest &) override
    {
      return "";
    }

  private:
    struct View : Output::StateView
    {
      explicit View(const double sum)
        : sum(sum)
      {}
      std::size_t
      n_points() const override
      {
        return 1;
      }
      void
      for_each_point(const Visit &visit) const override
      {
        Output::PointState point;
        point.V0 = 1.;
        visit(point);
      }
      void
      sample(const Output::StateFields &fields, Output::Samples &samples) const override
      {
        samples.values.assign(samples.X.size() * fields.width(), sum);
      }
      double sum;
    };

    MPI_Comm     comm;
    double       sum     = 0.;
    unsigned int n_calls = 0;
  };

  /// A run of the made-up method in @p folder: 1 s, in steps of at most .25 s.
  inline RunResult
  run_made_up(const TemporaryFolder &folder, const std::vector<std::string> &set = {}, const bool resume = false)
  {
    auto file = ParameterFile::parse(
      "set Dimension = 2\nset Method = made up\n"
      "subsection Materials\n subsection gel\n  set Shear modulus = 1\n  set Bulk modulus = 2\n end\nend\n"
      "subsection Bodies\n subsection block\n  set Upper corner = 2, 1\n end\nend\n"
      "subsection Time\n set Initial step = .25\n set Largest step = .25\n set Smallest step = 1e-3\nend\n"
      "subsection Made up\nend\n",
      "test.prm");
    for (const auto &assignment : set)
      file.set(assignment);
    RunOptions options;
    options.output = folder / "run";
    options.resume = resume;
    return run_simulation(file, options, MPI_COMM_WORLD);
  }
} // namespace Stroma
