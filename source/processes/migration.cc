#include <stroma/base/text.h>
#include <stroma/processes/migration.h>

#include <cmath>

namespace Stroma::Processes
{
  namespace
  {
    /// Across @p a, in the plane to its left; in space the @p k-th of two.
    template <int dim>
    dealii::Tensor<1, dim>
    across(const dealii::Tensor<1, dim> &a, const unsigned int k)
    {
      if constexpr (dim == 2)
        return dealii::Tensor<1, 2>({-a[1], a[0]});
      else
        {
          dealii::Tensor<1, 3> axis;
          axis[std::abs(a[2]) < .9 ? 2 : 0] = 1.;
          auto first                        = cross_product_3d(axis, a);
          first /= first.norm();
          return k == 0 ? first : cross_product_3d(a, first);
        }
    }
  } // namespace

  template <int dim>
  void
  Migration<dim>::add(Parameters &p, const std::string &its_name,
                      const std::vector<std::pair<std::string, unsigned int>> &bodies)
  {
    name  = its_name;
    where = p.where_section();
    body  = bodies.empty() ? 0 : bodies.front().second;
    p.add_choice<unsigned int>("Body", body, "the rigid body that propels itself", bodies);
    p.add("Force", size, "by which it does, F_migr", "N", Range::positive());
    std::vector<double> direction(dim, 0.);
    direction[dim - 1] = 1.;
    p.add("Direction", direction, "about which that of the force fluctuates, of any length", "", Range::any(), dim);
    for (unsigned int c = 0; c < dim; ++c)
      ahead[c] = direction[c];
    if (!(ahead.norm() > 0.) || !std::isfinite(ahead.norm()))
      throw UserError(p.where("Direction"), "'Direction' has no length; give one that has");
    ahead /= ahead.norm();
    double       rate = .1, diffusion = 5e-5;
    unsigned int seed = 1;
    p.add("Polarisation rate", rate, "at which the direction turns back to that, f_bias", "1/s",
          Range::closed(0., 1e3));
    p.add("Rotational diffusion", diffusion, "of the direction, D_r [rad^2 per unit of time]", "1/s",
          Range::non_negative());
    p.add("Seed", seed, "of the random numbers of the direction");
    for (unsigned int k = 0; k + 1 < dim; ++k)
      angles.emplace_back(rate, diffusion, seed, k);
  }

  template <int dim>
  dealii::Tensor<1, dim>
  Migration<dim>::direction(const double t) const
  {
    const double a = angles[0].at(t);
    auto         u = std::cos(a) * ahead + std::sin(a) * across<dim>(ahead, 0);
    if constexpr (dim == 3)
      {
        const double b = angles[1].at(t);
        u              = std::cos(b) * u + std::sin(b) * across<dim>(ahead, 1);
      }
    return u;
  }

  template class Migration<2>;
  template class Migration<3>;
} // namespace Stroma::Processes
