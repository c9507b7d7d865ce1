#include "elasticity.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/lac/trilinos_sparsity_pattern.h>

#include <cmath>

using namespace dealii;

Elasticity::Elasticity(const std::vector<unsigned int> &cells, const Tensor<1, 3> &cell_size)
  : triangulation(MPI_COMM_WORLD)
  , fe(FE_Q<3>(1), 3)
  , dof_handler(triangulation)
{
  std::vector<unsigned int> coarse = cells;
  const bool                even   = cells[0] % 2 == 0 && cells[1] % 2 == 0 && cells[2] % 2 == 0;
  for (unsigned int d = 0; d < 3; ++d)
    {
      corner[d] = cells[d] * cell_size[d];
      coarse[d] = even ? cells[d] / 2 : cells[d];
    }
  GridGenerator::subdivided_hyper_rectangle(triangulation, coarse, Point<3>(), corner);
  if (even)
    triangulation.refine_global(1);
  dof_handler.distribute_dofs(fe);
  constrain();
  make_sparsity();
  compute_cell_matrix();
  rhs.reinit(dof_handler.locally_owned_dofs(), MPI_COMM_WORLD);
}

void
Elasticity::constrain()
{
  DoFTools::extract_locally_relevant_dofs(dof_handler, relevant);
  constraints.reinit(relevant);
  const double tolerance = 1e-9 * corner.norm();

  const auto fix = [&](const types::global_dof_index i, const double value) {
    constraints.add_line(i);
    constraints.set_inhomogeneity(i, value);
  };
  for (const auto &cell : dof_handler.active_cell_iterators())
    if (!cell->is_artificial())
      for (const unsigned int v : cell->vertex_indices())
        {
          const Point<3> &x = cell->vertex(v);
          if (x[1] < tolerance || x[1] > corner[1] - tolerance)
            if (const auto i = cell->vertex_dof_index(v, 1); !constraints.is_constrained(i))
              fix(i, .1 * x[1]);
          if (x.norm() < tolerance)
            for (const unsigned int d : {0, 2})
              if (const auto i = cell->vertex_dof_index(v, d); !constraints.is_constrained(i))
                fix(i, 0.);
          if (x.distance(Point<3>(0, 0, corner[2])) < tolerance)
            if (const auto i = cell->vertex_dof_index(v, 0); !constraints.is_constrained(i))
              fix(i, 0.);
        }
  constraints.close();
}

void
Elasticity::make_sparsity()
{
  TrilinosWrappers::SparsityPattern pattern(dof_handler.locally_owned_dofs(), dof_handler.locally_owned_dofs(),
                                            relevant, MPI_COMM_WORLD);
  DoFTools::make_sparsity_pattern(dof_handler, pattern, constraints, true,
                                  Utilities::MPI::this_mpi_process(MPI_COMM_WORLD));
  pattern.compress();
  matrix.reinit(pattern);
}

void
Elasticity::compute_cell_matrix()
{
  const double    nu = .286, lambda = nu / ((1. + nu) * (1. - 2. * nu)), mu = .5 / (1. + nu);
  const QGauss<3> quadrature(2);
  FEValues<3>     values(fe, quadrature, update_gradients | update_JxW_values);
  for (const auto &cell : dof_handler.active_cell_iterators())
    if (cell->is_locally_owned())
      {
        values.reinit(cell);
        break;
      }
  const unsigned int n = fe.n_dofs_per_cell();
  cell_matrix.reinit(n, n);
  const FEValuesExtractors::Vector u(0);
  for (const unsigned int q : values.quadrature_point_indices())
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j)
        cell_matrix(i, j) += (2. * mu * values[u].symmetric_gradient(i, q) * values[u].symmetric_gradient(j, q) +
                              lambda * values[u].divergence(i, q) * values[u].divergence(j, q)) *
                             values.JxW(q);
}

double
Elasticity::modulus(const Point<3> &x, const double stiffening) const
{
  const double radius = .06 * corner[0];
  for (unsigned int k = 0; k < 6; ++k) // tubes through scattered places at scattered angles in the plane of x and y
    {
      const double angle = 2.4 * k, px = corner[0] * (.5 + .4 * std::sin(5. * k + 1.)),
                   py = corner[1] * (.5 + .4 * std::sin(3. * k)), pz = corner[2] * (.5 + .3 * std::sin(7. * k + 2.));
      const double across = (x[0] - px) * std::sin(angle) - (x[1] - py) * std::cos(angle);
      if (std::hypot(across, x[2] - pz) < radius)
        return 2. * stiffening;
    }
  return 1.;
}

void
Elasticity::assemble(const double stiffening)
{
  matrix                                 = 0.;
  rhs                                    = 0.;
  const unsigned int                   n = fe.n_dofs_per_cell();
  FullMatrix<double>                   scaled(n, n);
  dealii::Vector<double>               zero(n);
  std::vector<types::global_dof_index> indices(n);
  for (const auto &cell : dof_handler.active_cell_iterators())
    if (cell->is_locally_owned())
      {
        scaled.equ(modulus(cell->center(), stiffening), cell_matrix);
        cell->get_dof_indices(indices);
        constraints.distribute_local_to_global(scaled, zero, indices, matrix, rhs, true);
      }
  matrix.compress(VectorOperation::add);
  rhs.compress(VectorOperation::add);
}

Stroma::Vector
Elasticity::vector() const
{
  return Stroma::Vector(dof_handler.locally_owned_dofs(), MPI_COMM_WORLD);
}

std::vector<Stroma::Vector>
Elasticity::rigid_body_modes() const
{
  std::vector<Stroma::Vector> modes(6, vector());
  for (const auto &cell : dof_handler.active_cell_iterators())
    if (cell->is_locally_owned())
      for (const unsigned int v : cell->vertex_indices())
        {
          const Tensor<1, 3> x = cell->vertex(v) - .5 * corner;
          for (unsigned int d = 0; d < 3; ++d)
            if (const auto i = cell->vertex_dof_index(v, d);
                dof_handler.locally_owned_dofs().is_element(i) && !constraints.is_constrained(i))
              {
                const unsigned int e = (d + 1) % 3, f = (d + 2) % 3;
                modes[d][i]     = 1.;
                modes[3 + e][i] = x[f]; // rotation about axis e: u_d = x_f, u_f = -x_d
                modes[3 + f][i] = -x[e];
              }
        }
  for (auto &mode : modes)
    mode.compress(VectorOperation::insert);
  return modes;
}
