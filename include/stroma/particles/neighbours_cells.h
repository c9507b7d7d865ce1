#pragma once

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/point.h>

#include <array>
#include <cstdint>
#include <vector>

namespace Stroma::Particles
{
  /// Equal cells in which neighbours are looked for, and the ranks that own them: each a run of cells along a Morton
  /// curve.
  template <int dim>
  class Cells
  {
  public:
    using Coordinates = std::array<int, dim>;

    /// Covers the @p places of all ranks by cells not narrower than @p smallest [m], at most a few for each place. Along
    /// periodic directions all of the @p domain, by at least two. Collective.
    void lay(const std::vector<dealii::Point<dim>> &places, double smallest, const dealii::BoundingBox<dim> &domain,
             const std::array<bool, dim> &periodic, MPI_Comm comm);

    /// Gives each rank cells with about the same number of these @p places of all ranks. Collective.
    void divide(const std::vector<dealii::Point<dim>> &places, MPI_Comm comm);

    /// The nearest cell if @p x is outside.
    Coordinates
    coordinates(const dealii::Point<dim> &x) const
    {
      Coordinates c;
      for (unsigned int d = 0; d < dim; ++d)
        {
          const double t = (x[d] - lower[d]) * inverse_size[d];
          c[d]           = t >= n[d] ? n[d] - 1 : (t > 0. ? static_cast<int>(t) : 0);
        }
      return c;
    }

    unsigned int
    index(const Coordinates &c) const
    {
      unsigned int result = c[dim - 1];
      for (int d = dim - 2; d >= 0; --d)
        result = result * n[d] + c[d];
      return result;
    }

    unsigned int
    size() const
    {
      return static_cast<unsigned int>(position.size());
    }
    unsigned int
    position_of(const dealii::Point<dim> &x) const
    {
      return position[index(coordinates(x))];
    }
    int
    owner_of(const dealii::Point<dim> &x) const
    {
      return owner[index(coordinates(x))];
    }

    /// The smallest and largest coordinates of the cells of rank @p rank, which has some.
    std::array<Coordinates, 2> range_of(int rank) const;

    dealii::Point<dim>        lower; ///< [m]
    std::array<double, dim>   cell_size{}, inverse_size{};
    Coordinates               n{};            ///< numbers of cells
    std::vector<unsigned int> position;       ///< of each cell along the curve; x fastest
    std::vector<int>          owner;          ///< rank of each cell; x fastest
    std::vector<unsigned int> first_position; ///< of each rank along the curve, and the end

  private:
    void set_sizes(const dealii::BoundingBox<dim> &box, double smallest, const std::array<bool, dim> &periodic,
                   std::uint64_t n_places);
    void order_along_curve();

    std::vector<unsigned int> cell_at; ///< inverse of position
  };
} // namespace Stroma::Particles
