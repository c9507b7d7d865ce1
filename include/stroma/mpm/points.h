#pragma once

#include <stroma/grid/background_grid.h>
#include <stroma/mpm/layout.h>
#include <stroma/mpm/voxel_lattice.h>

#include <deal.II/particles/particle_handler.h>

#include <functional>
#include <limits>
#include <memory>

namespace Stroma::Mpm
{
  /**
   * The material points of an MPM scene: a deal.II ParticleHandler whose points carry exactly the numbers that the
   * scene needs.
   *
   * The handler's location of a point is its place at the last grid reset (its undeformed place if there was none).
   *
   * Where nothing is kept of points from step to step (Settings::finds_points_in_images) there are none: they are found in
   * the image whenever they are asked for, and a voxel takes up its byte there.
   */
  template <int dim>
  class Points
  {
  public:
    using Handler  = dealii::Particles::ParticleHandler<dim>;
    using Accessor = dealii::Particles::ParticleAccessor<dim>;

    /// Declares the fields that this scene needs and makes the points. Their volumes add up to that of each body. Collective.
    /// Throws UserError if a body or a material of it gets none.
    Points(const Scene<dim> &scene, const Settings<dim> &settings, BackgroundGrid<dim> &grid, bool has_driven_points);

    /// For a resumed run: the same layout without any point.
    struct WithoutPoints
    {
    };
    Points(WithoutPoints, const Scene<dim> &scene, const Settings<dim> &settings, BackgroundGrid<dim> &grid,
           bool has_driven_points);

    Handler handler;
    Layout  layout;

    FieldHandle volume;            ///< initial volume V0 [m^3], of all points that are kept
    FieldHandle material;          ///< index of the material, if the scene has several
    FieldHandle deformation;       ///< F at the last rebase, if the scene is ever rebased
    FieldHandle displacement;      ///< displacement at the last rebase [m], if the scene is ever rebased
    FieldHandle velocity_gradient; ///< at the last rebase [1/s], if the scene is viscous and ever rebased
    FieldHandle sides;   ///< undeformed edges of the box that a point stands for [m], if the grid is ever reset
    FieldHandle weight;  ///< in sums over its cell, then; see set_weights()
    FieldHandle history; ///< what laws remember, if some do
    FieldHandle support; ///< bit s is set if support s drives the point; stored if points are driven
    FieldHandle load;    ///< bit l is set if load l acts on the point; stored if points may be halved

    /// By active cell, direction and node, what the gradients of the shape functions take at its points [1/m], see set_weights();
    /// empty as long as the grid was not reset.
    std::vector<double> gradient_shift;

    /// Whether no point is kept, and the handler is empty.
    bool
    are_found_in_images() const
    {
      return !images.empty();
    }

    /// Calls visit(place in the unit cell, place [m], material, initial volume [m^3]) for the points of a cell.
    template <typename Visit>
    void for_points_of(const ActiveCell<dim> &active, const Visit &visit) const;

    /// Of points found in images: calls visit(place in the unit cell, edges of the box that it stands for [m], material, volume [m^3]).
    template <typename Visit>
    void for_boxes_of(const ActiveCell<dim> &active, const Visit &visit) const;

    /// Points of this rank.
    std::size_t
    n_owned() const
    {
      return are_found_in_images() ? n_in_images : handler.n_locally_owned_particles();
    }
    /// Points of all ranks. Collective.
    unsigned long long n_global() const;

    unsigned int
    material_of(const double *values) const
    {
      return material.stored() ? static_cast<unsigned int>(values[material.first]) : 0;
    }

    /// Whether bit @p k of the number in @p marks (support or load) is set.
    static bool
    is_marked(const double *values, const FieldHandle &marks, const unsigned int k)
    {
      return static_cast<unsigned long long>(values[marks.first]) >> k & 1;
    }

    /// Deformation gradient at the last rebase, where it is kept.
    dealii::Tensor<2, dim>
    deformation_of(const double *values) const
    {
      dealii::Tensor<2, dim> F;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int k = 0; k < dim; ++k)
          F[i][k] = values[deformation.first + i * dim + k];
      return F;
    }

    /// Initial volume without the depth of a plane scene [m^dim].
    double
    undeformed_size(const double *values) const
    {
      return values[volume.first] / depth;
    }

    /// Where a point was before anything moved [m].
    dealii::Point<dim>
    initial_place(const dealii::Point<dim> &location, const double *values) const
    {
      dealii::Point<dim> X = location;
      if (displacement.stored() && grid_resets)
        for (unsigned int d = 0; d < dim; ++d)
          X[d] -= values[displacement.first + d];
      return X;
    }

    /// Puts every point into the cell of the grid, on whatever rank, that owns its location. All of them must lie on the
    /// grid. Collective.
    void move_to_their_cells();

