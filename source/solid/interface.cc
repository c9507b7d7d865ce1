#include <stroma/solid/interface.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace Stroma::Solid
{
  namespace
  {
    /// Parts of a cell's size under which the centroids of two materials do not tell a direction: one lies around the other.
    constexpr double concentric = .1;

    /// Along which of the axes the spread of two materials differs most, in parts of the cell's size.
    template <int dim>
    dealii::Tensor<1, dim>
    direction_of_spread(const dealii::SymmetricTensor<2, dim> &difference, const dealii::Tensor<1, dim> &size)
    {
      unsigned int axis    = 0;
      double       largest = 0.;
      for (unsigned int d = 0; d < dim; ++d)
        if (const double spread = std::abs(difference[d][d]) / (size[d] * size[d]); spread > (1. + 1e-9) * largest)
          {
            largest = spread;
            axis    = d;
          }
      dealii::Tensor<1, dim> N;
      N[axis] = 1.;
      return N;
    }

    template <int dim>
    dealii::Tensor<1, dim>
    normal_between(const Moments<dim> &one, const Moments<dim> &other, const dealii::Tensor<1, dim> &size)
    {
      const auto apart    = other.centroid() - one.centroid();
      double     relative = 0;
      for (unsigned int d = 0; d < dim; ++d)
        relative += std::pow(apart[d] / size[d], 2);
      if (relative > concentric * concentric)
        return apart / apart.norm();
      return direction_of_spread<dim>(one.covariance() - other.covariance(), size);
    }
  } // namespace

  template <int dim>
  std::optional<Interface<dim>>
  find_interface(const std::vector<Moments<dim>> &moments, const std::vector<const Materials::Material *> &laws,
                 const dealii::Tensor<1, dim> &size)
  {
    std::vector<unsigned int> by_volume(moments.size());
    std::iota(by_volume.begin(), by_volume.end(), 0u);
    std::stable_sort(by_volume.begin(), by_volume.end(),
                     [&](const auto i, const auto j) { return moments[i].volume() > moments[j].volume(); });
    if (by_volume.size() < 2 || moments[by_volume[1]].n_points() == 0)
      return std::nullopt;
    const auto                  stiffness = [&](const unsigned int m) { return std::log(laws[m]->p_wave_modulus()); };
    const auto                  first = by_volume[0], second = by_volume[1];
    std::array<Moments<dim>, 2> sides;
    std::vector<bool>           is_second(moments.size(), false);
    for (unsigned int m = 0; m < moments.size(); ++m)
      {
        is_second[m] = m == second || (m != first && std::abs(stiffness(m) - stiffness(second)) <
                                                       std::abs(stiffness(m) - stiffness(first)));
        sides[is_second[m]].add(moments[m]);
      }
    const double   theta = sides[1].volume() / (sides[0].volume() + sides[1].volume());
    Interface<dim> interface {
      normal_between(sides[0], sides[1], size),
      {}
    };
    for (const bool second_side : is_second)
      interface.side.push_back(second_side ? theta - 1. : theta);
    return interface;
  }

  template std::optional<Interface<2>> find_interface(const std::vector<Moments<2>> &,
                                                      const std::vector<const Materials::Material *> &,
                                                      const dealii::Tensor<1, 2> &);
  template std::optional<Interface<3>> find_interface(const std::vector<Moments<3>> &,
                                                      const std::vector<const Materials::Material *> &,
                                                      const dealii::Tensor<1, 3> &);
} // namespace Stroma::Solid
