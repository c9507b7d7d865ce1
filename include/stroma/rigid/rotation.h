#pragma once

#include <deal.II/base/tensor.h>

namespace Stroma::Rigid
{
  /// Components of a rotation: the angle in the plane, the rotation vector in space.
  template <int dim>
  constexpr unsigned int n_rotations = dim == 2 ? 1 : 3;

  /// A rotation [rad], an angular velocity [rad/s] or a torque [N m]; in the plane its component along z.
  template <int dim>
  using Axial = dealii::Tensor<1, n_rotations<dim>>;

  /// w x r.
  template <int dim>
  dealii::Tensor<1, dim> cross(const Axial<dim> &w, const dealii::Tensor<1, dim> &r);

  /// A with A r = w x r.
  template <int dim>
  dealii::Tensor<2, dim> cross_matrix(const Axial<dim> &w);

  /// r x f, the torque of a force @p f [N] at the end of the arm @p r [m].
  template <int dim>
  Axial<dim> moment(const dealii::Tensor<1, dim> &r, const dealii::Tensor<1, dim> &f);

  /// R(theta) = I + sin|theta| A + (1 - cos|theta|) A^2, A = theta/|theta| x (Rodrigues).
  template <int dim>
  dealii::Tensor<2, dim> rotation_matrix(const Axial<dim> &theta);

  /// The angular velocity w of a rotation vector @p theta that changes at @p rate: dR/dt = w x R, with
  /// w = rate + (1 - cos|theta|)/|theta| A rate + (1 - sin|theta|/|theta|) A^2 rate.
  template <int dim>
  Axial<dim> angular_velocity(const Axial<dim> &theta, const Axial<dim> &rate);

  /// The rotation vector of R(second) R(first); of all that mean the same, the one nearest to @p first + @p second.
  template <int dim>
  Axial<dim> compose(const Axial<dim> &first, const Axial<dim> &second);
} // namespace Stroma::Rigid
