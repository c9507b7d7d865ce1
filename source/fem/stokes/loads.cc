// Loads of StokesSystem.

#include <stroma/fem/stokes/system.h>

namespace Stroma::Fem
{
  template <int dim>
  void
  StokesSystem<dim>::check_loads() const
  {
    using Kind = typename Region<dim>::Kind;
    for (const auto &load : scene.loads)
      if (load.region.kind == Kind::nearest)
        throw UserError(load.where,
                        "load '" + load.name +
                          "' acts on one point, where a fluid would move without bound; spread it over a ball");
  }

  template <int dim>
  void
  StokesSystem<dim>::set_time(const double t)
  {
    if (loads)
      loads->assemble(t, external);
  }

  template void StokesSystem<2>::check_loads() const;
  template void StokesSystem<3>::check_loads() const;
  template void StokesSystem<2>::set_time(double);
  template void StokesSystem<3>::set_time(double);
} // namespace Stroma::Fem
