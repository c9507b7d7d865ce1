#include <stroma/base/text.h>
#include <stroma/simulation/output_settings.h>

#include <algorithm>

namespace Stroma
{
  void
  OutputSettings::add(Parameters &p, const std::vector<std::string> &known)
  {
    const auto is_unknown = [&](const std::string &name) {
      return std::find(known.begin(), known.end(), name) == known.end();
    };
    const auto add_fields = [&](const std::string &entry, std::vector<std::string> &names, const std::string &meaning) {
      p.add(entry, names, meaning + ", of: " + join(known, ", ") + "; or none");
      if (names.size() == 1 && names[0] == "none")
        names.clear();
      for (const auto &name : names)
        if (is_unknown(name))
          throw UserError(p.where(entry), "'" + entry + "' names '" + shown(name) +
                                            "'; it must be of: " + join(known, ", ") + ", or 'none'");
    };
    // Not every method has the fields that are written by default.
    point_fields.erase(std::remove_if(point_fields.begin(), point_fields.end(), is_unknown), point_fields.end());
    p.add("Fields every", fields_every, "steps between field files; 0: only at the end");
    p.add("Fields at", fields_at, "times of further field files; steps end there", "s", Range::positive());
    add_fields("Point fields", point_fields, "fields at points");
    add_fields("Results by material", by_material, "mean and quantiles at the end, of each material");
    add_fields("Results by body", by_body, "mean and quantiles at the end, of each body");
    p.add("Grid fields", grid_fields, "write displacement, forces and cell averages on the grid");
    p.add_choice<Output::Format>("Format", format, "files of points: VTU for ParaView, or HDF5 with XDMF",
                                 {{"vtu", Output::Format::vtu}, {"xdmf", Output::Format::xdmf}});
    p.add("Checkpoint every", checkpoint_every,
          "steps between checkpoints; 0: none (a stopped or failed run always saves)");
    p.add("Keep states", keep_states, "keep the whole state at every field file, for 'stroma compare'");
  }
} // namespace Stroma
