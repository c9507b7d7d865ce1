#include <stroma/scene/loads.h>

#include <deal.II/base/mpi.h>

namespace Stroma
{
  template <int dim>
  void
  LoadDensities<dim>::measure(const unsigned int l, const long double of_rank)
  {
    sizes[l] = dealii::Utilities::MPI::sum(of_rank, scene.comm);
  }

  template <int dim>
  void
  LoadDensities<dim>::require(const unsigned int l, const std::string &parts) const
  {
    const auto &load = scene.loads[l];
    if (sizes[l] == 0.)
      throw UserError(load.where, "load '" + load.name + "' (" + load.region.text + ") selects no " + parts +
                                    "; enlarge it or move it into the bodies");
  }

  template <int dim>
  dealii::Tensor<1, dim>
  LoadDensities<dim>::value(const unsigned int l, const dealii::Point<dim> &X, const double t) const
  {
    const auto density = given(l).value(X, t);
    return scene.loads[l].total.given() ? density / sizes[l] : density;
  }

  template <int dim>
  bool
  LoadDensities<dim>::depends_on_time(const unsigned int l) const
  {
    return given(l).depends_on_time();
  }

  template <int dim>
  bool
  LoadDensities<dim>::depends_on_place(const unsigned int l) const
  {
    return given(l).depends_on_place();
  }

  template <int dim>
  const SpaceTimeVector<dim> &
  LoadDensities<dim>::given(const unsigned int l) const
  {
    const auto &load = scene.loads[l];
    return load.density.given() ? load.density : load.traction.given() ? load.traction : load.total;
  }

  template class LoadDensities<2>;
  template class LoadDensities<3>;
} // namespace Stroma
