#include <stroma/base/reserved_memory.h>
#include <stroma/base/text.h>
#include <stroma/base/unknown_entries.h>
#include <stroma/simulation/problem.h>
#include <stroma/simulation/results.h>

#include <algorithm>
#include <cctype>

namespace Stroma
{
  namespace
  {
    const std::string default_method = "mpm"; // in builds without it too: a file means the same to all

    /// Throws UserError if the file's method, given or not, is left out of this build.
    template <int dim>
    void
    check_method_is_there(const ParameterFile &file)
    {
      const auto       *entry = file.find({}, "Method");
      const std::string name  = entry ? entry->value : default_method;
      const auto       &all   = methods_left_out();
      if (std::find(all.begin(), all.end(), name) == all.end())
        return;
      std::vector<std::string> present;
      for (const auto &method : methods<dim>())
        present.push_back(method.name);
      throw UserError(entry ? entry->where : file.path(),
                      (entry ? "'Method' was given as '" + name + "', which" :
                               "'Method' is not given, and its default, " + name + ",") +
                        " is left out of this build (STROMA_METHODS); it has: " + join(present, ", "));
    }

    /// The section of a method that is left out of this build.
    std::string
    section_of(std::string method)
    {
      std::transform(method.begin(), method.end(), method.begin(),
                     [](const unsigned char c) { return std::toupper(c); });
      return method;
    }

    /// Sections that a scene may have although it does not use them: of other methods, of studies and fits.
    template <int dim>
    std::vector<std::string>
    sections_of_others()
    {
      std::vector<std::string> sections = {"Study", "Fit"};
      for (const auto &method : methods<dim>())
        sections.push_back(method.section);
      for (const auto &name : methods_left_out())
        sections.push_back(section_of(name));
      return sections;
    }

    /// Declares an entry as the text that it is.
    void
    keep(Parameters &p, const ParameterFile::Entry &entry, const std::size_t depth = 0)
    {
      if (depth < entry.section.size())
        {
          const auto section = p.section(entry.section[depth]);
          keep(p, entry, depth + 1);
          return;
        }
      std::string text = entry.value;
      p.add(entry.name, text, "of a method that is left out of this build, not checked");
    }

    /// One file may hold the settings of methods that this build has not.
    void
    keep_sections_left_out(Parameters &p, const ParameterFile &file)
    {
      for (const auto &name : methods_left_out())
        for (const auto &entry : file.entries())
          if (!entry.section.empty() && entry.section.front() == section_of(name))
            keep(p, entry);
    }

    /// Reads the file in the mode document, in which nothing is missing. Throws UnknownEntry. Collective.
    template <int dim>
    void
    document(const ParameterFile &file, const MPI_Comm comm)
    {
      Timers timers;
      Problem<dim>(file, Parameters::Mode::document, comm, timers);
    }

    /// Names of all sections that a scene may have.
    template <int dim>
    std::vector<std::string>
    known_sections(const MPI_Comm comm)
    {
      Timers              timers;
      const ParameterFile empty = ParameterFile::parse("", "");
      auto sections     = Problem<dim>(empty, Parameters::Mode::document, comm, timers).parameters.declared_sections();
      const auto others = sections_of_others<dim>();
      sections.insert(sections.end(), others.begin(), others.end());
      return sections;
    }

    /// What image fields and numbers of each material and body take of voxels, which may be many: sums of single precision, and
    /// samples for quantiles.
    template <int dim>
    double
    bytes_of_results(const Scene<dim> &scene, const OutputSettings &output)
    {
      const auto width = [](const std::vector<std::string> &fields) {
        return fields.empty() ? 0. : static_cast<double>(Output::StateFields(dim, fields).width());
      };
      const double of_image = output.image_fields.empty() ? 0. : sizeof(float) * (1. + width(output.image_fields));
      const double a_voxel  = of_image + sizeof(double) * (width(output.by_material) + width(output.by_body));
      double       bytes    = 0.;
      for (const auto &body : scene.bodies)
        if (body.is_image())
          bytes += a_voxel * static_cast<double>(body.voxels.material.size());
      return bytes;
    }
  } // namespace

