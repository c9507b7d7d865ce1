// Saving and continuing StokesMethod.

#include <stroma/fem/stokes/method.h>
#include <stroma/output/named_rows.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Fem
{
  /// Names of the owned unknowns that do not depend on the number of ranks: the node's place, then the component.
  template <int dim>
  std::vector<std::uint64_t>
  StokesMethod<dim>::names(const dealii::DoFHandler<dim> &dofs) const
  {
    constexpr unsigned int bits = 60 / dim;
    const auto             box  = scene.bounding_box();
    const auto             X    = space->places(dofs);
    const auto c = &dofs == &space->velocity_dofs ? space->components() : std::vector<unsigned int>(X.size());
    std::vector<std::uint64_t> names(X.size());
    for (unsigned int i = 0; i < X.size(); ++i)
      {
        for (unsigned int d = 0; d < dim; ++d)
          names[i] = (names[i] << bits) +
                     std::llround((X[i][d] - box.lower_bound(d)) / box.side_length(d) * ((1ull << bits) - 1));
        names[i] = names[i] << 2 | c[i];
      }
    return names;
  }

  template <int dim>
  void
  StokesMethod<dim>::save(Output::ArchiveWriter &archive) const
  {
    const auto write = [&](const std::string &name, const Vector &values, const std::vector<std::uint64_t> &names) {
      archive.write(name + "_names", dealii::make_array_view(names));
      archive.write(name, dealii::ArrayView<const double>(values.begin(), names.size()));
    };
    for (const auto &body : rigid)
      body.save(archive);
    write("velocity", flow.v, names(space->velocity_dofs));
    write("pressure", flow.p, names(space->pressure_dofs));
  }

  template <int dim>
  void
  StokesMethod<dim>::load(const Output::ArchiveReader &archive)
  {
    const auto read = [&](const std::string &name, const std::vector<std::uint64_t> &wanted, Vector &vector) {
      const Output::NamedRows rows(archive, name + "_names", wanted, scene.comm);
      if (!rows.has_all())
        throw UserError("the checkpoint's mesh is not that of the scene; start anew with --overwrite");
      const auto values = rows.read_last(name, 1);
      std::copy(values.begin(), values.end(), vector.begin());
    };
    for (auto &body : rigid)
      body.load(archive);
    read("velocity", names(space->velocity_dofs), flow.v);
    read("pressure", names(space->pressure_dofs), flow.p);
  }

  template class StokesMethod<2>;
  template class StokesMethod<3>;
} // namespace Stroma::Fem
