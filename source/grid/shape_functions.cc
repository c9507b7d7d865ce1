#include <stroma/grid/linear_axis.h>
#include <stroma/grid/quadratic_b_spline_axis.h>
#include <stroma/grid/tensor_product.h>

namespace Stroma
{
  template <int dim>
  const std::vector<ShapeFunctionsEntry<dim>> &
  shape_functions()
  {
    static const std::vector<ShapeFunctionsEntry<dim>> table = {
      {"linear", LinearAxis::n, &TensorProduct<dim, LinearAxis>::make},
      {"quadratic B-spline", QuadraticBSplineAxis::n, &TensorProduct<dim, QuadraticBSplineAxis>::make},
    };
    return table;
  }

  template <int dim>
  ShapeFunctions<dim>::ShapeFunctions(const GridBox<dim> &box, const unsigned int per_axis)
    : box(box)
    , per_axis(per_axis)
  {
    for (unsigned int d = 0; d < dim; ++d)
      nodes_of_cell *= per_axis;
  }

  template <int dim>
  typename ShapeFunctions<dim>::Index
  ShapeFunctions<dim>::node_index(const Index &cell, unsigned int a) const
  {
    Index index = cell;
    for (unsigned int d = 0; d < dim; ++d, a /= per_axis)
      index[d] += a % per_axis;
    return index;
  }

  template <int dim>
  dealii::Point<dim>
  ShapeFunctions<dim>::place(const Index &node) const
  {
    dealii::Point<dim> X = box.lower;
    for (unsigned int d = 0; d < dim; ++d)
      X[d] += axis_place(node[d], box.n_cells[d]) * box.cell_size[d];
    return X;
  }

  template <int dim>
  std::vector<typename ShapeFunctions<dim>::Sample>
  ShapeFunctions<dim>::samples(const Index &node) const
  {
    std::vector<Sample> all{{place(node), 1.}};
    for (unsigned int d = 0; d < dim; ++d)
      {
        std::vector<Sample> next;
        for (const auto &sample : all)
          for (const auto &[offset, weight] : axis_samples(node[d], box.n_cells[d]))
            {
              next.push_back({sample.X, sample.weight * weight});
              next.back().X[d] += offset * box.cell_size[d];
            }
        all = std::move(next);
      }
    return all;
  }

  template class ShapeFunctions<2>;
  template class ShapeFunctions<3>;
  template const std::vector<ShapeFunctionsEntry<2>> &shape_functions<2>();
  template const std::vector<ShapeFunctionsEntry<3>> &shape_functions<3>();
} // namespace Stroma
