#pragma once

#include <stroma/particles/mover.h>
#include <stroma/particles/wall_integrals.h>
#include <stroma/rigid/pose.h>

#include <cstdint>
#include <unordered_map>

namespace Stroma::Particles
{
  /**
   * The surfaces of held sides and rigid bodies as flat facets, and what places nearby see of them: by WallIntegrals, part by
   * part. A part is what is nearly flat of one wall as seen from one place: the facets whose normals lie within about 45
   * degrees, so that a curved body near which particles are small is one, and a corner is two or three.
   *
   * Facets that another wall, or the body's own image across a periodic face, covers at the start are left out: those of a body
   * that stands on a held side, of the side below it, and beyond held sides.
   */
  template <int dim>
  class WallFacets
  {
  public:
    /// @param spacing of particles: curved surfaces deviate by less than .005 of it from their facets [m]
    /// @param h smoothing length [m]
    /// @param bonded_to_all whether sides and bodies are bonded to the material; else there are only bodies, from wherever they come
    /// Throws UserError where the surface of a rigid body is not that of its shape, or so far off a solid that it would not see it, or meets its own image.
    WallFacets(const Scene<dim> &scene, const std::vector<Mover<dim>> &movers, KernelName kernel, double h,
               double spacing, bool bonded_to_all = true);

    /// Where the walls are at time @p t. @param poses by mover; of a side, its translation.
    void update(double t, const std::vector<Rigid::Pose<dim>> &poses);

    /// Of a wall, as seen from a place x in space.
    struct Part
    {
      unsigned int           mover;
      dealii::Point<dim>     X;        ///< mean place on it, weighted with the kernel, undeformed [m]
      dealii::Tensor<1, dim> to;       ///< from x to where that is now [m]
      dealii::Tensor<1, dim> gradient; ///< part of grad gamma, into the material [1/m]
      double                 missing;  ///< part of 1 - gamma
      bool                   flat;     ///< whether it has one normal
    };

    /// Adds the parts that @p x sees to @p parts; returns 1 - gamma. Local.
    double look(const dealii::Point<dim> &x, std::vector<Part> &parts) const;

    /// Distance of the place @p X on a wall from a solid at the start [m]. Of a fluid: 0.
    double clearance(const dealii::Point<dim> &X) const;

  private:
    using Facet = typename WallIntegrals<dim>::Facet;
    using Cell  = std::array<int, dim>;

    /// The facets of a mover, and which of them are near a place.
    struct Surface
    {
      std::vector<Facet>       at_start;
      std::vector<Facet>       facets; ///< in the mover's frame: of what it was at the start
      dealii::BoundingBox<dim> box;    ///< of places that see some
      std::unordered_map<std::uint64_t, std::vector<unsigned int>> near; ///< by cell
    };

    /// What belongs to one part.
    struct Sum
    {
      dealii::Point<dim>     x; ///< from where it is seen, in the mover's frame, and across which periodic face
      dealii::Tensor<1, dim> gradient, place; ///< place: relative to x, times weight
      double                 weight = 0.;
    };

    std::vector<Facet> facets_of(const Mover<dim> &mover) const;
    std::vector<Facet> uncovered(const std::vector<Facet> &facets, unsigned int m) const;
    bool is_covered(const dealii::Point<dim> &X, const dealii::Tensor<1, dim> &normal, unsigned int m) const;
    void require_near(const Surface &surface, const Rigid::Body<dim> &rigid) const;
    void require_no_wider_than_period(const Rigid::Body<dim> &rigid) const;
    void lay_cells(Surface &surface) const;
    bool deforms(unsigned int m) const;
    dealii::Point<dim>    beside(dealii::Point<dim> x, const dealii::Point<dim> &centre) const;
    Cell                  cell_of(const dealii::Point<dim> &x) const;
    static std::uint64_t  key_of(const Cell &cell);
    std::array<double, 2> add_facets(const Surface &surface, const dealii::Point<dim> &x, std::vector<Sum> &front,
                                     std::vector<Sum> &back) const;
    Part                  part_of(unsigned int m, const Sum &sum) const;

    const Scene<dim>              &scene;
    const std::vector<Mover<dim>> &movers;
    const WallIntegrals<dim>       integrals;
    const double                   spacing, reach;
    std::vector<dealii::Tensor<1, dim>>
      images; ///< by which a place is shifted to see what lies across periodic faces [m]

    double                              now = 0.;
    std::vector<Rigid::Pose<dim>>       poses;
    std::vector<dealii::Tensor<2, dim>> rotations;
    std::vector<Surface>                surfaces; ///< by mover
  };
} // namespace Stroma::Particles
