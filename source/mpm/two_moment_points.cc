#include <stroma/base/power.h>
#include <stroma/mpm/two_moment_points.h>

#include <cmath>

namespace Stroma::Mpm
{
  namespace
  {
    /// Where cells cut voxels differently kinds would be as many as cells.
    constexpr unsigned int most_kinds = 256;

    /// L of C = L L^T, lower triangular; zero columns where points do not spread.
    template <int dim>
    dealii::Tensor<2, dim>
    cholesky_factor(const dealii::SymmetricTensor<2, dim> &C)
    {
      dealii::Tensor<2, dim> L;
      for (unsigned int j = 0; j < dim; ++j)
        for (unsigned int i = j; i < dim; ++i)
          {
            double rest = C[i][j];
            for (unsigned int k = 0; k < j; ++k)
              rest -= L[i][k] * L[j][k];
            if (i == j)
              L[j][j] = rest > 1e-14 * C[j][j] ? std::sqrt(rest) : 0.;
            else
              L[i][j] = L[j][j] > 0. ? rest / L[j][j] : 0.;
          }
      return L;
    }

    template <int dim>
    double
    volume_of(const dealii::Tensor<1, dim> &size)
    {
      double volume = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        volume *= size[d];
      return volume;
    }

    /// Whether 2^dim points can have the same moments as these.
    template <int dim>
    bool
    can_be_stood_for(const Solid::Moments<dim> &moments, const bool whole_voxels)
    {
      return whole_voxels || moments.n_points() >= power(2, dim);
    }

    /// Whether the points of a cell with linear shape functions do, from their moments: not if they are few, or in a plane.
    template <int dim>
    bool
    resist_all_shapes(const std::vector<Solid::Moments<dim>> &of_material, const dealii::Tensor<1, dim> &size)
    {
      constexpr double    flat = 1e-14; // round-off of what is in a plane
      Solid::Moments<dim> all;
      for (const auto &moments : of_material)
        all.add(moments);
      return can_be_stood_for(all, false) && determinant(all.covariance()) > flat * volume_of(size) * volume_of(size);
    }
  } // namespace

  template <int dim>
  MaterialMoments<dim>
  cell_moments(const Points<dim> &points, const ActiveCell<dim> &active, const dealii::Tensor<1, dim> &size,
               const unsigned int n_materials, const bool whole_voxels)
  {
    MaterialMoments<dim>   found{std::vector<Solid::Moments<dim>>(n_materials), whole_voxels};
    dealii::Tensor<1, dim> x;
    const auto             find_place = [&](const dealii::Point<dim> &xi) {
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = (xi[d] - .5) * size[d];
    };
    if (!whole_voxels)
      {
        points.for_points_of(active,
                             [&](const dealii::Point<dim> &xi, const auto &, const unsigned int m, const double V) {
                               find_place(xi);
                               found.of_material[m].add(V, x);
                             });
        found.whole_voxels = points.are_found_in_images() && !resist_all_shapes(found.of_material, size);
        if (!found.whole_voxels)
          return found;
        found.of_material.assign(n_materials, Solid::Moments<dim>());
      }
    points.for_boxes_of(active, [&](const dealii::Point<dim> &xi, const dealii::Tensor<1, dim> &edges,
                                    const unsigned int m, const double V) {
      find_place(xi);
      found.of_material[m].add_box(V, x, edges);
    });
    return found;
  }

  template <int dim>
  typename TwoMomentPoints<dim>::Fingerprint
  TwoMomentPoints<dim>::fingerprint(const unsigned int material, const Solid::Moments<dim> &moments,
                                    const dealii::Tensor<1, dim> &size)
  {
    const double volume = volume_of(size);
    const auto   digits = [](const double share) { return std::llround(1e9 * share); };
    const auto   c      = moments.centroid();
    const auto   C      = moments.covariance();
    Fingerprint  print  = {material, moments.n_points(), digits(moments.volume() / volume)};
    for (unsigned int i = 0; i < dim; ++i)
      {
        print.push_back(digits(c[i] / size[i]));
        for (unsigned int j = 0; j <= i; ++j)
          print.push_back(digits(C[i][j] / (size[i] * size[j])));
      }
    return print;
  }

