// What NSPH and SPH have in common: values between particles, own points, checkpoints.

#include "../method_state.h"
#include "../particles/scene_fixture.h"

#include <stroma/output/point_results.h>
#include <stroma/simulation/saved_state.h>
#include <stroma/sph/particle_method.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

namespace
{
  using namespace Stroma;

  /// Moves the particles as it is told.
  template <int dim>
  class Driven : public Sph::ParticleMethod<dim>
  {
  public:
    using Field = dealii::Tensor<1, dim> (*)(const dealii::Point<dim> &X);

    Driven(ParticleScene<dim> &scene, Timers &timers, const Field velocity)
      : Sph::ParticleMethod<dim>(scene.parameters, scene.scene, Sph::Dynamics::inertial, 1., timers)
      , velocity(velocity)
    {}

    StepStatus
    advance(const double t, const double t_next, StepWork &) override
    {
      auto      &particles = this->system->particles;
      const auto status    = this->system->update_geometry();
      this->system->set_step(t, t_next);
      auto v = particles.v;
      for (unsigned int i = 0; i < particles.n_free; ++i)
        v[i] = velocity(particles.X[i]);
      this->system->impose(v);
      this->system->set_gradient(v);
      this->system->commit(v, t_next - t);
      this->time = t_next;
      this->collect_scalars(t_next);
      return status;
    }

    const Sph::ParticleSet<dim> &
    particles() const
    {
      return this->system->particles;
    }

  private:
    void
    prepare(const Output::ArchiveReader *) override
    {}
    void
    describe_stepping(Output::Summary &summary) const override
    {
      summary.method = "driven";
    }

    Field velocity;
  };

  dealii::Tensor<1, 2>
  parabola(const dealii::Point<2> &X)
  {
    return dealii::Point<2>(.02 * X[1] + .03 * X[0] * X[1], .01 * X[1] * X[1] - .02 * X[1]);
  }

  const std::string numbers = "subsection SPH\n set Spacing = 0.05\nend\n";

  std::string
  block(const std::string &more = clamped({"y-min"}))
  {
    return box_of_gel("1, 1", numbers + more);
  }

