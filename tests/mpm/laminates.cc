// Composite cells against laminates that are written independently: their tangent by automatic differentiation, and cells that are
// all cut alike, at any angle and contrast, which affine displacements of the boundary leave uniform.

#include "../base/keep_largest.h"
#include "automatic.h"
#include "label_file.h"
#include "solve.h"

#include <stroma/materials/neo_hookean.h>
#include <stroma/mpm/two_moment_points.h>
#include <stroma/solid/interface.h>

#include <deal.II/lac/full_matrix.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <sstream>

namespace
{
  using namespace Stroma;

  /// A point of a laminate: F + s a (x) N, of a neo-Hookean law.
  struct Layer
  {
    double  V, s, mu, kappa;
    Matrix3 F;
  };

  /// Where the jump a makes the tractions of both sides agree, sum V s P N = 0; none where N is zero. The last dim derivatives are those by a.
  template <int dim>
  class Layers
  {
  public:
    Layers(std::vector<Layer> layers, const dealii::Tensor<1, dim> &N, const unsigned int n)
      : layers(std::move(layers))
      , N(N)
      , n(n)
    {
      for (unsigned int i = 0; i < dim; ++i)
        a[i] = AD(n + dim, n + i, 0.);
      for (unsigned int iteration = 0; iteration < 60; ++iteration)
        step();
    }

    Matrix3
    piola(const Layer &layer) const
    {
      Matrix3 F = layer.F;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int k = 0; k < dim; ++k)
          F[i][k] += layer.s * a[i] * N[k];
      return neo_hookean_stress(F, layer.mu, layer.kappa);
    }

