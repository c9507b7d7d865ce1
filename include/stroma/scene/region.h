#pragma once

#include <stroma/base/parameters.h>

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/point.h>

#include <string>
#include <vector>

namespace Stroma
{
  /// Names that a region may mention.
  struct SceneNames
  {
    std::vector<std::string> materials, bodies;
  };

  /**
   * Where a support or a load acts, in the undeformed scene, free of any method:
   *   side y-min             the side of the bodies' bounding box (a boundary)
   *   layer y-max 2          the material within this distance of a side
   *   box 0, 0, 0 : 1, 1, 1  the material between two corners
   *   ball 0, 0, 0 : .2      the material within a radius of a centre
   *   material vessel        everything made of a material
   *   nearest 1, 2, 3        the one material point or node that is nearest
   *   rim 0, 0 : .2          the part of the boundary at this distance from a centre
   *   body indenter          a rigid body
   *   all                    all material
   * Lengths are in the file's unit.
   */
  template <int dim>
  class Region
  {
  public:
    enum class Kind
    {
      side,
      layer,
      box,
      ball,
      material,
      nearest,
      rim,
      body,
      all
    };

    /// Declares and reads entry "Where".
    void add(Parameters &p, const SceneNames &names);

    /// Whether material of index @p material at @p X belongs; for kinds that select material.
    bool contains(const dealii::Point<dim> &X, unsigned int material, const dealii::BoundingBox<dim> &bodies) const;

    /// Whether @p X lies on the side, up to @p tolerance [m].
    bool on_side(const dealii::Point<dim> &X, const dealii::BoundingBox<dim> &bodies, double tolerance) const;

    /// Whether it is a part of the boundary (side, rim) that holds @p X, up to @p tolerance [m].
    bool on_boundary(const dealii::Point<dim> &X, const dealii::BoundingBox<dim> &bodies, double tolerance) const;

    /// Whether it is a part of the boundary, not a set of material.
    bool
    is_boundary() const
    {
      return kind == Kind::side || kind == Kind::rim;
    }

    /// A box round the material of a layer, box or ball, cut off at the bodies only where it does not end [m].
    dealii::BoundingBox<dim> bounds(const dealii::BoundingBox<dim> &bodies) const;

    /// The coordinate of the side or layer along its axis [m].
    double side_coordinate(const dealii::BoundingBox<dim> &bodies) const;

    Kind               kind   = Kind::all;
    unsigned int       axis   = 0;     ///< side, layer: normal direction
    bool               upper  = false; ///< side, layer: at the upper end of the axis
    double             extent = 0;     ///< layer: thickness; ball, rim: radius [m]
    dealii::Point<dim> first, second;  ///< box: corners; ball, rim: centre; nearest: place [m]
    unsigned int       material = 0;   ///< material: its index
    unsigned int       body     = 0;   ///< body: its index
    std::string        text;           ///< as written
  };
} // namespace Stroma
