#pragma once

#include <stroma/solid/interface.h>

#include <vector>

namespace Stroma::Mpm
{
  /// The interfaces in those active cells that hold points of more than one material.
  template <int dim>
  class Interfaces
  {
  public:
    void clear();

    /// For the next active cell, from the moments of each material's points there; its @p size in [m].
    void add_cell(const std::vector<Solid::Moments<dim>> &moments, const std::vector<const Materials::Material *> &laws,
                  const dealii::Tensor<1, dim> &size);

    /// Of the active cell @p number; nothing if it has none.
    const Solid::Interface<dim> *
    of(const unsigned int number) const
    {
      return place.empty() || place[number] == none ? nullptr : &all[place[number]];
    }

  private:
    static constexpr unsigned int none = static_cast<unsigned int>(-1);

    std::vector<unsigned int>          place; ///< in all, by the number of the active cell
    std::vector<Solid::Interface<dim>> all;
  };
} // namespace Stroma::Mpm
