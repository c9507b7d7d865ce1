#pragma once

#include <stroma/grid/grid_box.h>
#include <stroma/grid/stencil.h>

#include <memory>
#include <string>
#include <vector>

namespace Stroma
{
  /**
   * The functions S_a that carry a field on the background grid. Along each axis a cell of index i has the k nodes i to
   * i + k - 1 of the lattice of nodes (x fastest in a cell), the same for all points in it.
   */
  template <int dim>
  class ShapeFunctions
  {
  public:
    using Index = std::array<unsigned int, dim>; ///< of a cell in the box, or of a node on the lattice

    /// Nodes of a cell, at most.
    static constexpr unsigned int most_nodes = dim == 2 ? 9 : 27;

    /// At one place: the numbers of the first n_nodes() are set.
    struct AtPlace
    {
      std::array<double, most_nodes>                  value;
      std::array<std::array<double, most_nodes>, dim> gradient; ///< [direction][node] [1/m]
    };

    ShapeFunctions(const GridBox<dim> &box, unsigned int per_axis);
    virtual ~ShapeFunctions() = default;

    /// Nodes of a cell.
    unsigned int
    n_nodes() const
    {
      return nodes_of_cell;
    }

    /// Nodes of the lattice along axis @p d.
    unsigned int
    lattice_size(const unsigned int d) const
    {
      return box.n_cells[d] + per_axis - 1;
    }

    /// Index of node @p a of a cell.
    Index node_index(const Index &cell, unsigned int a) const;

    /// Where a node lies: linear fields have their own values there as coefficients.
    dealii::Point<dim> place(const Index &node) const;

    /// A place and what the field's value there counts for.
    struct Sample
    {
      dealii::Point<dim> X;
      double             weight;
    };
    /// What makes a node's coefficient of a given field: exact to the order of the shape functions.
    std::vector<Sample> samples(const Index &node) const;

    /// Whether a field has at a node's place the node's value, so that a single node can hold it there.
    virtual bool interpolates() const = 0;

    /// All shape functions of @p cell at the place @p xi of the unit cell.
    virtual AtPlace at(const Index &cell, const dealii::Point<dim> &xi) const = 0;

  protected:
    /// Place of node @p i along an axis, in cells from the lower end of the axis of @p n_cells.
    virtual double axis_place(unsigned int i, unsigned int n_cells) const = 0;
    /// Along an axis, how far from a node's place its field is sampled [cells], and the weights.
    virtual std::vector<std::pair<double, double>> axis_samples(unsigned int i, unsigned int n_cells) const = 0;

    const GridBox<dim> box;
    const unsigned int per_axis;

  private:
    unsigned int nodes_of_cell = 1;
  };

  /// Shape functions with n nodes a cell, many points at once.
  template <int dim, unsigned int n>
  class ShapeFunctionsOf : public ShapeFunctions<dim>
  {
  public:
    using ShapeFunctions<dim>::ShapeFunctions;

    /// Those of @p cell at the first @p n_points places @p xi of the unit cell.
    virtual void evaluate(const typename ShapeFunctions<dim>::Index &cell, const std::vector<dealii::Point<dim>> &xi,
                          unsigned int n_points, std::vector<Stencil<dim, n>> &stencils) const = 0;
  };

  /// An entry of the table of shape functions.
  template <int dim>
  struct ShapeFunctionsEntry
  {
    std::string  name;
    unsigned int per_axis; ///< nodes of a cell along an axis
    std::unique_ptr<ShapeFunctions<dim>> (*make)(const GridBox<dim> &box);
  };

  /// All there are; the first is the default.
  template <int dim>
  const std::vector<ShapeFunctionsEntry<dim>> &shape_functions();
} // namespace Stroma
