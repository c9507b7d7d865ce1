#pragma once

#include <stroma/scene/scene.h>

#include <deal.II/base/bounding_box.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace Stroma::Particles
{
  /// Indices along each axis from `first` on, numbered with x fastest.
  template <int dim>
  struct IndexBlock
  {
    std::array<int, dim>           first{};
    std::array<std::uint64_t, dim> n{};

    std::uint64_t        size() const;
    std::array<int, dim> at(std::uint64_t i) const;
  };

  /**
   * Regular sites, square (cubic) or hexagonal, with a whole number of spacings along each axis of a box and continued
   * beyond it. The outermost sites inside the box lie half a spacing off its faces, in the mean over the rows.
   *
   * Hexagonal: rows along x, sqrt(3)/2 spacings apart, every other one shifted by half a spacing; in 3D layers of such
   * rows sqrt(2/3) spacings apart, of which every other one lies in the hollows of those below (hexagonal close
   * packing).
   */
  template <int dim>
  class Lattice
  {
  public:
    /// @param where place in the file of the spacing, for messages. Throws UserError if the distance of rows along an
    /// axis would change by more than 25 %. Where a hexagonal lattice repeats, its rows or layers are even in number.
    Lattice(const dealii::BoundingBox<dim> &box, double spacing, bool hexagonal, const std::array<bool, dim> &periodic,
            const std::string &where);

    dealii::Point<dim> site(const std::array<int, dim> &index) const;
    double             site_volume() const;
    IndexBlock<dim>    inside() const; ///< indices of the sites in the box
    bool               is_inside(const dealii::Point<dim> &X) const;

    dealii::Point<dim>            lower, upper; ///< of the box [m]
    std::array<unsigned int, dim> n;            ///< sites along each axis of the box
    dealii::Tensor<1, dim>        spacing;      ///< between the sites, rows and layers along each axis [m]

  private:
    bool hexagonal;
  };

  /// Index of the body that takes up @p X, the last one in the file; -1: none. Rigid bodies go on across periodic faces: @p place is
  /// set to the image of @p X that lies in the body as it is drawn.
  template <int dim>
  int body_at(const Scene<dim> &scene, const dealii::Point<dim> &X, dealii::Point<dim> *place = nullptr);

  /// Material that the body there has at @p X, if any.
  template <int dim>
  std::optional<unsigned int> material_at(const Scene<dim> &scene, const dealii::Point<dim> &X);

  /// A random number in [0, 1) that depends on nothing but its arguments (splitmix64, Steele et al. 2014).
  double uniform(std::uint64_t seed, std::uint64_t id, unsigned int axis);
} // namespace Stroma::Particles
