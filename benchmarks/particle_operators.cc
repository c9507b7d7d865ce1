// Speed of the particle methods' operators, each alone, in particles a second.

#include <stroma/sph/step_operator.h>

#include <deal.II/base/mpi.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

namespace
{
  using namespace Stroma;

  /// A Kelvin-Voigt square or cube of side 1 in clamped walls.
  template <int dim>
  std::string
  scene_text()
  {
    std::string walls;
    for (unsigned int d = 0; d < dim; ++d)
      for (const std::string end : {"min", "max"})
        {
          const std::string side = std::string(1, "xyz"[d]) + "-" + end;
          walls += " subsection " + side + "\n  set Where = side " + side + "\n  set Type = clamp\n end\n";
        }
    return "subsection Materials\n subsection gel\n  set Law = hypoelastic\n  set Young's modulus = 2.5\n"
           "  set Poisson's ratio = .45\n  set Viscosity = 100\n  set Viscous operator = morris\n end\nend\n"
           "subsection Bodies\n subsection block\n  set Shape = box\n  set Upper corner = " +
           std::string(dim == 2 ? "1, 1" : "1, 1, 1") + "\n end\nend\nsubsection Supports\n" + walls + "end\n";
  }

  /// Prints what @p operation does a second: the best of runs over half a second, of @p n_particles each.
  void
  report(const char *name, const double n_particles, const std::function<void()> &operation)
  {
    using Clock       = std::chrono::steady_clock;
    double       best = 1e300, total = 0.;
    unsigned int n_runs = 0;
    for (; total < .5 || n_runs < 3; ++n_runs)
      {
        const auto start = Clock::now();
        operation();
        const double time = dealii::Utilities::MPI::max(std::chrono::duration<double>(Clock::now() - start).count(),
                                                        MPI_COMM_WORLD);
        best              = std::min(best, time);
        total += time;
      }
    if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::printf("  %-34s %8.2f M particles/s (mean %.2f)\n", name, n_particles / best * 1e-6,
                  n_particles * n_runs / total * 1e-6);
  }

  template <int dim>
  void
  measure(const unsigned int n, const double jitter)
  {
    const auto       file = ParameterFile::parse(scene_text<dim>(), "benchmark");
    Parameters       parameters(file);
    const Scene<dim> scene(parameters, MPI_COMM_WORLD);
    Sph::Settings    settings;
    settings.arrangement.spacing = 1. / n;
    settings.arrangement.jitter  = jitter;
    Timers           timers;
    Sph::System<dim> system(scene, settings, Sph::Dynamics::overdamped, 1., timers);
    system.arrange();
    if (system.update_geometry(true) != StepStatus::ok)
      return;
    system.set_step(0., 1.);

    const double all     = system.n_free;
    const double n_pairs = dealii::Utilities::MPI::sum(double(system.pairs.n_pairs()), MPI_COMM_WORLD);
    if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::printf("%dD, %.0f particles with %.1f neighbours, jitter %g, %u ranks\n", dim, all, n_pairs / all, jitter,
                  dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD));

    std::vector<dealii::Tensor<1, dim>> v(system.pairs.n_points()), f(system.particles.n_free);
    for (unsigned int i = 0; i < v.size(); ++i)
      v[i][0] = system.particles.x[i][dim - 1];
    report("neighbours", all, [&] { system.neighbours->rebuild(system.particles); });
    report("pairs", all, [&] { system.pairs.update(system.particles, *system.neighbours, 0., system.poses); });
    report("area vectors, warm start", all, [&] { system.area_vectors->close(system.pairs, system.particles); });
    report("friction: coefficients", all, [&] { system.friction->update(system.particles); });
    report("friction: Gamma v", all, [&] { system.friction->add_force(f, v); });
    report("elasticity: coefficients", all, [&] { system.elasticity->update(system.particles); });
    system.elasticity->combine(1., 0.);
    report("elasticity: K_el v", all, [&] { system.elasticity->add_stiffness_force(f, v); });
    std::vector<dealii::Tensor<2, dim>> L(system.pairs.n_rows());
    report("velocity gradient", all, [&] { system.elasticity->velocity_gradient(L, v); });
    Sph::StepOperator<dim> A(system);
    for (const double dt : {0., 10.})
      {
        A.set_step(dt);
        Vector x = A.new_vector(), y(x);
        report(dt > 0. ? "A v, implicit" : "A v, explicit", all, [&] { A.vmult(y, x); });
        report("  approximation for multigrid", all, [&] { A.approximation(); });
      }
    report("stress forces", all, [&] { system.state_forces(f, 1.); });
    report("a part of a step of SPH", all, [&] {
      system.state_forces(f, 1.);
      system.add_friction(f, v);
      system.set_gradient(v);
      system.commit(v, 1e-9);
    });
  }
} // namespace

int
main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  if (argc < 3)
    {
      std::puts("particle_operators DIMENSION PARTICLES_PER_SIDE [JITTER]");
      return 1;
    }
  const unsigned int n      = std::atoi(argv[2]);
  const double       jitter = argc > 3 ? std::atof(argv[3]) : 0.;
  if (std::string(argv[1]) == "3")
    measure<3>(n, jitter);
  else
    measure<2>(n, jitter);
}