  template <int dim>
  Problem<dim>::Problem(const ParameterFile &file, const Parameters::Mode mode, const MPI_Comm comm, Timers &timers)
    : parameters(file, mode)
  {
    const auto reading = timers.scope("reading");
    if (mode == Parameters::Mode::read)
      {
        check_method_is_there<dim>(file);
        unknown_first([&] { read(file, comm, timers); }, [&] { document<dim>(file, comm); });
      }
    else
      unknown_first([&] { read(file, comm, timers); },
                    [&] {
                      if (!file.entries().empty())
                        parameters.finish_declared(known_sections<dim>(comm));
                    });
  }

  template <int dim>
  void
  Problem<dim>::read(const ParameterFile &file, const MPI_Comm comm, Timers &timers)
  {
    const auto   mode      = parameters.get_mode();
    unsigned int dimension = dim;
    parameters.add("Dimension", dimension, "space dimension", Range::closed(2, 3));
    choose_method();
    {
      const auto section = parameters.section("Time", "steps; in quasi-static scenes time only orders the loading");
      step_settings.add(parameters);
    }
    scene = std::make_unique<Scene<dim>>(parameters, comm);
    if (mode == Parameters::Mode::read)
      scene->check_finite(step_settings.end_time);
    make_method(timers);
    if (mode == Parameters::Mode::read && method->facts.depends_on_rates)
      scene->check_rest_at_start();
    keep_sections_left_out(parameters, file);
    probes = Probes<dim>(add_probes<dim>(parameters, {scene->material_names, scene->body_names}), comm);
    {
      const auto section = parameters.section("Output", "what is written");
      output.add(parameters, method->facts.point_fields, method->facts.image_fields);
      check_results_by_body();
      Memory::reserve_for_results(bytes_of_results(*scene, output));
      for (const double t : output.fields_at)
        if (mode == Parameters::Mode::read && t > step_settings.end_time * (1 + 1e-12))
          throw UserError(parameters.where("Fields at"), "'Fields at' has " + parameters.in_file_units(t, "s") +
                                                           ", but the run ends at " +
                                                           parameters.in_file_units(step_settings.end_time, "s") +
                                                           " ('Time/End'); remove that time or let the run end later");
    }
    parameters.finish(sections_of_others<dim>());
  }

  /// Throws UserError where points cannot be told by their body, or a result of a body and one of a material had one name.
  template <int dim>
  void
  Problem<dim>::check_results_by_body() const
  {
    if (output.by_body.empty())
      return;
    const auto where = parameters.where("Results by body");
    if (scene->is_fluid())
      throw UserError(where, "'Results by body' is for solids, as fluids do not stay where they were; remove it");
    for (const auto &body : scene->body_names)
      for (const auto &material : scene->material_names)
        if (material == body_result_name(body))
          throw UserError(where, "'Results by body' would call results of body '" + body + "' as those of material '" +
                                   material + "'; rename one of them");
  }

  template <int dim>
  const MethodEntry<dim> &
  Problem<dim>::choose_method()
  {
    const auto                                                   &table  = methods<dim>();
    const MethodEntry<dim>                                       *chosen = &table.front();
    std::vector<std::pair<std::string, const MethodEntry<dim> *>> choices;
    std::vector<std::string>                                      meanings;
    for (const auto &entry : table)
      {
        choices.emplace_back(entry.name, &entry);
        meanings.push_back(entry.name + ": " + entry.meaning);
      }
    parameters.add_choice("Method", chosen, "how the scene is solved. " + join(meanings, "; "), choices);
    return *chosen;
  }

  template <int dim>
  void
  Problem<dim>::make_method(Timers &timers)
  {
    const auto &chosen = choose_method();
    method             = chosen.make(parameters, *scene, step_settings, timers);

    // One file may hold the settings of several methods: those of the others are checked and left alone.
    const auto sections = parameters.subsections();
    for (const auto &entry : methods<dim>())
      if (&entry != &chosen && std::find(sections.begin(), sections.end(), entry.section) != sections.end())
        entry.check_section(parameters, *scene);
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