  template <int dim>
  void
  TwoMomentPoints<dim>::add_points_of(const Points<dim> &points, const ActiveCell<dim> &active,
                                      const unsigned int material)
  {
    points.for_points_of(active, [&](const auto &place, const auto &, const unsigned int m, const double volume) {
      if (m != material)
        return;
      xi.push_back(place);
      V.push_back(volume);
    });
  }

  template <int dim>
  void
  TwoMomentPoints<dim>::add_standing_for(const Solid::Moments<dim> &moments, const dealii::Tensor<1, dim> &size)
  {
    constexpr unsigned int n = power(2, dim);
    const auto             c = moments.centroid();
    const auto             L = cholesky_factor<dim>(moments.covariance());
    for (unsigned int corner = 0; corner < n; ++corner)
      {
        dealii::Tensor<1, dim> s;
        for (unsigned int d = 0; d < dim; ++d)
          s[d] = corner >> d & 1 ? 1. : -1.;
        const auto         x = c + L * s;
        dealii::Point<dim> place;
        for (unsigned int d = 0; d < dim; ++d)
          place[d] = .5 + x[d] / size[d];
        xi.push_back(place);
        V.push_back(moments.volume() / n);
      }
  }

  template <int dim>
  void
  TwoMomentPoints<dim>::clear()
  {
    *this = TwoMomentPoints();
  }

  template <int dim>
  void
  TwoMomentPoints<dim>::add_cell(const Points<dim> &points, const ActiveCell<dim> &active,
                                 const MaterialMoments<dim> &moments, const dealii::Tensor<1, dim> &size)
  {
    const auto  &of_material = moments.of_material;
    Cell         cell{static_cast<unsigned int>(parts.size()), 0, no_kind};
    unsigned int filled_by = 0;
    for (unsigned int m = 0; m < of_material.size(); ++m)
      if (of_material[m].n_points() > 0)
        {
          ++cell.n_parts;
          filled_by = m;
        }
    if (cell.n_parts == 1 && can_be_stood_for(of_material[filled_by], moments.whole_voxels))
      {
        const auto print = fingerprint(filled_by, of_material[filled_by], size);
        const auto known = kinds.find(print);
        if (known != kinds.end())
          {
            cells.push_back({first_of_kind[known->second], 1, known->second});
            return;
          }
        if (kinds.size() < most_kinds)
          {
            cell.kind = kinds.size();
            kinds.emplace(print, cell.kind);
            first_of_kind.push_back(cell.first);
          }
      }
    for (unsigned int m = 0; m < of_material.size(); ++m)
      if (of_material[m].n_points() > 0)
        add_part(points, active, m, of_material[m], size, moments.whole_voxels);
    cells.push_back(cell);
  }

  template <int dim>
  void
  TwoMomentPoints<dim>::add_part(const Points<dim> &points, const ActiveCell<dim> &active, const unsigned int material,
                                 const Solid::Moments<dim> &moments, const dealii::Tensor<1, dim> &size,
                                 const bool whole_voxels)
  {
    const unsigned int begin = xi.size();
    const bool         stand = can_be_stood_for(moments, whole_voxels);
    if (stand)
      add_standing_for(moments, size);
    else
      add_points_of(points, active, material);
    any_stand |= stand;
    parts.push_back({material, begin, static_cast<unsigned int>(xi.size()), moments.n_points()});
  }

  template <int dim>
  void
  TwoMomentPoints<dim>::finish(const Points<dim> &points)
  {
    if (!any_stand && !points.are_found_in_images()) // the points themselves will do
      clear();
  }

  template MaterialMoments<2> cell_moments(const Points<2> &, const ActiveCell<2> &, const dealii::Tensor<1, 2> &,
                                           unsigned int, bool);
  template MaterialMoments<3> cell_moments(const Points<3> &, const ActiveCell<3> &, const dealii::Tensor<1, 3> &,
                                           unsigned int, bool);
  template class TwoMomentPoints<2>;
  template class TwoMomentPoints<3>;
} // namespace Stroma::Mpm
