// Saving and continuing StokesMethod.

#include <stroma/fem/stokes_method.h>
#include <stroma/output/collective.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Fem
{
  namespace
  {
    /// Fills @p values, named @p mine, from the array @p name; false if one of them is not there.
    bool
    read_named(const Output::ArchiveReader &archive, const std::string &name, const std::vector<std::uint64_t> &mine,
               Vector &values, const MPI_Comm comm)
    {
      auto names  = archive.read_uint64(name + "_names");
      auto stored = archive.read_double(name);
      if (!archive.is_same_ranks())
      {
        names  = Output::gather_all(names, comm);
        stored = Output::gather_all(stored, comm);
      }
      std::vector<std::pair<std::uint64_t, double>> known(names.size());
      for (std::size_t i = 0; i < names.size(); ++i)
        known[i] = { names[i], stored[i] };
      std::sort(known.begin(), known.end());
      for (std::size_t i = 0; i < mine.size(); ++i)
      {
        const auto entry = std::lower_bound(known.begin(), known.end(),
                                            std::make_pair(mine[i], std::numeric_limits<double>::lowest()));
        if (entry == known.end() || entry->first != mine[i])
          return false;
        values.begin()[i] = entry->second;
      }
      return true;
    }
  } // namespace

  /// Names of the owned unknowns that do not depend on the number of ranks: the node's place, then the component.
  template <int dim>
  std::vector<std::uint64_t>
  StokesMethod<dim>::names(const dealii::DoFHandler<dim> &dofs) const
  {
    constexpr unsigned int     bits = 60 / dim;
    const auto                 box  = scene.bounding_box();
    const auto                 X    = space->places(dofs);
    const auto                 c    = &dofs == &space->velocity_dofs ? space->components() :
                                                                       std::vector<unsigned int>(X.size());
    std::vector<std::uint64_t> names(X.size());
    for (unsigned int i = 0; i < X.size(); ++i)
    {
      for (unsigned int d = 0; d < dim; ++d)
        names[i] = (names[i] << bits)
                   + std::llround((X[i][d] - box.lower_bound(d)) / box.side_length(d) * ((1ull << bits) - 1));
      names[i] = names[i] << 2 | c[i];
    }
    return names;
  }

  template <int dim>
  void
  StokesMethod<dim>::save(Output::ArchiveWriter &archive) const
  {
    const auto scope = timers.scope("checkpoint");
    const auto write = [&](const std::string &name, const Vector &values, const std::vector<std::uint64_t> &names) {
      archive.write(name + "_names", dealii::make_array_view(names));
      archive.write(name, dealii::ArrayView<const double>(values.begin(), names.size()));
    };
    archive.attribute("time", time);
    write("velocity", flow.v, names(space->velocity_dofs));
    write("pressure", flow.p, names(space->pressure_dofs));
    std::vector<double> scalars; // of rank 0
    if (dealii::Utilities::MPI::this_mpi_process(scene.comm) == 0)
      for (const auto &scalar : committed_scalars)
        scalars.push_back(scalar.second);
    archive.write("scalars", dealii::make_array_view(scalars));
  }

  template <int dim>
  void
  StokesMethod<dim>::load(const Output::ArchiveReader &archive)
  {
    time             = archive.attribute_double("time");
    const bool found = read_named(archive, "velocity", names(space->velocity_dofs), flow.v, scene.comm)
                       && read_named(archive, "pressure", names(space->pressure_dofs), flow.p, scene.comm);
    if (dealii::Utilities::MPI::min(static_cast<int>(found), scene.comm) == 0)
      throw UserError("the checkpoint's mesh is not that of the scene; start anew with --overwrite");
    const auto scalars = Output::gather_all(archive.read_double("scalars"), scene.comm);
    for (std::size_t i = 0; i < std::min(scalars.size(), committed_scalars.size()); ++i)
      committed_scalars[i].second = scalars[i];
  }

  template class StokesMethod<2>;
  template class StokesMethod<3>;
} // namespace Stroma::Fem
