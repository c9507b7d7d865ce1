#include <stroma/rigid/rotation.h>

#include <deal.II/base/point.h>

#include <Eigen/Geometry>

#include <cmath>

namespace Stroma::Rigid
{
  namespace
  {
    Eigen::Quaterniond
    quaternion(const Axial<3> &theta)
    {
      const double angle = theta.norm();
      const auto   axis  = angle > 0. ? theta / angle : Axial<3>();
      return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d(axis[0], axis[1], axis[2])));
    }

    /// (1 - cos a)/a^2 and (a - sin a)/a^3, by their series where the differences would cancel.
    std::array<double, 2>
    differences(const double a)
    {
      const double square = a * a;
      if (a < 1e-2)
        return {{.5 - square / 24., 1. / 6. - square / 120.}};
      return {{(1. - std::cos(a)) / square, (a - std::sin(a)) / (square * a)}};
    }
  } // namespace

  template <int dim>
  dealii::Tensor<1, dim>
  cross(const Axial<dim> &w, const dealii::Tensor<1, dim> &r)
  {
    dealii::Tensor<1, dim> v;
    if constexpr (dim == 2)
      {
        v[0] = -w[0] * r[1];
        v[1] = w[0] * r[0];
      }
    else
      v = dealii::cross_product_3d(w, r);
    return v;
  }

  template <int dim>
  dealii::Tensor<2, dim>
  cross_matrix(const Axial<dim> &w)
  {
    dealii::Tensor<2, dim> columns;
    for (unsigned int d = 0; d < dim; ++d)
      columns[d] = cross<dim>(w, dealii::Point<dim>::unit_vector(d));
    return transpose(columns);
  }

  template <int dim>
  Axial<dim>
  moment(const dealii::Tensor<1, dim> &r, const dealii::Tensor<1, dim> &f)
  {
    if constexpr (dim == 2)
      {
        Axial<2> torque;
        torque[0] = r[0] * f[1] - r[1] * f[0];
        return torque;
      }
    else
      return dealii::cross_product_3d(r, f);
  }

  template <int dim>
  dealii::Tensor<2, dim>
  rotation_matrix(const Axial<dim> &theta)
  {
    dealii::Tensor<2, dim> R;
    if constexpr (dim == 2)
      {
        R[0][0] = R[1][1] = std::cos(theta[0]);
        R[1][0]           = std::sin(theta[0]);
        R[0][1]           = -R[1][0];
      }
    else
      {
        const Eigen::Matrix3d matrix = quaternion(theta).toRotationMatrix();
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            R[i][j] = matrix(i, j);
      }
    return R;
  }

  template <int dim>
  Axial<dim>
  angular_velocity(const Axial<dim> &theta, const Axial<dim> &rate)
  {
    if constexpr (dim == 2)
      return rate;
    else
      {
        const auto [b, c] = differences(theta.norm());
        const auto across = dealii::cross_product_3d(theta, rate);
        return rate + b * across + c * dealii::cross_product_3d(theta, across);
      }
  }

  template <int dim>
  Axial<dim>
  compose(const Axial<dim> &first, const Axial<dim> &second)
  {
    const Axial<dim> sum = first + second;
    if constexpr (dim == 2)
      return sum;
    else
      {
        const Eigen::AngleAxisd both(quaternion(second) * quaternion(first));
        const Axial<3>          axis({both.axis()[0], both.axis()[1], both.axis()[2]});
        // Rotations about one axis by angles that differ by whole turns are the same.
        constexpr double turn = 2. * dealii::numbers::PI;
        return (both.angle() + turn * std::round((axis * sum - both.angle()) / turn)) * axis;
      }
  }

  template dealii::Tensor<1, 2> cross<2>(const Axial<2> &, const dealii::Tensor<1, 2> &);
  template dealii::Tensor<1, 3> cross<3>(const Axial<3> &, const dealii::Tensor<1, 3> &);
  template dealii::Tensor<2, 2> cross_matrix<2>(const Axial<2> &);
  template dealii::Tensor<2, 3> cross_matrix<3>(const Axial<3> &);
  template Axial<2>             moment<2>(const dealii::Tensor<1, 2> &, const dealii::Tensor<1, 2> &);
  template Axial<3>             moment<3>(const dealii::Tensor<1, 3> &, const dealii::Tensor<1, 3> &);
  template dealii::Tensor<2, 2> rotation_matrix<2>(const Axial<2> &);
  template dealii::Tensor<2, 3> rotation_matrix<3>(const Axial<3> &);
  template Axial<2>             angular_velocity<2>(const Axial<2> &, const Axial<2> &);
  template Axial<3>             angular_velocity<3>(const Axial<3> &, const Axial<3> &);
  template Axial<2>             compose<2>(const Axial<2> &, const Axial<2> &);
  template Axial<3>             compose<3>(const Axial<3> &, const Axial<3> &);
} // namespace Stroma::Rigid
