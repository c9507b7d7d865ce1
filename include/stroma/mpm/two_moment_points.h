#pragma once

#include <stroma/mpm/points.h>
#include <stroma/solid/moments.h>

#include <vector>

namespace Stroma::Mpm
{
  /// Moments of each material's points in a cell, about its centre [m].
  template <int dim>
  std::vector<Solid::Moments<dim>> cell_moments(const Points<dim> &points, const ActiveCell<dim> &active,
                                                const dealii::Tensor<1, dim> &size, unsigned int n_materials);

  /**
   * Points that stand for those of a cell where these only serve as its quadrature: of each material with more than 2^dim points
   * there, 2^dim points of equal volume with the same moments up to the second order,
   *   x = c + L s,     L L^T = C,     s = (+-1, ..., +-1),
   * with the centroid c, the covariance C and its Cholesky factor L. A full cell gets its Gauss points. Stiffness and
   * forces of linear scenes with bilinear functions in 2D are those of all points to round-off, since they integrate
   * polynomials of second order.
   */
  template <int dim>
  class TwoMomentPoints
  {
  public:
    struct Part
    {
      unsigned int material, begin, end; ///< in the arrays below
      unsigned int n_points;             ///< for which these stand
    };

    void clear();

    /// For the next active cell, from the moments of each material's points there; its @p size in [m].
    void add_cell(const Points<dim> &points, const ActiveCell<dim> &active,
                  const std::vector<Solid::Moments<dim>> &moments, const dealii::Tensor<1, dim> &size);

    /// After the last cell: empty if nowhere fewer points stand for those that are kept.
    void finish(const Points<dim> &points);

    bool
    empty() const
    {
      return first_part.empty();
    }

    /// Calls visit(part) for the materials of the active cell @p number.
    template <typename Visit>
    void
    for_parts(const unsigned int number, const Visit &visit) const
    {
      for (unsigned int i = first_part[number]; i < first_part[number + 1]; ++i)
        visit(parts[i]);
    }

    std::vector<dealii::Point<dim>> xi; ///< in the unit cell
    std::vector<double>             V;  ///< [m^3]

  private:
    void add_points_of(const Points<dim> &points, const ActiveCell<dim> &active, unsigned int material);
    void add_standing_for(const Solid::Moments<dim> &moments, const dealii::Tensor<1, dim> &size);

    bool                      any_fewer = false;
    std::vector<Part>         parts;
    std::vector<unsigned int> first_part; ///< by the number of the active cell, and the end
  };
} // namespace Stroma::Mpm
