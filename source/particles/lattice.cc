#include <stroma/base/mixed_bits.h>
#include <stroma/base/text.h>
#include <stroma/particles/lattice.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Particles
{
  namespace
  {
    constexpr double most_sites = 1e10;

    /// Distance of rows (axis 1) and layers (axis 2) over that of neighbours.
    double
    row_distance(const bool hexagonal, const unsigned int axis)
    {
      return !hexagonal || axis == 0 ? 1. : axis == 1 ? std::sqrt(3.) / 2. : std::sqrt(2. / 3.);
    }
  } // namespace

  template <int dim>
  std::uint64_t
  IndexBlock<dim>::size() const
  {
    std::uint64_t product = 1;
    for (const auto along_axis : n)
      product *= along_axis;
    return product;
  }

  template <int dim>
  std::array<int, dim>
  IndexBlock<dim>::at(std::uint64_t i) const
  {
    std::array<int, dim> index;
    for (unsigned int d = 0; d < dim; ++d)
      {
        index[d] = first[d] + static_cast<int>(i % n[d]);
        i /= n[d];
      }
    return index;
  }

  template <int dim>
  Lattice<dim>::Lattice(const dealii::BoundingBox<dim> &box, const double wanted, const bool hexagonal,
                        const std::array<bool, dim> &periodic, const std::string &where)
    : lower(box.get_boundary_points().first)
    , upper(box.get_boundary_points().second)
    , hexagonal(hexagonal)
  {
    if (box.volume() > most_sites * std::pow(wanted, dim))
      throw UserError(where, "a spacing of " + brief(wanted) + " m makes more than " + brief(most_sites) +
                               " particles; use a larger 'Spacing'");
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double rows = box.side_length(d) / (wanted * row_distance(hexagonal, d));
        const bool   even = hexagonal && d > 0 && periodic[d];
        n[d]              = static_cast<unsigned int>(even ? 2. * std::round(rows / 2.) : std::round(rows));
        if (n[d] == 0 || std::abs(rows / n[d] - 1.) > .25)
          throw UserError(where, "particles " + brief(wanted) + " m apart do not fit bodies that are " +
                                   brief(box.side_length(d)) + " m long along " + "xyz"[d] + ": " + brief(rows) +
                                   (even ? " rows, to be made even," : " rows") +
                                   " would have to move by more than 25 % of their distance; change 'Spacing'");
        spacing[d] = box.side_length(d) / n[d];
      }
  }

  template <int dim>
  dealii::Point<dim>
  Lattice<dim>::site(const std::array<int, dim> &index) const
  {
    dealii::Point<dim> X;
    for (unsigned int d = 0; d < dim; ++d)
      X[d] = index[d] + .5;
    if (hexagonal)
      {
        const int layer = index[dim - 1] * (dim - 2);
        X[0] += ((index[1] + layer) & 1) == 1 ? .25 : -.25;
        if (dim == 3)
          X[1] += (layer & 1) == 1 ? 1. / 6. : -1. / 6.;
      }
    for (unsigned int d = 0; d < dim; ++d)
      X[d] = lower[d] + X[d] * spacing[d];
    return X;
  }

  template <int dim>
  double
  Lattice<dim>::site_volume() const
  {
    double product = 1.;
    for (unsigned int d = 0; d < dim; ++d)
      product *= spacing[d];
    return product;
  }

  template <int dim>
  IndexBlock<dim>
  Lattice<dim>::inside() const
  {
    IndexBlock<dim> block;
    for (unsigned int d = 0; d < dim; ++d)
      block.n[d] = n[d];
    return block;
  }

  template <int dim>
  bool
  Lattice<dim>::is_inside(const dealii::Point<dim> &X) const
  {
    for (unsigned int d = 0; d < dim; ++d)
      if (X[d] < lower[d] || X[d] > upper[d])
        return false;
    return true;
  }

  /// The image of @p X across periodic faces of @p box that @p body takes up, if there is one.
  template <int dim>
  static std::optional<dealii::Point<dim>>
  image_in(const Body<dim> &body, const dealii::BoundingBox<dim> &box, const std::array<bool, dim> &periodic,
           const dealii::Point<dim> &X)
  {
    const auto      around = body.bounding_box();
    IndexBlock<dim> periods;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double period = box.side_length(d);
        periods.n[d]        = 1;
        if (!periodic[d])
          continue;
        periods.first[d] = static_cast<int>(std::ceil((around.lower_bound(d) - X[d]) / period - 1e-9));
        const int last   = static_cast<int>(std::floor((around.upper_bound(d) - X[d]) / period + 1e-9));
        periods.n[d]     = std::max(last - periods.first[d] + 1, 0);
      }
    for (std::uint64_t i = 0; i < periods.size(); ++i)
      {
        auto image = X;
        for (unsigned int d = 0; d < dim; ++d)
          image[d] += periods.at(i)[d] * box.side_length(d);
        if (body.contains(image))
          return image;
      }
    return std::nullopt;
  }

  template <int dim>
  int
  body_at(const Scene<dim> &scene, const dealii::Point<dim> &X, dealii::Point<dim> *place)
  {
    const bool goes_on = !scene.rigid_bodies.empty() &&
                         std::find(scene.periodic.begin(), scene.periodic.end(), true) != scene.periodic.end();
    const auto box = goes_on ? scene.bounding_box() : dealii::BoundingBox<dim>();
    for (int b = static_cast<int>(scene.bodies.size()) - 1; b >= 0; --b)
      {
        const auto &body  = scene.bodies[b];
        const auto  image = body.contains(X)      ? std::optional<dealii::Point<dim>>(X) :
                            goes_on && body.rigid ? image_in<dim>(body, box, scene.periodic, X) :
                                                    std::nullopt;
        if (image && place)
          *place = *image;
        if (image)
          return b;
      }
    return -1;
  }

  template <int dim>
  std::optional<unsigned int>
  material_at(const Scene<dim> &scene, const dealii::Point<dim> &X)
  {
    const int b = body_at(scene, X);
    return b < 0 ? std::nullopt : scene.bodies[b].material_at(X);
  }

  double
  uniform(const std::uint64_t seed, const std::uint64_t id, const unsigned int axis)
  {
    return (mixed_bits(mixed_bits(mixed_bits(seed) ^ id) ^ axis) >> 11) * 0x1p-53;
  }

  template struct IndexBlock<2>;
  template struct IndexBlock<3>;
  template class Lattice<2>;
  template class Lattice<3>;
  template int                         body_at(const Scene<2> &, const dealii::Point<2> &, dealii::Point<2> *);
  template int                         body_at(const Scene<3> &, const dealii::Point<3> &, dealii::Point<3> *);
  template std::optional<unsigned int> material_at(const Scene<2> &, const dealii::Point<2> &);
  template std::optional<unsigned int> material_at(const Scene<3> &, const dealii::Point<3> &);
} // namespace Stroma::Particles
