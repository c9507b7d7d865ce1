#pragma once

#include <stroma/grid/lattice_level.h>
#include <stroma/mpm/points.h>
#include <stroma/solid/moments.h>

#include <map>
#include <vector>

namespace Stroma::Mpm
{
  /// Moments of each material in a cell, about its centre [m].
  template <int dim>
  struct MaterialMoments
  {
    std::vector<Solid::Moments<dim>> of_material;
    bool whole_voxels; ///< of boxes that points found in images stand for, instead of points
  };

  /// @param whole_voxels whether they shall be of boxes in any case. Else they are so where points found in images are fewer
  /// than 2^dim or in a plane: cells that a body cuts, whose points would not resist all their shapes.
  template <int dim>
  MaterialMoments<dim> cell_moments(const Points<dim> &points, const ActiveCell<dim> &active,
                                    const dealii::Tensor<1, dim> &size, unsigned int n_materials, bool whole_voxels);

  /**
   * Points that stand for those of a cell where these only serve as its quadrature: of each material with more than 2^dim points
   * there, 2^dim points of equal volume with the same moments up to the second order,
   *   x = c + L s,     L L^T = C,     s = (+-1, ..., +-1),
   * with the centroid c, the covariance C and its Cholesky factor L. A full cell gets its Gauss points. Stiffness and
   * forces of linear scenes with bilinear functions in 2D are those of all points to round-off, since they integrate
   * polynomials of second order. With the moments of whole voxels also fewer points have such.
   *
   * Cells that one material fills alike share their points: they are of one kind.
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

    /// For the next active cell, from the moments there; its @p size in [m].
    void add_cell(const Points<dim> &points, const ActiveCell<dim> &active, const MaterialMoments<dim> &moments,
                  const dealii::Tensor<1, dim> &size);

    /// After the last cell: empty if nowhere fewer points stand for those that are kept.
    void finish(const Points<dim> &points);

    bool
    empty() const
    {
      return cells.empty();
    }

    /// Of an active cell: a number from 0, or no_kind.
    unsigned int
    kind_of(const unsigned int number) const
    {
      return cells[number].kind;
    }
    unsigned int
    n_kinds() const
    {
      return kinds.size();
    }
    unsigned int
    material_of_kind(const unsigned int kind) const
    {
      return parts[first_of_kind[kind]].material;
    }
    static constexpr unsigned int no_kind = LatticeLevel<dim>::no_kind;

    /// Calls visit(part) for the materials of the active cell @p number.
    template <typename Visit>
    void
    for_parts(const unsigned int number, const Visit &visit) const
    {
      const Cell &cell = cells[number];
      for (unsigned int i = 0; i < cell.n_parts; ++i)
        visit(parts[cell.first + i]);
    }

    std::vector<dealii::Point<dim>> xi; ///< in the unit cell
    std::vector<double>             V;  ///< [m^3]

  private:
    struct Cell
    {
      unsigned int first, n_parts; ///< in parts
      unsigned int kind;
    };

    /// Material, number of points and moments, to nine digits.
    using Fingerprint = std::vector<long long>;

    static Fingerprint fingerprint(unsigned int material, const Solid::Moments<dim> &moments,
                                   const dealii::Tensor<1, dim> &size);
    void               add_part(const Points<dim> &points, const ActiveCell<dim> &active, unsigned int material,
                                const Solid::Moments<dim> &moments, const dealii::Tensor<1, dim> &size, bool whole_voxels);
    void               add_points_of(const Points<dim> &points, const ActiveCell<dim> &active, unsigned int material);
    void               add_standing_for(const Solid::Moments<dim> &moments, const dealii::Tensor<1, dim> &size);

    bool                                any_stand = false;
    std::vector<Part>                   parts;
    std::vector<Cell>                   cells; ///< by the number of the active cell
    std::map<Fingerprint, unsigned int> kinds;
    std::vector<unsigned int>           first_of_kind; ///< the part that its cells share
  };
} // namespace Stroma::Mpm
