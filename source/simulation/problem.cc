#include <stroma/fem/solid_method.h>
#include <stroma/fem/stokes_method.h>
#include <stroma/base/text.h>
#include <stroma/mpm/method.h>
#include <stroma/simulation/problem.h>
#include <stroma/sph/nsph_method.h>
#include <stroma/sph/sph_method.h>

#include <algorithm>

namespace Stroma
{
  namespace
  {
    enum class MethodName
    {
      mpm,
      fem,
      nsph,
      sph
    };

    const std::vector<std::pair<std::string, MethodName>> methods = {{"mpm", MethodName::mpm},
                                                                     {"fem", MethodName::fem},
                                                                     {"nsph", MethodName::nsph},
                                                                     {"sph", MethodName::sph}};

    template <int dim>
    Fem::Settings<dim>
    read_fem(Parameters &p, const Scene<dim> &scene)
    {
      const auto         section = p.section("FEM", "finite elements");
      Fem::Settings<dim> settings;
      settings.add(p, scene);
      return settings;
    }
  } // namespace

  template <int dim>
  Problem<dim>::Problem(const ParameterFile &file, const Parameters::Mode mode, const MPI_Comm comm, Timers &timers)
    : parameters(file, mode)
  {
    const auto   reading   = timers.scope("reading");
    unsigned int dimension = dim;
    parameters.add("Dimension", dimension, "space dimension", Range::closed(2, 3));
    {
      const auto section = parameters.section("Time", "steps; in quasi-static scenes time only orders the loading");
      step_settings.add(parameters);
    }
    scene = std::make_unique<Scene<dim>>(parameters, comm);
    if (mode == Parameters::Mode::read)
      scene->check_finite(step_settings.end_time);
    make_method(timers);
    probes = Probes<dim>(add_probes<dim>(parameters, {scene->material_names, scene->body_names}));
    {
      const auto section = parameters.section("Output", "what is written");
      output.add(parameters, method->known_point_fields());
      for (const double t : output.fields_at)
        if (mode == Parameters::Mode::read && t > step_settings.end_time * (1 + 1e-12))
          throw UserError(parameters.where("Fields at"), "'Fields at' has " + parameters.in_file_units(t, "s") +
                                                           ", but the run ends at " +
                                                           parameters.in_file_units(step_settings.end_time, "s") +
                                                           " ('Time/End'); remove that time or let the run end later");
    }
    parameters.finish();
  }

  template <int dim>
  void
  Problem<dim>::make_method(Timers &timers)
  {
    MethodName name = MethodName::mpm;
    parameters.add_choice<MethodName>("Method", name, "how the scene is solved: material points, finite elements, particles without or with inertia", methods);
    const double end = step_settings.end_time;
    if (name == MethodName::mpm)
      method = std::make_unique<Mpm::MpmMethod<dim>>(parameters, *scene, end, timers);
    else if (name == MethodName::nsph)
      method = std::make_unique<Sph::NsphMethod<dim>>(parameters, *scene, step_settings, timers);
    else if (name == MethodName::sph)
      method = std::make_unique<Sph::SphMethod<dim>>(parameters, *scene, end, timers);
    else
      {
        const auto settings = read_fem(parameters, *scene);
        if (scene->is_fluid())
          method = std::make_unique<Fem::StokesMethod<dim>>(parameters, *scene, settings, end, timers);
        else
          method = std::make_unique<Fem::SolidMethod<dim>>(parameters, *scene, settings, end, timers);
      }

    // One file may hold the settings of several methods: those of the others are checked and left alone.
    const auto sections = parameters.subsections();
    const auto has      = [&](const std::string &section) {
      return std::find(sections.begin(), sections.end(), section) != sections.end();
    };
    if (name != MethodName::fem && has("FEM"))
      read_fem(parameters, *scene);
    if (name != MethodName::mpm && has("MPM"))
      {
        const auto section = parameters.section("MPM", "the material point method");
        Mpm::Settings<dim>().add(parameters, *scene);
      }
    for (const auto &[other, section_name] : {std::make_pair(MethodName::nsph, "NSPH"), {MethodName::sph, "SPH"}})
      if (name != other && has(section_name))
        {
          const auto section = parameters.section(section_name, "smoothed particle hydrodynamics");
          Sph::Settings().add(parameters, other == MethodName::sph);
        }
  }

  unsigned int
  dimension_of(const ParameterFile &file)
  {
    const auto *entry = file.find({}, "Dimension");
    if (!entry)
      return 3;
    if (entry->value != "2" && entry->value != "3")
      throw UserError(entry->where, "'Dimension' was given as '" + shown(entry->value) + "'; it must be 2 or 3");
    return entry->value == "2" ? 2 : 3;
  }

  template class Problem<2>;
  template class Problem<3>;
} // namespace Stroma
