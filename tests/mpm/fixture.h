#pragma once

#include <stroma/mpm/system.h>

#include <memory>
#include <string>

/// The parts of an MPM scene, without the run loop, made from the text of a parameter file.
template <int dim>
struct SystemFixture
{
  explicit SystemFixture(const std::string &text)
    : file(Stroma::ParameterFile::parse(text, "test.prm"))
    , parameters(file)
    , scene(parameters, MPI_COMM_WORLD)
  {
    {
      const auto section = parameters.section("MPM");
      settings.add(parameters, scene);
    }
    parameters.finish();
    motion = std::make_unique<Stroma::Mpm::PrescribedMotion<dim>>(scene, settings, 1.);
    grid   = std::make_unique<Stroma::BackgroundGrid<dim>>(settings.grid_box(scene), settings.shape_functions(),
                                                         MPI_COMM_WORLD);
    points = std::make_unique<Stroma::Mpm::Points<dim>>(scene, settings, *grid, motion->any_drives_points());
    motion->mark_points(*points, grid->box());
    if (points->load.stored())
      Stroma::Mpm::LoadedPoints<dim>(scene, *points).mark(*points);
    system = std::make_unique<Stroma::Mpm::System<dim>>(scene, settings, *grid, *points, *motion, timers);
    system->rebuild();
    system->set_committed(1., 0.);
  }

  Stroma::ParameterFile                               file;
  Stroma::Parameters                                  parameters;
  Stroma::Scene<dim>                                  scene;
  Stroma::Mpm::Settings<dim>                          settings;
  Stroma::Timers                                      timers;
  std::unique_ptr<Stroma::Mpm::PrescribedMotion<dim>> motion;
  std::unique_ptr<Stroma::BackgroundGrid<dim>>        grid;
  std::unique_ptr<Stroma::Mpm::Points<dim>>           points;
  std::unique_ptr<Stroma::Mpm::System<dim>>           system;
};

/// Two materials, a box of edge 1 m.
inline std::string
two_material_box(const int dim, const std::string &more)
{
  const std::string corner = dim == 2 ? "1, 1" : "1, 1, 1", ball = dim == 2 ? "0.4, 0.5" : "0.4, 0.5, 0.6";
  return "subsection Materials\n"
         " subsection soft\n set Law = neo-Hookean\n set Shear modulus = 1\n set Bulk modulus = 2\n end\n"
         " subsection stiff\n set Law = neo-Hookean\n set Shear modulus = 3\n set Bulk modulus = 7\n end\n"
         "end\n"
         "subsection Bodies\n"
         " subsection matrix\n set Shape = box\n set Upper corner = " +
         corner +
         "\n set Material = soft\n end\n"
         " subsection inclusion\n set Shape = ball\n set Centre = " +
         ball +
         "\n set Radius = 0.3\n set Material = stiff\n end\n"
         "end\n" +
         more;
}
