#include <stroma/grid/rigid_motions.h>

#include <deal.II/base/mpi.h>

#include <Eigen/Eigenvalues>

namespace Stroma
{
  template <int dim>
  RigidMotions<dim>::RigidMotions(const Scene<dim> &scene)
    : scene(scene)
    , gram(decltype(gram)::Zero())
  {
    const auto box = scene.bounding_box();
    centre         = box.center();
    for (unsigned int d = 0; d < dim; ++d)
      length = std::max(length, box.side_length(d));
  }

  template <int dim>
  void
  RigidMotions<dim>::hold(const dealii::Point<dim> &X, const unsigned int c)
  {
    const dealii::Tensor<1, dim>      r   = (X - centre) / length;
    Eigen::Matrix<double, n_modes, 1> row = Eigen::Matrix<double, n_modes, 1>::Zero();
    row(c)                                = 1;
    if constexpr (dim == 2)
      row(2) = c == 0 ? -r[1] : r[0];
    else
      for (unsigned int axis = 0; axis < 3; ++axis)
        {
          if (c == (axis + 1) % 3)
            row(3 + axis) = -r[(axis + 2) % 3];
          if (c == (axis + 2) % 3)
            row(3 + axis) = r[(axis + 1) % 3];
        }
    gram += row * row.transpose();
  }

  template <int dim>
  void
  RigidMotions<dim>::check() const
  {
    auto total = gram;
    MPI_Allreduce(MPI_IN_PLACE, total.data(), n_modes * n_modes, MPI_DOUBLE, MPI_SUM, scene.comm);
    // A periodic scene cannot turn about an axis across a period.
    for (unsigned int axis = 0; axis < n_modes - dim; ++axis)
      for (unsigned int d = 0; d < dim; ++d)
        if (scene.periodic[d] && (dim == 2 || d != axis))
          total(dim + axis, dim + axis) += 1.;
    const Eigen::SelfAdjointEigenSolver<decltype(gram)> eigen(total);
    if (eigen.eigenvalues()(0) > 1e-10 * std::max(1., eigen.eigenvalues()(n_modes - 1)))
      return;
    Eigen::Index mode;
    eigen.eigenvectors().col(0).cwiseAbs().maxCoeff(&mode);
    const std::string motion = mode < dim ? std::string("move along ") + "xyz"[mode] :
                                            (dim == 2 ? std::string("turn in the plane") :
                                                        std::string("turn about ") + "xyz"[mode - dim]);
    throw UserError(scene.bodies.front().where, "the supports leave the bodies free to " + motion +
                                                  "; hold them there, for example by a support on 'nearest' with the " +
                                                  "other components free");
  }

  template class RigidMotions<2>;
  template class RigidMotions<3>;
} // namespace Stroma
