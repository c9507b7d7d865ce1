#pragma once

#include <stroma/base/parameters.h>
#include <stroma/processes/ornstein_uhlenbeck.h>

#include <deal.II/base/tensor.h>

#include <memory>

namespace Stroma::Processes
{
  /**
   * A rigid body that propels itself (a cell): a force of constant size, whose direction fluctuates about a given one, (37) and
   * (38) of Heck 2017. In the plane it is turned by the angle X(t) of an Ornstein-Uhlenbeck process; in space by two independent
   * ones, in the two directions across, each by the same law.
   */
  template <int dim>
  class Migration
  {
  public:
    /// Declares and reads the entries of the current section. @param bodies rigid ones by name, with their index. Throws UserError.
    void add(Parameters &p, const std::string &name, const std::vector<std::pair<std::string, unsigned int>> &bodies);

    /// Of length 1, at time @p t [s].
    dealii::Tensor<1, dim> direction(double t) const;
    /// [N]
    dealii::Tensor<1, dim>
    force(const double t) const
    {
      return size * direction(t);
    }

    std::string  name, where;
    unsigned int body = 0; ///< index into the scene's bodies

  private:
    double                         size = std::numeric_limits<double>::quiet_NaN(); ///< [N]
    dealii::Tensor<1, dim>         ahead;                                           ///< mean direction, of length 1
    std::vector<OrnsteinUhlenbeck> angles;                                          ///< dim - 1 of them
  };
} // namespace Stroma::Processes