  /// For names of files, as tests on several numbers of ranks run at once.
  std::string
  n_ranks()
  {
    return std::to_string(dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD));
  }

  /// Removes a file or folder once all ranks are done with it.
  void
  remove_at_end(const std::string &path)
  {
    MPI_Barrier(MPI_COMM_WORLD);
    if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::filesystem::remove_all(path);
  }

  template <int dim>
  void
  go(Driven<dim> &method, const unsigned int from, const unsigned int to)
  {
    StepWork work;
    for (unsigned int step = from; step < to; ++step)
      ASSERT_EQ(method.advance(.25 * step, .25 * (step + 1), work), StepStatus::ok);
  }

  TEST(ParticleMethod, MpiSamplesAreExactForParabolas)
  {
    ParticleScene<2> scene(block());
    Timers           timers;
    Driven<2>        method(scene, timers, parabola);
    method.setup(nullptr);
    go(method, 0, 4);
    std::vector<Output::Place> places;
    for (const double x : {.01, .3, .52, .77, .9})
      for (const double y : {.001, .02, .4, .61, .9})
        places.push_back({{x, y, 0.}});
    places.push_back({{.5, 1.01, 0.}});
    const auto samples = sampled(method, 2, {"displacement", "displacement_gradient", "velocity", "cauchy_stress"},
                                 places);
    const unsigned int width = 2 + 4 + 2 + 6;
    ASSERT_EQ(samples.values.size(), samples.X.size() * width);
    for (unsigned int i = 0; i + 1 < samples.X.size(); ++i)
      {
        const double               *value = samples.values.data() + i * width;
        const double                x = samples.X[i][0], y = samples.X[i][1];
        const auto                  exact = parabola({x, y});
        const std::array<double, 4> gradient{{.03 * y, .02 + .03 * x, 0., .02 * y - .02}};
        ASSERT_TRUE(samples.found[i]);
        for (unsigned int c = 0; c < 2; ++c)
          {
            EXPECT_NEAR(value[c], exact[c], 1e-12) << x << ' ' << y;
            EXPECT_NEAR(value[6 + c], exact[c], 1e-12);
          }
        for (unsigned int k = 0; k < 4; ++k)
          EXPECT_NEAR(value[2 + k], gradient[k], 1e-10) << x << ' ' << y;
      }
    EXPECT_FALSE(samples.found.back());
  }

  dealii::Tensor<1, 2>
  shear(const dealii::Point<2> &X)
  {
    return dealii::Point<2>(.02 * X[1], 0.);
  }

  /// sigma_xy of particles far from the surfaces after a shear at the rate .02/s.
  double
  shear_stress(const std::vector<std::string> &set)
  {
    ParticleScene<2> scene(block(), set);
    Timers           timers;
    Driven<2>        method(scene, timers, shear);
    method.setup(nullptr);
    go(method, 0, 4);
    const auto samples = all_own_samples(method, 2, {"cauchy_stress"});
    for (unsigned int i = 0; i < samples.X.size(); ++i)
      if (std::abs(samples.X[i][0] - .475) < 1e-9 && std::abs(samples.X[i][1] - .475) < 1e-9)
        return samples.values[6 * i + 3];
    return std::nan("");
  }

  TEST(ParticleMethod, MpiStressesHoldThoseOfEitherFriction)
  {
    const double elastic = shear_stress({});
    for (const std::string form : {"central", "morris"})
      {
        std::vector<std::string> set;
        for (const std::string material : {"gel", "stiff"})
          for (const std::string &entry : {std::string("Viscosity=100"), "Viscous operator=" + form})
            set.push_back("Materials/" + material + "/" + entry);
        const double expected = form == "central" ? 100. * .02 : 100. * .01; // mu grad v, symmetric part
        EXPECT_NEAR(shear_stress(set) - elastic, expected, 1e-3 * expected) << form;
      }
  }

  TEST(ParticleMethod, MpiOwnSamplesFillTheBody)
  {
    ParticleScene<2> scene(block());
    Timers           timers;
    Driven<2>        method(scene, timers, parabola);
    method.setup(nullptr);
    go(method, 0, 4);
    const auto samples = all_own_samples(method, 2, {"displacement", "displacement_gradient"});
    ASSERT_EQ(samples.X.size(), 400u);
    double volume = 0.;
    for (unsigned int i = 0; i < samples.X.size(); ++i)
      {
        volume += samples.weight[i];
        const auto exact = parabola({samples.X[i][0], samples.X[i][1]});
        EXPECT_NEAR(samples.values[6 * i], exact[0], 1e-12);
        EXPECT_NEAR(samples.values[6 * i + 1], exact[1], 1e-12);
      }
    EXPECT_NEAR(volume, 1., 1e-12);
  }

  TEST(ParticleMethod, SamplesSeeThroughPeriodicFaces)
  {
    ParticleScene<2> scene(block("subsection Periodic\n set Directions = x\nend\n" + clamped({"y-min", "y-max"})));
    Timers           timers;
    Driven<2>        method(scene, timers, [](const dealii::Point<2> &X) -> dealii::Tensor<1, 2> {
      return dealii::Point<2>(.01 * std::sin(2. * M_PI * X[0]) * X[1] * (1. - X[1]), 0.);
    });
    method.setup(nullptr);
    go(method, 0, 4);
    const auto samples = sampled(method, 2, {"displacement", "displacement_gradient"},
                                 {{{1e-6, .5, 0.}}, {{1. - 1e-6, .5, 0.}}});
    for (unsigned int i = 0; i < 2; ++i)
      {
        EXPECT_NEAR(samples.values[6 * i], 0., 1e-6);
        EXPECT_NEAR(samples.values[6 * i + 2], 2. * M_PI * .0025, 6e-4);
      }
  }

  TEST(ParticleMethod, MpiResumedRunRepeatsItself)
  {
    const std::string file = "particle_method_" + n_ranks() + ".h5";
    Timers            timers;
    // A total load, of which each particle has its share.
    const std::string load = "subsection Loads\n subsection pull\n  set Where = layer y-max 0.3\n  set Total force = "
                             "0; 0.01*t\n end\nend\n";
    ParticleScene<2>  scene(block(clamped({"y-min"}) + load)), again(block(clamped({"y-min"}) + load));
    Driven<2>         method(scene, timers, parabola), resumed(again, timers, parabola);
    method.setup(nullptr);
    go(method, 0, 2);
    {
      Output::ArchiveWriter archive(file, scene.scene.comm);
      save_state(method, archive, scene.scene.comm);
      archive.commit();
    }
    {
      const Output::ArchiveReader archive(file, scene.scene.comm);
      load_state(resumed, archive, scene.scene.comm);
    }
    go(method, 2, 4);
    go(resumed, 2, 4);
    EXPECT_EQ(method.scalars, resumed.scalars);
    const auto &a = method.particles(), &b = resumed.particles();
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.x, b.x);
    EXPECT_EQ(a.J, b.J);
    EXPECT_EQ(a.S, b.S);
    EXPECT_EQ(a.closure, b.closure);
    remove_at_end(file);
  }

  TEST(ParticleMethod, MpiFieldsAndSummary)
  {
    const std::string folder = "particle_method_" + n_ranks();
    std::filesystem::create_directories(folder);
    ParticleScene<2> scene(block());
    Timers           timers;
    Driven<2>        method(scene, timers, parabola);
    method.setup(nullptr);
    go(method, 0, 1);
    const auto records = Output::write_points(*method.state(false), 2,
                                              {folder, 0, method.facts.point_fields, true, Output::Format::vtu, {}, {}},
                                              MPI_COMM_WORLD);
    EXPECT_TRUE(std::filesystem::exists(folder + "/" + records.points));
    EXPECT_TRUE(std::filesystem::exists(folder + "/" + records.walls) && records.walls != records.points);
    Output::Summary summary;
    method.describe(summary);
    Output::add_point_results(*method.state(false), {}, MPI_COMM_WORLD, summary.results);
    EXPECT_EQ(summary.n_dofs, 800u);
    EXPECT_GT(summary.n_points, 400u);
    EXPECT_GT(summary.results.at("max_von_mises_Pa"), 0.);
    EXPECT_GT(summary.bytes_per_point, 100.);
    remove_at_end(folder);
  }
} // namespace
