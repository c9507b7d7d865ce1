#pragma once

#include <stroma/scene/scene.h>

#include <functional>

namespace Stroma::Fem
{
  /**
   * What the scene's bodies put into a cell of a lattice. Edges of boxes and of voxels that go through the cell divide it into
   * parts, each of which one sample tells exactly; curved and oblique bodies are seen at the cell's centre, vertices and at
   * the place nearest to the body's centre.
   */
  template <int dim>
  class Fit
  {
  public:
    using Material = std::optional<unsigned int>; ///< index into the scene's materials, or nothing

    explicit Fit(const Scene<dim> &scene);

    /// The first material (or nothing) in @p cell that differs from that at its centre, if there is one.
    std::optional<Material> other_than_at_centre(const dealii::BoundingBox<dim> &cell) const;

    /// Share of @p cell that holds material: exact where boxes and images alone meet there, else of a fine lattice of samples.
    double filled_share(const dealii::BoundingBox<dim> &cell) const;

  private:
    using Visit = std::function<void(const dealii::Point<dim> &place, double share)>;

    /// Calls visit(centre, share of the cell) for each part of @p cell.
    void for_each_part(const dealii::BoundingBox<dim> &cell, const Visit &visit) const;
    /// Places in the cell at which bodies that are neither boxes nor images are seen.
    std::vector<dealii::Point<dim>> probes(const dealii::BoundingBox<dim> &cell) const;

    const Scene<dim>                    &scene;
    std::array<std::vector<double>, dim> edges;  ///< of boxes and voxels along each axis, in order [m]
    std::vector<const Body<dim> *>       others; ///< neither boxes nor images
  };
} // namespace Stroma::Fem
