#pragma once

#include <stroma/base/parameters.h>
#include <stroma/shapes/shape.h>
#include <stroma/shapes/stl.h>

#include <memory>

namespace Stroma::Shapes
{
  template <int dim>
  class FacetTree;

  /**
   * A shape whose surface is flat pieces: a polygon in the plane, a closed surface of triangles in space.
   *
   * The sign of the distance is that of (X - foot) . N, N the facet's normal, and where the foot is an edge or a corner the
   * sum of the normals that meet there, at corners weighted by the angles of the triangles (J. A. Baerentzen, H. Aanaes, IEEE
   * Trans. Vis. Comput. Graph. 11 (2005) 243: this N tells inside from outside wherever the surface is closed).
   */
  template <int dim>
  class Faceted : public Shape<dim>
  {
  public:
    using Corners = std::array<unsigned int, dim>; ///< of a facet, indices of vertices in the order of Facet

    /// A closed surface without a facet of no size: see make_polygon() and make_surface(). @param is_of_file see there
    Faceted(std::vector<dealii::Point<dim>> vertices, std::vector<Corners> facets, bool is_of_file = false);
    ~Faceted() override;

    Nearest<dim>             nearest(const dealii::Point<dim> &X) const override;
    bool                     contains(const dealii::Point<dim> &X) const override;
    dealii::BoundingBox<dim> bounding_box() const override;
    Moments<dim>             moments() const override;
    std::vector<Facet<dim>>  facets(double size) const override;

    const std::vector<dealii::Point<dim>> vertices; ///< [m]; of a polygon in order
    const std::vector<Corners>            corners;  ///< of the facets
    const bool
      is_of_file; ///< whether its places come from a file of their own, which may have another unit than the scene

  private:
    Facet<dim>             facet(const Corners &corners) const;
    dealii::Tensor<1, dim> pseudo_normal(unsigned int f, const std::array<double, dim> &weights) const;
    void                   find_normals();
    void                   find_moments();

    const dealii::BoundingBox<dim>        box;
    const double                          grain; ///< length that is round-off [m]
    std::unique_ptr<const FacetTree<dim>> tree;
    std::vector<dealii::Tensor<1, dim>>   normals;        ///< of the facets
    std::vector<dealii::Tensor<1, dim>>   vertex_normals; ///< N of the vertices
    std::vector<std::array<dealii::Tensor<1, dim>, dim>>
                 edge_normals; ///< 3D: N of each triangle's edge across corner i
    Moments<dim> all;
  };

  using Polygon = Faceted<2>; ///< simple: its edges meet at its corners only
  using Surface = Faceted<3>;

  /// The polygon of these corners. Throws UserError, without a place, if they do not go round a simple one, anticlockwise.
  std::shared_ptr<const Polygon> make_polygon(const std::vector<dealii::Point<2>> &corners, bool is_of_file = false);
  /// Whether corners go round anticlockwise without a dent or a straight corner.
  bool is_convex(const std::vector<dealii::Point<2>> &corners);
  /// The body within triangles. Throws UserError, without a place, if they do not bound a volume on their inner side.
  std::shared_ptr<const Surface> make_surface(const Triangles &triangles);

  /// Declare and read the entries of shapes 'polygon', 'quadrilateral' (convex) and 'surface'.
  std::shared_ptr<const Shape<2>> read_polygon(Parameters &p, MPI_Comm comm);
  std::shared_ptr<const Shape<2>> read_quadrilateral(Parameters &p, MPI_Comm comm);
  std::shared_ptr<const Shape<3>> read_surface(Parameters &p, MPI_Comm comm);
} // namespace Stroma::Shapes
