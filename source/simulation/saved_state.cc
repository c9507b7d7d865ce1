#include <stroma/base/text.h>
#include <stroma/output/collective.h>
#include <stroma/simulation/saved_state.h>

#include <algorithm>

namespace Stroma
{
  void
  save_state(const Method &method, Output::ArchiveWriter &archive, const MPI_Comm comm)
  {
    std::vector<std::string> names;
    std::vector<double>      values; // of rank 0
    for (const auto &[name, value] : method.scalars)
      names.push_back(name);
    if (dealii::Utilities::MPI::this_mpi_process(comm) == 0)
      for (const auto &[name, value] : method.scalars)
        values.push_back(value);
    archive.attribute("time", method.time);
    archive.attribute("ending", method.ending);
    archive.attribute("scalar_names", join(names, "\n"));
    archive.write("scalars", dealii::make_array_view(values));
    method.save(archive);
  }

  void
  load_state(Method &method, const Output::ArchiveReader &archive, const MPI_Comm comm)
  {
    method.time = archive.attribute_double("time");
    method.setup(&archive);
    method.ending     = archive.attribute_string("ending");
    const auto names  = split(archive.attribute_string("scalar_names"), '\n');
    const auto values = Output::gather_all(archive.read_double("scalars"), comm);
    method.scalars.clear();
    for (std::size_t i = 0; i < std::min(names.size(), values.size()); ++i)
      method.scalars.emplace_back(names[i], values[i]);
  }
} // namespace Stroma
