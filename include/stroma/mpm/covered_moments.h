#pragma once

#include <stroma/base/power.h>
#include <stroma/mpm/points.h>

#include <Eigen/Core>

#include <map>
#include <unordered_map>

namespace Stroma::Mpm
{
  /// Of the products of powers 0, 1 and 2 of the coordinates in the unit cell, from its centre; those of x fastest.
  template <int dim>
  using CellMoments = Eigen::Matrix<double, power(3, dim), 1>;

  /// Means of the products over an upright box about @p middle with sides @p size, both in cells, from the cell's centre.
  template <int dim>
  CellMoments<dim> mean_products(const dealii::Point<dim> &middle, const dealii::Tensor<1, dim> &size);

  /**
   * What the points cover of each cell [m^dim times the products] when each stands for the box that it has become, a parallelogram of
   * edges F^r s, in 2^dim parts, each taken for an upright box of its volume and cut by the cells' faces (as the particles of
   * GIMP, Bardenhagen & Kober 2004). Parts in cells without points count for the cell of their point.
   */
  template <int dim>
  class CoveredMoments
  {
  public:
    /// Of all points on the active cells of @p grid. Collective.
    CoveredMoments(const Points<dim> &points, const BackgroundGrid<dim> &grid);

    /// Of an owned cell. One within the bodies, all of whose neighbours hold points, is full: boxes that nearly fill it, by 2 %,
    /// count for all of it, and from 6 % on for what they are. Boxes leave gaps and overlap where the gradient varies; uniform stress
    /// would pull there, a stretched soft material would follow, and what it does would grow from reset to reset.
    CellMoments<dim> of(const ActiveCell<dim> &active);

  private:
    using Index = std::array<int, dim>;

    struct PointBox;
    void              add(const PointBox &box, const dealii::Point<dim> &x, std::uint64_t own);
    void              add_upright(const dealii::Point<dim> &centre, const dealii::Tensor<1, dim> &size, double volume,
                                  std::uint64_t own);
    void              exchange();
    CellMoments<dim> &sum_of(std::uint64_t number);
    std::optional<std::uint64_t> number_of(const Index &index) const;
    Index                        index_of(std::uint64_t number) const;
    bool                         is_inner(std::uint64_t number) const;

    const BackgroundGrid<dim>                      &grid;
    std::unordered_map<std::uint64_t, unsigned int> known; ///< owners of cells with points, owned and ghost ones
    std::map<std::uint64_t, CellMoments<dim>>       sums;
  };
} // namespace Stroma::Mpm
