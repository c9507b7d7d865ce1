#include <stroma/scene/probe.h>

namespace Stroma
{
  template <int dim>
  std::vector<Probe<dim>>
  add_probes(Parameters &p, const SceneNames &names)
  {
    const auto section = p.section("Probes",
                                   "one subsection a place whose displacement is a result, named as you like");
    auto       known   = p.names("probe");
    if (known.empty() && p.get_mode() == Parameters::Mode::document)
      known.push_back("tip");
    std::vector<Probe<dim>> probes;
    for (const auto &name : known)
      {
        const auto  subsection = p.section(name);
        Region<dim> region;
        region.add(p, names);
        if (p.get_mode() == Parameters::Mode::read && region.kind != Region<dim>::Kind::nearest)
          throw UserError(region.text.empty() ? p.where_section() : p.where("Where"),
                          "a probe is one place, but 'Where' is '" + region.text + "'; give 'nearest " +
                            (dim == 2 ? "x, y" : "x, y, z") + "'");
        probes.push_back({name, region.first, p.where("Where")});
      }
    return probes;
  }

  template std::vector<Probe<2>> add_probes(Parameters &, const SceneNames &);
  template std::vector<Probe<3>> add_probes(Parameters &, const SceneNames &);
} // namespace Stroma
