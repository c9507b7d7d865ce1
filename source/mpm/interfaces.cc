#include <stroma/mpm/interfaces.h>

namespace Stroma::Mpm
{
  template <int dim>
  void
  Interfaces<dim>::clear()
  {
    place.clear();
    all.clear();
  }

  template <int dim>
  void
  Interfaces<dim>::add_cell(const std::vector<Solid::Moments<dim>>         &moments,
                            const std::vector<const Materials::Material *> &laws, const dealii::Tensor<1, dim> &size)
  {
    const auto found = Solid::find_interface<dim>(moments, laws, size);
    place.push_back(found ? all.size() : none);
    if (found)
      all.push_back(*found);
  }

  template class Interfaces<2>;
  template class Interfaces<3>;
} // namespace Stroma::Mpm
