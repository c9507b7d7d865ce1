#include <stroma/rigid/drive.h>

#include <algorithm>

namespace Stroma::Rigid
{
  template <int dim>
  bool
  Drive<dim>::any(const DrivenBy kind) const
  {
    return std::count(translation.begin(), translation.end(), kind) +
             std::count(rotation.begin(), rotation.end(), kind) >
           0;
  }

  template <int dim>
  bool
  Drive<dim>::turns() const
  {
    return rotation.front() != DrivenBy::rest;
  }

  template <int dim>
  bool
  Drive<dim>::moves() const
  {
    return turns() ||
           std::any_of(translation.begin(), translation.end(), [](const auto kind) { return kind != DrivenBy::rest; });
  }

  template <int dim>
  dealii::Tensor<1, dim>
  Drive<dim>::force(const double t) const
  {
    dealii::Tensor<1, dim> sum;
    for (const auto &load : forces)
      sum += load.value(dealii::Point<dim>(), t);
    for (const auto &own : own_forces)
      sum += own(t);
    return sum;
  }

  template <int dim>
  Axial<dim>
  Drive<dim>::torque(const double t) const
  {
    Axial<dim> sum;
    for (const auto &load : torques)
      sum += load.value(dealii::Point<dim>(), t);
    return sum;
  }

  template struct Drive<2>;
  template struct Drive<3>;
} // namespace Stroma::Rigid