    /// Halves points whose boxes were stretched beyond what lets every cell have two of them along each axis. They stand at
    /// their new places then, in the cells that they come from.
    /// @p inner_marks(axis, upper) are the marks of supports that only the other half of a point keeps, where it is halved along an
    /// axis: of the side that only that one touches.
    using InnerMarks = std::function<std::uint64_t(unsigned int axis, bool upper)>;
    void split_stretched(const InnerMarks &inner_marks);

    /// Ids that were given out at the start; those of halved points follow.
    unsigned long long
    n_first_ids() const
    {
      return next_id;
    }
    void
    set_first_ids(const unsigned long long n)
    {
      next_id = n;
    }

    /// Id of the point that was nearest to @p X before anything moved: the one with the smallest id among those that are
    /// equally near up to a millionth of a cell. Collective.
    dealii::types::particle_index nearest(const dealii::Point<dim> &X) const;

    static constexpr auto nobody = std::numeric_limits<dealii::types::particle_index>::max(); ///< no point's id

    /// Which owned cells hold points, by active_cell_index.
    std::vector<bool> occupied_cells() const;

    /// Bytes of the handler and of the fields for one point, or of its voxel.
    double bytes_per_point() const;

    /// Numbers of a point that starts undeformed.
    std::vector<double> initial_values(double V0, unsigned int material_index) const;
    /// Sets the edges of the box that a point at @p X stands for, which lies between @p lower and @p upper.
    void set_sides(std::vector<double> &values, const dealii::Point<dim> &X, const dealii::Point<dim> &lower,
                   const dealii::Point<dim> &upper) const;

  private:
    void declare_fields(const Scene<dim> &scene, const Settings<dim> &settings, bool has_driven_points);
    /// Volume of one body, without the depth of a plane scene [m^dim].
    struct Filling
    {
      double whole   = 0; ///< whatever covers it
      double visible = 0; ///< without what later bodies cover
      double held    = 0; ///< by points: without slivers
    };

    Filling seed_voxels(const Scene<dim> &scene, unsigned int body, const Settings<dim> &settings);
    Filling seed_shape(const Scene<dim> &scene, unsigned int body, const Settings<dim> &settings);
    void    fill_exactly(const Scene<dim> &scene, unsigned int body, Filling filling, unsigned long long first_id);
    void    find_in_images(const Scene<dim> &scene, const Settings<dim> &settings);
    std::vector<std::size_t> count_by_material(const Scene<dim> &scene, unsigned long long first_id) const;
    void check_filled(const Scene<dim> &scene, unsigned int body, const std::vector<std::size_t> &n_points) const;

    static dealii::Point<dim> unit_place(const dealii::Point<dim> &X, const dealii::Point<dim> &corner,
                                         const dealii::Tensor<1, dim> &size);

    BackgroundGrid<dim> &grid;
    bool                 grid_resets = false;
    double               depth       = 1.; ///< thickness of a plane scene [m]
    unsigned long long   next_id     = 0;

    std::vector<VoxelLattice<dim>> images;          ///< of each body, if no point is kept
    std::vector<bool>              occupied;        ///< then, by active_cell_index
    std::size_t                    n_in_images = 0; ///< then, of this rank
  };

  template <int dim>
  inline dealii::Point<dim>
  Points<dim>::unit_place(const dealii::Point<dim> &X, const dealii::Point<dim> &corner,
                          const dealii::Tensor<1, dim> &size)
  {
    dealii::Point<dim> xi;
    for (unsigned int d = 0; d < dim; ++d)
      xi[d] = (X[d] - corner[d]) / size[d];
    return xi;
  }

  template <int dim>
  template <typename Visit>
  void
  Points<dim>::for_points_of(const ActiveCell<dim> &active, const Visit &visit) const
  {
    const dealii::Point<dim> corner = active.cell->vertex(0);
    for (const auto &image : images)
      image.for_points_of_cell(active.index,
                               [&](const dealii::Point<dim> &X, const std::size_t, const unsigned int m,
                                   const double V0) { visit(unit_place(X, corner, grid.box().cell_size), X, m, V0); });
    if (!are_found_in_images())
      for (const auto &point : handler.particles_in_cell(active.cell))
        {
          const auto values = point.get_properties();
          visit(point.get_reference_location(), point.get_location(), material_of(values.data()), values[volume.first]);
        }
  }

  template <int dim>
  template <typename Visit>
  void
  Points<dim>::for_boxes_of(const ActiveCell<dim> &active, const Visit &visit) const
  {
    const dealii::Point<dim> corner = active.cell->vertex(0);
    const auto              &size   = grid.box().cell_size;
    for (const auto &image : images)
      image.for_points_of_cell(active.index, [&](const dealii::Point<dim> &X, const std::size_t, const unsigned int m,
                                                 const double V0) {
        const auto part = image.part_of_cell(X, corner, size);
        visit(unit_place(X, corner, size), part.second - part.first, m, V0);
      });
  }
} // namespace Stroma::Mpm