    std::array<AD, dim>
    unbalanced() const
    {
      std::array<AD, dim> R;
      for (const auto &layer : layers)
        {
          const Matrix3 stress = piola(layer);
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int k = 0; k < dim; ++k)
              R[i] += layer.V * layer.s * stress[i][k] * N[k];
        }
      return R;
    }

    /// d a_i / d R_k; zero without a jump.
    dealii::FullMatrix<double>
    compliance(const std::array<AD, dim> &R) const
    {
      dealii::FullMatrix<double> K(dim, dim);
      if (N.norm() == 0.)
        return K;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int k = 0; k < dim; ++k)
          K(i, k) = R[i].dx(n + k);
      K.gauss_jordan();
      return K;
    }

    std::vector<Layer> layers;

  private:
    /// One of Newton's method, as short as it must be to leave no layer turned inside out or R larger.
    void
    step()
    {
      const auto   R      = unbalanced();
      const auto   C      = compliance(R);
      const double before = size(R);
      double       change[dim]{};
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int k = 0; k < dim; ++k)
          change[i] -= C(i, k) * R[k].val();
      for (double part = 1.; part > 1e-3; part /= 2.)
        {
          const auto old = a;
          for (unsigned int i = 0; i < dim; ++i)
            a[i].val() += part * change[i];
          if (const double after = size(unbalanced()); std::isfinite(after) && after <= before)
            return;
          a = old;
        }
    }

    static double
    size(const std::array<AD, dim> &R)
    {
      double sum = 0;
      for (const auto &entry : R)
        sum += entry.val() * entry.val();
      return sum;
    }

    const dealii::Tensor<1, dim> N;
    const unsigned int           n; ///< unknowns before a
    std::array<AD, dim>          a;
  };

  /// Forces of one cell's nodes and their derivatives, the jump condensed.
  struct CellForces
  {
    std::vector<double>        f;
    dealii::FullMatrix<double> K;
  };

  template <int dim>
  CellForces
  condensed(const Layers<dim> &layers, const std::vector<std::array<dealii::Tensor<1, dim>, (1 << dim)>> &gradients)
  {
    constexpr unsigned int n = (1 << dim) * dim;
    std::vector<AD>        f(n, AD(n + dim, 0.));
    for (std::size_t p = 0; p < layers.layers.size(); ++p)
      {
        const Matrix3 P = layers.piola(layers.layers[p]);
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int k = 0; k < dim; ++k)
            f[i] += layers.layers[p].V * P[i % dim][k] * gradients[p][i / dim][k];
      }
    const auto R = layers.unbalanced();
    const auto C = layers.compliance(R);
    CellForces result{std::vector<double>(n), dealii::FullMatrix<double>(n, n)};
    for (unsigned int i = 0; i < n; ++i)
      {
        result.f[i] = f[i].val();
        for (unsigned int j = 0; j < n; ++j)
          {
            result.K(i, j) = f[i].dx(j);
            for (unsigned int k = 0; k < dim; ++k)
              for (unsigned int l = 0; l < dim; ++l)
                result.K(i, j) -= f[i].dx(n + k) * C(k, l) * R[l].dx(j);
          }
      }
    return result;
  }

  const double moduli[2][2] = {{1, 2}, {3, 7}}; // of two_material_box()

  template <int dim>
  CellForces
  forces_of_cell(const SystemFixture<dim> &s, const ActiveCell<dim> &active, const Vector &u)
  {
    static const Materials::NeoHookean soft({moduli[0][0], moduli[0][1]}), stiff({moduli[1][0], moduli[1][1]});
    const auto                         size    = s.grid->box().cell_size;
    const auto                         moments = Mpm::cell_moments(*s.points, active, size, 2, false).of_material;
    const auto                         found   = Solid::find_interface<dim>(moments, {&soft, &stiff}, size);
    std::vector<Layer>                 layers;
    std::vector<std::array<dealii::Tensor<1, dim>, (1 << dim)>> gradients;
    constexpr unsigned int                                      n = (1 << dim) * dim;
    for (const auto &point : s.points->handler.particles_in_cell(active.cell))
      {
        const auto numbers = point.get_properties();
        const auto m       = s.points->material_of(numbers.data());
        const auto shapes  = s.grid->shape->at(active.index, point.get_reference_location());
        Layer      layer{numbers[s.points->volume.first], found ? found->side[m] : 0., moduli[m][0], moduli[m][1], {}};
        gradients.emplace_back();
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int k = 0; k < 3; ++k)
            layer.F[i][k] = AD(i == k ? 1. : 0.);
        for (unsigned int b = 0; b < n / dim; ++b)
          for (unsigned int k = 0; k < dim; ++k)
            {
              gradients.back()[b][k] = shapes.gradient[k][b];
              for (unsigned int i = 0; i < dim; ++i)
                layer.F[i][k] += AD(n + dim, b * dim + i, u(active.node[b] + i)) * shapes.gradient[k][b];
            }
        layers.push_back(layer);
      }
    return condensed<dim>(Layers<dim>(layers, found ? found->normal : dealii::Tensor<1, dim>(), n), gradients);
  }

  template <int dim>
  void
  check_tangent(const std::string &mpm)
  {
    SystemFixture<dim> s(two_material_box(dim, "subsection MPM\n set Interface = composite cells\n" + mpm + "end\n"));
    Vector             u = s.system->new_vector(), r = u;
    std::mt19937       random(7);
    for (auto &value : u)
      value = .1 * (random() / 4294967295. - .5);
    Matrix K;
    ASSERT_EQ(s.system->residual(r, u), StepStatus::ok);
    ASSERT_EQ(s.system->tangent(K, r, u), StepStatus::ok);
    dealii::FullMatrix<double> difference(u.size(), u.size());
    std::vector<double>        force(u.size());
    for (unsigned int i = 0; i < u.size(); ++i)
      for (unsigned int j = 0; j < u.size(); ++j)
        difference(i, j) = K.el(i, j);
    const double scale = difference.linfty_norm();
    for (const auto &active : s.grid->active_cells())
      {
        const auto cell    = forces_of_cell<dim>(s, active, u);
        const auto unknown = [&](const unsigned int i) { return active.node[i / dim] + i % dim; };
        for (unsigned int i = 0; i < cell.f.size(); ++i)
          {
            force[unknown(i)] += cell.f[i];
            for (unsigned int j = 0; j < cell.f.size(); ++j)
              difference(unknown(i), unknown(j)) -= cell.K(i, j);
          }
      }
    double worst = 0, largest = 0;
    for (unsigned int i = 0; i < u.size(); ++i)
      {
        keep_largest(worst, std::abs(s.system->unbalanced_forces()(i) + force[i]));
        keep_largest(largest, std::abs(force[i]));
      }
    std::cout << "dim " << dim << ": largest difference to automatic differentiation " << worst / largest
              << " (force), " << difference.linfty_norm() / scale << " (tangent)" << std::endl;
    EXPECT_LT(worst, 1e-12 * largest);
    EXPECT_LT(difference.linfty_norm(), 1e-10 * scale);
  }

  TEST(CompositeCells, TangentEqualsAutomaticDifferentiation)
  {
    check_tangent<2>(" set Cells = 3, 2\n set Points per cell = 3, 2\n");
    check_tangent<3>(" set Cells = 2, 2, 1\n set Points per cell = 2, 3, 2\n");
  }

  constexpr unsigned int voxels = 12; // along a cell

  /// 4 x 3 cells, each cut along the same line, @p contrast times stiffer beyond it; all sides follow an affine displacement.
  std::string
  alike_cells(const LabelFile &labels, const double contrast)
  {
    std::string supports;
    for (const std::string side : {"x-min", "x-max", "y-min", "y-max"})
      supports += " subsection " + side + "\n set Where = side " + side +
                  "\n set Displacement = 0.2*x+0.15*y; -0.1*x+0.25*y\n end\n";
    std::ostringstream stiff;
    stiff << " set Shear modulus = " << contrast << "\n set Bulk modulus = " << 2. * contrast << "\n";
    return "subsection Materials\n"
           " subsection soft\n set Law = neo-Hookean\n set Shear modulus = 1\n set Bulk modulus = 2\n end\n"
           " subsection stiff\n set Law = neo-Hookean\n" +
           stiff.str() +
           " end\nend\n"
           "subsection Bodies\n subsection all\n set Shape = image\n set File = " +
           labels.path.string() +
           "\n set Materials = 0: soft, 1: stiff\n end\nend\n"
           "subsection Supports\n" +
           supports +
           "end\n"
           "subsection MPM\n set Cells = 4, 3\n set Interface = composite cells\n set Integration = two moments\nend\n";
  }

  /// Mean P of the cells, from the voxels of one: N between the centroids, the jump of equal tractions.
  dealii::Tensor<2, 2>
  mean_stress(const std::function<bool(unsigned int, unsigned int)> &is_stiff, const double contrast)
  {
    double               share = 0;
    dealii::Tensor<1, 2> sum[2];
    const double         F[2][2] = {{1.2, .15}, {-.1, 1.25}};
    for (unsigned int x = 0; x < voxels; ++x)
      for (unsigned int y = 0; y < voxels; ++y)
        {
          share += is_stiff(x, y) / double(voxels * voxels);
          sum[is_stiff(x, y)] += dealii::Tensor<1, 2>({x + .5, y + .5}) / double(voxels * voxels);
        }
    dealii::Tensor<1, 2> N = sum[1] / share - sum[0] / (1. - share);
    N /= N.norm();
    std::vector<Layer> layers{{1. - share, share, 1., 2., {}}, {share, share - 1., contrast, 2. * contrast, {}}};
    for (auto &layer : layers)
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int k = 0; k < 3; ++k)
          layer.F[i][k] = AD(i < 2 && k < 2 ? F[i][k] : i == k);
    const Layers<2>      laminate(layers, N, 0);
    dealii::Tensor<2, 2> mean;
    for (const auto &layer : laminate.layers)
      {
        const Matrix3 P = laminate.piola(layer);
        for (unsigned int i = 0; i < 2; ++i)
          for (unsigned int k = 0; k < 2; ++k)
            mean[i][k] += layer.V * P[i][k].val();
      }
    return mean;
  }

  TEST(CompositeCells, CutAlikeAtAnyAngleAreExactLaminates)
  {
    for (const double angle : {0., .3, .8, 1.2, 2.1, 4.})
      for (const double contrast : {1., 10., 1e3, 1e6})
        {
          const auto is_stiff = [&](const unsigned int x, const unsigned int y) {
            return std::cos(angle) * (x % voxels + .5 - voxels / 2.) +
                     std::sin(angle) * (y % voxels + .5 - voxels / 2.) >
                   1.7;
          };
          const LabelFile  labels(4 * voxels, 3 * voxels, is_stiff);
          SystemFixture<2> s(alike_cells(labels, contrast));
          Vector           u;
          const auto       residuals = solve_exactly(s, u);
          EXPECT_LT(residuals.size(), 8u); // quadratic
          double worst = 0;
          for (std::size_t i = 0; i < s.grid->nodes.n_nodes(); ++i)
            {
              const auto node  = s.grid->nodes.node(i);
              const auto there = s.scene.supports[0].displacement.value(node.X, 1.);
              for (unsigned int d = 0; d < 2; ++d)
                keep_largest(worst, std::abs(u(node.unknown + d) - there[d]));
            }
          const double length = voxels * 1e-6;
          EXPECT_LT(worst, 1e-11 * length) << angle << " " << contrast;
          dealii::Tensor<2, 2> P; // sum_a f_a (x) X_a = V P
          for (std::size_t i = 0; i < s.grid->nodes.n_nodes(); ++i)
            {
              const auto node = s.grid->nodes.node(i);
              for (unsigned int d = 0; d < 2; ++d)
                for (unsigned int k = 0; k < 2; ++k)
                  P[d][k] -= s.system->unbalanced_forces()(node.unknown + d) * node.X[k] / (12. * length * length);
            }
          const auto exact = mean_stress(is_stiff, contrast);
          EXPECT_LT((P - exact).norm(), 1e-9 * exact.norm()) << angle << " " << contrast;
        }
  }
} // namespace
