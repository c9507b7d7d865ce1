#pragma once

#include <stroma/base/power.h>
#include <stroma/grid/shape_functions.h>

namespace Stroma
{
  /// Products of one function along each axis; Axis says which, see LinearAxis.
  template <int dim, typename Axis>
  class TensorProduct : public ShapeFunctionsOf<dim, power(Axis::n, dim)>
  {
  public:
    static constexpr unsigned int n = power(Axis::n, dim);
    using Index                     = typename ShapeFunctions<dim>::Index;
    using AtPlace                   = typename ShapeFunctions<dim>::AtPlace;

    explicit TensorProduct(const GridBox<dim> &box)
      : ShapeFunctionsOf<dim, n>(box, Axis::n)
    {}

    static std::unique_ptr<ShapeFunctions<dim>>
    make(const GridBox<dim> &box)
    {
      return std::make_unique<TensorProduct>(box);
    }

    bool
    interpolates() const override
    {
      return Axis::interpolates;
    }

    void
    evaluate(const Index &cell, const std::vector<dealii::Point<dim>> &xi, const unsigned int n_points,
             std::vector<Stencil<dim, n>> &stencils) const override
    {
      for (unsigned int p = 0; p < n_points; ++p)
        find(cell, xi[p], stencils[p]);
    }

    AtPlace
    at(const Index &cell, const dealii::Point<dim> &xi) const override
    {
      Stencil<dim, n> s;
      AtPlace         result;
      find(cell, xi, s);
      for (unsigned int a = 0; a < n; ++a)
        {
          result.value[a] = s.value[a];
          for (unsigned int d = 0; d < dim; ++d)
            result.gradient[d][a] = s.gradient[d][a];
        }
      return result;
    }

  protected:
    double
    axis_place(const unsigned int i, const unsigned int n_cells) const override
    {
      return Axis::place(i, n_cells);
    }
    std::vector<std::pair<double, double>>
    axis_samples(const unsigned int i, const unsigned int n_cells) const override
    {
      return Axis::samples(i, n_cells);
    }

  private:
    // GCC 12 does not see that the loops set all entries of vectors, even of those that start at zero.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
    void
    find(const Index &cell, const dealii::Point<dim> &xi, Stencil<dim, n> &s) const
    {
      std::array<Lanes<n>, dim> N, dN; // of each axis, at all nodes
      for (unsigned int d = 0; d < dim; ++d)
        {
          double value[Axis::n], slope[Axis::n];
          Axis::evaluate(xi[d], cell[d] == 0, cell[d] + 1 == this->box.n_cells[d], value, slope);
          for (unsigned int i = 0; i < Axis::n; ++i)
            slope[i] *= inverse_size[d];
          for (unsigned int a = 0; a < n; ++a)
            {
              const unsigned int i = a / power(Axis::n, d) % Axis::n;
              N[d][a]              = value[i];
              dN[d][a]             = slope[i];
            }
        }
      if constexpr (dim == 2)
        {
          s.value       = N[0] * N[1];
          s.gradient[0] = dN[0] * N[1];
          s.gradient[1] = N[0] * dN[1];
        }
      else
        {
          s.value       = N[0] * N[1] * N[2];
          s.gradient[0] = dN[0] * N[1] * N[2];
          s.gradient[1] = N[0] * dN[1] * N[2];
          s.gradient[2] = N[0] * N[1] * dN[2];
        }
    }
#pragma GCC diagnostic pop

    const dealii::Tensor<1, dim> inverse_size = inverse(this->box.cell_size); ///< [1/m]

    static dealii::Tensor<1, dim>
    inverse(dealii::Tensor<1, dim> size)
    {
      for (auto *h = size.begin_raw(); h != size.end_raw(); ++h)
        *h = 1. / *h;
      return size;
    }
  };
} // namespace Stroma
