#pragma once

#include <stroma/scene/scene.h>

namespace Stroma
{
  /**
   * The dead loads of a scene as densities, the same for all methods. A load by its total is spread evenly over the volume or
   * area that it acts on, measured once: as a method's points, particles or cells add it up, so that the sum of their forces is
   * the total.
   */
  template <int dim>
  class LoadDensities
  {
  public:
    explicit LoadDensities(const Scene<dim> &scene)
      : scene(scene)
      , sizes(scene.loads.size(), 0.)
    {}

    /// Sets what load @p l acts on: the sum of @p of_rank over the ranks [m^3, m^2], in two dimensions for the scene's thickness.
    /// Collective.
    void measure(unsigned int l, long double of_rank);

    /// Throws UserError if load @p l acts on nothing. @param parts what of the method it would select, in words.
    void require(unsigned int l, const std::string &parts) const;

    /// Of load @p l at @p X and time @p t [N/m^3, N/m^2].
    dealii::Tensor<1, dim> value(unsigned int l, const dealii::Point<dim> &X, double t) const;

    bool depends_on_time(unsigned int l) const;
    bool depends_on_place(unsigned int l) const;

    /// What the loads act on [m^3, m^2]: sums whose last digit may depend on the order of summation, for a checkpoint.
    const std::vector<double> &
    measures() const
    {
      return sizes;
    }
    void
    set_measures(const std::vector<double> &of_loads)
    {
      sizes = of_loads;
    }

  private:
    const SpaceTimeVector<dim> &given(unsigned int l) const;

    const Scene<dim>   &scene;
    std::vector<double> sizes;
  };
} // namespace Stroma
