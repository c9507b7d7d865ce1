#include <stroma/rigid/mass.h>

#include <deal.II/base/symmetric_tensor.h>

namespace Stroma::Rigid
{
  namespace
  {
    template <int dim>
    std::array<double, n_motions<dim>>
    numbers_of(const Twist<dim> &twist)
    {
      std::array<double, n_motions<dim>> numbers;
      for (unsigned int c = 0; c < dim; ++c)
        numbers[c] = twist.velocity[c];
      for (unsigned int k = 0; k < n_rotations<dim>; ++k)
        numbers[dim + k] = twist.angular_velocity[k];
      return numbers;
    }

    template <int dim>
    DrivenBy
    driven_by(const Drive<dim> &drive, const unsigned int k)
    {
      return k < dim ? drive.translation[k] : drive.rotation[k - dim];
    }
  } // namespace

  template <int dim>
  dealii::FullMatrix<double>
  mass_matrix(const Body<dim> &body, const double mass, const Pose<dim> &pose)
  {
    const auto                   R = rotation_matrix<dim>(pose.rotation);
    const auto                   c = pose.arm(body.moments.centroid);
    const dealii::Tensor<2, dim> S = R * dealii::Tensor<2, dim>(body.moments.second) * transpose(R) /
                                       body.moments.volume +
                                     outer_product(c, c);
    dealii::FullMatrix<double> M(n_motions<dim>, n_motions<dim>);
    for (unsigned int d = 0; d < dim; ++d)
      M(d, d) = mass;
    for (unsigned int k = 0; k < n_rotations<dim>; ++k)
      {
        Axial<dim> axis;
        axis[k]           = 1.;
        const auto across = cross<dim>(axis, c); // velocity of the centroid
        for (unsigned int d = 0; d < dim; ++d)
          M(d, dim + k) = M(dim + k, d) = mass * across[d];
        if constexpr (dim == 2)
          M(dim, dim) = mass * trace(S);
        else
          for (unsigned int l = 0; l < 3; ++l)
            M(dim + k, dim + l) = mass * ((k == l ? trace(S) : 0.) - S[k][l]);
      }
    return M;
  }

  template <int dim>
  double
  gyration(const Body<dim> &body)
  {
    return std::sqrt(trace(body.moments.second) / body.moments.volume +
                     (body.moments.centroid - body.pivot).norm_square());
  }

  template <int dim>
  Momentum<dim>::Momentum(const Body<dim> &body, const double mass, const Twist<dim> &twist, const Pose<dim> &pose)
    : body(&body)
    , mass(mass)
  {
    const auto M = mass_matrix(body, mass, pose);
    const auto v = numbers_of(twist);
    for (unsigned int k = 0; k < n_motions<dim>; ++k)
      for (unsigned int l = 0; l < n_motions<dim>; ++l)
        (k < dim ? linear[k] : angular[k - dim]) += M(k, l) * v[l];
  }

  template <int dim>
  Twist<dim>
  Momentum<dim>::advance(const Wrench<dim> &acting, const Twist<dim> &given, const Pose<dim> &pose, const double dt)
  {
    linear += dt * acting.force;
    angular += dt * acting.torque;
    constexpr unsigned int     n = n_motions<dim>;
    const auto                 M = mass_matrix(*body, mass, pose);
    dealii::FullMatrix<double> A(M);
    dealii::Vector<double>     p(n), v(n);
    const auto                 v_given = numbers_of(given);
    for (unsigned int k = 0; k < n; ++k)
      if (is_by_balance(driven_by(body->drive, k)))
        p[k] = k < dim ? linear[k] : angular[k - dim];
      else
        {
          for (unsigned int l = 0; l < n; ++l)
            A(k, l) = k == l ? M(k, k) : 0.; // the row says v = given
          p[k] = M(k, k) * v_given[k];
        }
    A.gauss_jordan();
    A.vmult(v, p);
    Twist<dim> twist;
    for (unsigned int k = 0; k < n; ++k)
      (k < dim ? twist.velocity[k] : twist.angular_velocity[k - dim]) = v[k];
    // What is given has the momentum that belongs to it; L is about a pivot that moves on by U dt.
    M.vmult(p, v);
    for (unsigned int k = 0; k < n; ++k)
      if (!is_by_balance(driven_by(body->drive, k)))
        (k < dim ? linear[k] : angular[k - dim]) = p[k];
    if (is_by_balance(body->drive.rotation.front()))
      angular -= dt * moment<dim>(twist.velocity, linear);
    return twist;
  }

  template <int dim>
  double
  Momentum<dim>::kinetic_energy(const Twist<dim> &twist, const Pose<dim> &pose) const
  {
    const auto v = numbers_of(twist);
    const auto M = mass_matrix(*body, mass, pose);
    return .5 * M.matrix_norm_square(dealii::Vector<double>(v.begin(), v.end()));
  }

  template dealii::FullMatrix<double> mass_matrix(const Body<2> &, double, const Pose<2> &);
  template dealii::FullMatrix<double> mass_matrix(const Body<3> &, double, const Pose<3> &);
  template double                     gyration(const Body<2> &);
  template double                     gyration(const Body<3> &);
  template class Momentum<2>;
  template class Momentum<3>;
} // namespace Stroma::Rigid
