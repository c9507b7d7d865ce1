#include <stroma/base/text.h>
#include <stroma/simulation/output_settings.h>

#include <algorithm>

namespace Stroma
{
  void
  OutputSettings::add(Parameters &p, const std::vector<std::string> &known)
  {
    p.add("Fields every", fields_every, "steps between field files; 0: only at the end");
    p.add("Point fields", point_fields, "fields at points, of: " + join(known, ", ") + "; or none");
    p.add("Grid fields", grid_fields, "write displacement, forces and cell averages on the grid");
    p.add_choice<Output::Format>("Format", format, "files of points: VTU for ParaView, or HDF5 with XDMF",
                                 {{"vtu", Output::Format::vtu}, {"xdmf", Output::Format::xdmf}});
    p.add("Checkpoint every", checkpoint_every, "steps between checkpoints; 0: none (a stopped or failed run always saves)");
    p.add("Keep states", keep_states, "keep the whole state at every field file, for 'stroma compare'");
    if (point_fields.size() == 1 && point_fields[0] == "none")
      point_fields.clear();
    for (const auto &name : point_fields)
      if (std::find(known.begin(), known.end(), name) == known.end())
        throw UserError(p.where("Point fields"), "'Point fields' names '" + name + "'; it must be of: " +
                                                   join(known, ", ") + ", or 'none'");
  }
} // namespace Stroma
