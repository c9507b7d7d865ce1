#include <stroma/mpm/interfaces.h>
#include <stroma/mpm/two_moment_points.h>

namespace Stroma::Mpm
{
  template <int dim>
  void
  Interfaces<dim>::rebuild(const Points<dim> &points, const BackgroundGrid<dim> &grid,
                           const std::vector<const Materials::Material *> &laws)
  {
    all.clear();
    place.assign(grid.active_cells().size(), none);
    const auto size = grid.box().cell_size;
    for (const auto &active : grid.active_cells())
      if (const auto found = Solid::find_interface<dim>(cell_moments(points, active, size, laws.size()), laws, size))
        {
          place[active.number] = all.size();
          all.push_back(*found);
        }
  }

  template class Interfaces<2>;
  template class Interfaces<3>;
} // namespace Stroma::Mpm
