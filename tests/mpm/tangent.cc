// The tangent against automatic differentiation of an independently written residual, and against differences.

#include "../base/keep_largest.h"
#include "automatic.h"
#include "differences.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace
{
  using namespace Stroma;
  /// The part of F that the present grid makes at a point, I + sum_a u_a (x) grad S_a, as a function of all unknowns.
  template <int dim, typename Unknown>
  Matrix3
  present_part(const Vector &u, const typename ShapeFunctions<dim>::AtPlace &shapes, const Unknown &unknown,
               const unsigned int n_nodes)
  {
    Matrix3 H;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int k = 0; k < 3; ++k)
        H[i][k] = AD(i == k ? 1. : 0.);
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int a = 0; a < n_nodes; ++a)
          H[i][k] += AD(u.size(), unknown(a, i), u(unknown(a, i))) * shapes.gradient[k][a];
    return H;
  }

  /// F of the point at the last rebase.
  template <int dim>
  Matrix3
  stored_part(const Mpm::Points<dim> &points, const double *numbers)
  {
    Matrix3 F;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int k = 0; k < 3; ++k)
        F[i][k] = AD(
          i < dim && k < dim && points.deformation.stored() ? numbers[points.deformation.first + i * dim + k] : i == k);
    return F;
  }

  /// Internal forces f_a = sum_p V0 P (F^r)^T grad S_a, since P : dF = tau : sym(dF F^-1) and dF = dH F^r.
  template <int dim>
  std::vector<AD>
  internal_forces(const SystemFixture<dim> &s, const Vector &u)
  {
    const double       modulus[2][2] = {{1, 2}, {3, 7}};
    const unsigned int n_nodes       = s.grid->shape->n_nodes();
    std::vector<AD>    force(u.size(), AD(u.size(), 0.));
    for (const auto &active : s.grid->active_cells())
      for (const auto &point : s.points->handler.particles_in_cell(active.cell))
        {
          const auto    unknown = [&](const unsigned int a, const unsigned int i) { return active.node[a] + i; };
          const auto    numbers = point.get_properties();
          const auto    m       = s.points->material_of(numbers.data());
          const auto    shapes  = s.grid->shape->at(active.index, point.get_reference_location());
          const Matrix3 H       = present_part<dim>(u, shapes, unknown, n_nodes);
          const Matrix3 stored  = stored_part(*s.points, numbers.data());
          const Matrix3 P = product(neo_hookean_stress(product(H, stored, false), modulus[m][0], modulus[m][1]), stored,
                                    true);
          for (unsigned int a = 0; a < n_nodes; ++a)
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int k = 0; k < dim; ++k)
                force[unknown(a, i)] += numbers[s.points->volume.first] * P[i][k] * shapes.gradient[k][a];
        }
    return force;
  }

  /// A displacement of random numbers within +- @p size / 2.
  template <int dim>
  Vector
  random_displacement(const SystemFixture<dim> &s, const double size, std::mt19937 &random)
  {
    Vector u = s.system->new_vector();
    for (auto &value : u)
      value = size * (random() / 4294967295. - .5);
    return u;
  }

  template <int dim>
  void
  check_against_automatic_differentiation(const std::string &mpm, const bool prior_deformation)
  {
    SystemFixture<dim> s(two_material_box(dim, "subsection MPM\n set Interface = bonded points\n" + mpm + "end\n"));
    std::mt19937       random(7);
    Vector             u = random_displacement(s, .15, random);
    if (prior_deformation) // give the points a deformation gradient of their own, without moving them
      {
        s.system->rebase_points(u, false);
        u = random_displacement(s, .1, random);
      }
    Vector r = s.system->new_vector();
    Matrix K;
    ASSERT_EQ(s.system->residual(r, u), StepStatus::ok);
    ASSERT_EQ(s.system->tangent(K, r, u), StepStatus::ok);
    const auto force = internal_forces(s, u);

    double scale = 0, worst_force = 0, worst_tangent = 0, force_scale = 0;
    for (unsigned int i = 0; i < u.size(); ++i)
      {
        keep_largest(force_scale, std::abs(force[i].val()));
        keep_largest(worst_force, std::abs(s.system->unbalanced_forces()(i) + force[i].val()));
        for (unsigned int j = 0; j < u.size(); ++j)
          {
            keep_largest(scale, std::abs(force[i].dx(j)));
            keep_largest(worst_tangent, std::abs(K.el(i, j) - force[i].dx(j)));
          }
      }
    EXPECT_LT(worst_force / force_scale, 1e-12);
    EXPECT_LT(worst_tangent / scale, 1e-9);
    std::cout << "dim " << dim << ": largest difference to automatic differentiation " << worst_force / force_scale
              << " (force), " << worst_tangent / scale << " (tangent)" << std::endl;
  }

  TEST(Tangent, EqualsAutomaticDifferentiationIn2D)
  {
    check_against_automatic_differentiation<2>(" set Cells = 3, 2\n set Points per cell = 3, 2\n", false);
  }

  TEST(Tangent, EqualsAutomaticDifferentiationIn3D)
  {
    check_against_automatic_differentiation<3>(" set Cells = 2, 2, 1\n set Points per cell = 2, 3, 2\n", false);
  }

  TEST(Tangent, EqualsAutomaticDifferentiationAfterAReset)
  {
    check_against_automatic_differentiation<2>(" set Cells = 3, 2\n set Grid reset = always\n", true);
    check_against_automatic_differentiation<3>(" set Cells = 2, 1, 1\n set Grid reset = always\n", true);
  }

  TEST(Tangent, EqualsAutomaticDifferentiationWithQuadraticBSplines)
  {
    const std::string splines = " set Shape functions = quadratic B-spline\n";
    check_against_automatic_differentiation<2>(" set Cells = 3, 2\n" + splines, false);
    check_against_automatic_differentiation<2>(" set Cells = 1, 3\n set Grid reset = always\n" + splines, true);
    check_against_automatic_differentiation<3>(" set Cells = 2, 1, 1\n" + splines, false);
  }

  // Driven points and plane stress have no closed formula here: central differences, to their own accuracy.
  TEST(Tangent, EqualsDifferencesWithDrivenPointsAndPlaneStress)
  {
    SystemFixture<2> s("set Plane = stress\n" +
                       two_material_box(2, "subsection Supports\n subsection top\n  set Where = layer y-max 0.2\n"
                                           "  set Displacement = free; 0.1*t\n end\nend\n"
                                           "subsection MPM\n set Cells = 3, 3\n set Penalty = 10\nend\n"));
    Vector           u = s.system->new_vector(), r = u;
    std::mt19937     random(3);
    for (auto &value : u)
      value = .1 * (random() / 4294967295. - .5);
    Matrix K;
    s.system->residual(r, u);
    s.system->tangent(K, r, u);
    const auto errors = tangent_errors(*s.system, K, u);
    EXPECT_LT(errors.worst / errors.scale, 1e-8);
  }
} // namespace
