#pragma once

#include <stroma/base/types.h>

#include <deal.II/base/index_set.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/full_matrix.h>

#include <vector>

/**
 * Linear elasticity on a box of equal Q1 cells with stiff tubes in a soft matrix (Young's moduli 2 and 1, nu = .286),
 * stretched in y: the structure of the real problem at any size. Constrained rows and columns are replaced by the
 * diagonal, as GridSystem does.
 */
class Elasticity
{
public:
  /// @param cells of the box in x, y, z, each of size @p cell_size, on MPI_COMM_WORLD
  Elasticity(const std::vector<unsigned int> &cells, const dealii::Tensor<1, 3> &cell_size);

  /// Fills matrix and right-hand side. @p stiffening multiplies the modulus of the tubes.
  void assemble(double stiffening = 1.);

  /// Three translations and three rotations, zero on constrained unknowns.
  std::vector<Stroma::Vector> rigid_body_modes() const;

  Stroma::Vector vector() const;

  Stroma::Matrix matrix;
  Stroma::Vector rhs;

private:
  void   constrain();
  void   make_sparsity();
  void   compute_cell_matrix();
  double modulus(const dealii::Point<3> &x, double stiffening) const;

  dealii::parallel::distributed::Triangulation<3> triangulation;
  dealii::FESystem<3>                             fe;
  dealii::DoFHandler<3>                           dof_handler;
  dealii::Point<3>                                corner;
  dealii::AffineConstraints<double>               constraints;
  dealii::IndexSet                                relevant;
  dealii::FullMatrix<double>                      cell_matrix; ///< for Young's modulus 1
};
