// The solid cell: stiffness against differences and automatic differentiation, force against the energy, rigid motions.

#include "../base/keep_largest.h"
#include "../materials/automatic_derivatives.h"
#include "solid_fixture.h"

#include <deal.II/fe/fe_q.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;

  /// The first cell of a mesh of distorted cells: a quadrilateral in the plane, a ball in space.
  template <int dim>
  struct CellFixture : PartsFixture<dim>
  {
    using Motion = typename Fem::SolidCell<dim>::Motion;

    /// @param material entries of the material, @p fem of section FEM, @p top of the scene
    CellFixture(const std::string &material, const std::string &fem, const std::string &top = "")
      : PartsFixture<dim>(top + one("Materials", "gel", material) +
                          one("Bodies", "block",
                              dim == 2 ? "  set Shape = quadrilateral\n"
                                         "  set Corners = 0, 0, 1.1, 0.1, 0.9, 1.2, -0.1, 0.8\n" :
                                         "  set Shape = ball\n  set Centre = 0, 0, 0\n  set Radius = 1\n") +
                          "subsection FEM\n set Cells = " + (dim == 2 ? "1, 1" : "4, 4, 4") + "\n" + fem + "end\n")
      , fe(dealii::FE_Q<dim>(this->settings.degree), dim)
      , dofs(this->mesh.triangulation)
      , cell(this->scene, this->settings, fe, this->mesh.mapping())
    {
      dofs.distribute_dofs(fe);
      history = random_numbers(cell.n_points() * cell.n_history(), .1, 5);
      cell.reinit(dofs.begin_active(), history.data());
      motion.v_factor = 7.;
      motion.a_factor = this->settings.inertia ? 11. : 0.;
      motion.dt       = .3;
      v_known         = random_numbers(n(), 1., 2);
      a_known         = random_numbers(n(), 1., 3);
      move(random_numbers(n(), .1 / this->settings.degree, 1));
    }

    unsigned int
    n() const
    {
      return fe.n_dofs_per_cell();
    }

    void
    move(const std::vector<double> &u)
    {
      motion.u = motion.v = u;
      motion.a.assign(this->settings.inertia ? n() : 0, 0.);
      for (unsigned int i = 0; i < n(); ++i)
        {
          motion.v[i] = motion.v_factor * u[i] + v_known[i];
          if (this->settings.inertia)
            motion.a[i] = motion.a_factor * u[i] + a_known[i];
        }
    }

    /// Sets the unknowns to values of a function of the place and the component.
    template <typename Function>
    std::vector<double>
    interpolate(const Function &function) const
    {
      std::vector<double> values(n());
      for (unsigned int i = 0; i < n(); ++i)
        values[i] = function(this->mesh.mapping().transform_unit_to_real_cell(dofs.begin_active(),
                                                                              fe.unit_support_point(i)),
                             fe.system_to_component_index(i).first);
      return values;
    }

    dealii::Vector<double>
    force()
    {
      dealii::Vector<double> f(n());
      EXPECT_EQ(cell.force(motion, f), StepStatus::ok);
      return f;
    }

    dealii::FullMatrix<double>
    stiffness()
    {
      dealii::FullMatrix<double> K(n());
      EXPECT_EQ(cell.stiffness(motion, K), StepStatus::ok);
      return K;
    }

    /// Derivative along unknown @p i of what @p function returns, by central differences of fourth order.
    template <typename Function>
    auto
    difference(const unsigned int i, const Function &function)
    {
      const double h  = 2e-4;
      const auto   u  = motion.u;
      const auto   at = [&](const double steps) {
        auto moved = u;
        moved[i] += steps * h;
        move(moved);
        return function();
      };
      const auto result = [&](const auto p, const auto m, const auto pp, const auto mm) {
        return (8. * (p - m) - (pp - mm)) / (12. * h);
      };
      const auto p = at(1), m = at(-1), pp = at(2), mm = at(-2);
      move(u);
      if constexpr (std::is_same_v<decltype(function()), double>)
        return result(p, m, pp, mm);
      else
        {
          std::vector<double> all(n());
          for (unsigned int a = 0; a < n(); ++a)
            all[a] = result(p[a], m[a], pp[a], mm[a]);
          return all;
        }
    }

    dealii::FESystem<dim>   fe;
    dealii::DoFHandler<dim> dofs;
    Fem::SolidCell<dim>     cell;
    std::vector<double>     history, v_known, a_known;
    Motion                  motion;
  };

  const std::string elastic = "  set Shear modulus = 2\n  set Bulk modulus = 5\n";
  const std::string prony =
    "  set Law = Prony\n" + elastic +
    "  set Relaxation times = 0.2, 3\n  set Shear parts g = 0.2, 0.3\n  set Bulk parts k = 0.1, 0.4\n";
  const std::string small = " set Kinematics = small\n", projected = " set Dilatation = projected\n";

  std::string
  viscous(const std::string &law)
  {
    return elastic + "  set Viscosity = 0.7\n  set Viscous operator = " + law + "\n";
  }

  std::string
  degree(const unsigned int k)
  {
    return " set Degree = " + std::to_string(k) + "\n";
  }

  struct Variant
  {
    std::string name, material, fem, top;
  };

  /// Everything that changes a cell's equations, in two dimensions and, where it has a meaning, in three.
  std::vector<Variant>
  variants(const int dim)
  {
    std::vector<Variant> all;
    for (const std::string &kinematics : {std::string(), small})
      for (const std::string &dilatation : {std::string(), projected})
        {
          const std::string fem = kinematics + dilatation, name = fem + " ";
          all.push_back({name + "elastic", elastic, fem, ""});
          all.push_back({name + "linear elastic", "  set Law = linear elastic\n" + elastic, fem, ""});
          for (const std::string law : {"central", "morris", "deviatoric"})
            all.push_back({name + law, viscous(law), fem, ""});
          all.push_back({name + "Prony", prony, fem, ""});
          all.push_back({name + "inertia", elastic + "  set Density = 3\n", fem + " set Inertia = true\n", ""});
        }
    if (dim == 2)
      for (const std::string &kinematics : {std::string(), small})
        all.push_back({kinematics + " plane stress", elastic, kinematics, "set Plane = stress\nset Thickness = 0.3\n"});
    return all;
  }

  template <int dim>
  void
  expect_exact_stiffness(const unsigned int k, const std::vector<Variant> &all)
  {
    double worst = 0., worst_symmetry = 0.;
    for (const Variant &variant : all)
      {
        CellFixture<dim> s(variant.material, degree(k) + variant.fem, variant.top);
        const auto       K     = s.stiffness();
        const double     scale = K.linfty_norm();
        double           error = 0., asymmetry = 0.;
        for (unsigned int b = 0; b < s.n(); ++b)
          {
            const auto column = s.difference(b, [&s] { return s.force(); });
            for (unsigned int a = 0; a < s.n(); ++a)
              {
                keep_largest(error, std::abs(K(a, b) - column[a]) / scale);
                keep_largest(asymmetry, std::abs(K(a, b) - K(b, a)) / scale);
              }
          }
        EXPECT_LT(error, 1e-9) << variant.name << ", degree " << k << ", " << dim << "D";
        if (s.cell.symmetric())
          {
            EXPECT_LT(asymmetry, 1e-14) << variant.name << ", degree " << k << ", " << dim << "D";
          }
        else
          EXPECT_GT(asymmetry, 1e-6) << variant.name << ": says that it is not symmetric";
        keep_largest(worst, error);
        keep_largest(worst_symmetry, s.cell.symmetric() ? asymmetry : 0.);
      }
    std::cout << dim << "D, degree " << k << ": stiffness and differences agree to " << worst << ", symmetric to "
              << worst_symmetry << std::endl;
  }

  TEST(SolidCell, StiffnessIsTheDerivativeOfTheForceIn2D)
  {
    for (const unsigned int k : {1, 2, 3})
      expect_exact_stiffness<2>(k, variants(2));
  }

  TEST(SolidCell, StiffnessIsTheDerivativeOfTheForceIn3D)
  {
    expect_exact_stiffness<3>(1, variants(3));
    const auto all = variants(3);
    expect_exact_stiffness<3>(2, {all[0], all[7], all[8], all[9], all[11], all[14]});
  }

  template <int dim>
  void
  expect_force_of_the_energy()
  {
    for (const Variant &variant : variants(dim))
      if (variant.material.find("Viscosity") == std::string::npos &&
          variant.material.find("Density") == std::string::npos && variant.material.find("Prony") == std::string::npos)
        for (const unsigned int k : {1, 2})
          {
            CellFixture<dim> s(variant.material, degree(k) + variant.fem, variant.top);
            const auto       f = s.force();
            for (unsigned int a = 0; a < s.n(); ++a)
              EXPECT_NEAR(s.difference(a, [&s] { return s.force(), s.cell.strain_energy(); }), f[a],
                          1e-9 * f.linfty_norm())
                << variant.name << ", degree " << k << ", " << dim << "D, unknown " << a;
          }
  }

  TEST(SolidCell, ForceIsTheDerivativeOfTheStrainEnergy)
  {
    expect_force_of_the_energy<2>();
    expect_force_of_the_energy<3>();
  }

  /// f = int P Grad N and K = int Grad N A Grad N, with P and A by automatic differentiation of the energy (12).
  template <int dim>
  void
  expect_automatic_derivatives(const unsigned int k)
  {
    CellFixture<dim>                             s(elastic, degree(k));
    const AutomaticDerivatives::NeoHookeanEnergy energy{2., 5.};
    const auto                                   f = s.force();
    const auto                                   K = s.stiffness();
    dealii::Vector<double>                       f_exact(s.n());
    dealii::FullMatrix<double>                   K_exact(s.n());
    for (unsigned int q = 0; q < s.cell.n_points(); ++q)
      {
        dealii::Tensor<2, 3> F         = dealii::unit_symmetric_tensor<3>();
        const auto           gradient  = [&](const unsigned int a) { return s.cell.values().shape_grad(a, q); };
        const auto           component = [&](const unsigned int a) { return s.fe.system_to_component_index(a).first; };
        for (unsigned int a = 0; a < s.n(); ++a)
          for (unsigned int d = 0; d < dim; ++d)
            F[component(a)][d] += s.motion.u[a] * gradient(a)[d];
        const auto exact = AutomaticDerivatives::differentiate(energy, F);
        for (unsigned int a = 0; a < s.n(); ++a)
          for (unsigned int i = 0; i < dim; ++i)
            {
              f_exact(a) += s.cell.volume(q) * exact.P[component(a)][i] * gradient(a)[i];
              for (unsigned int b = 0; b < s.n(); ++b)
                for (unsigned int j = 0; j < dim; ++j)
                  K_exact(a, b) += s.cell.volume(q) * gradient(a)[i] * exact.A[component(a)][i][component(b)][j] *
                                   gradient(b)[j];
            }
      }
    f_exact -= f;
    K_exact.add(-1., K);
    EXPECT_LT(f_exact.linfty_norm(), 1e-13 * f.linfty_norm());
    EXPECT_LT(K_exact.linfty_norm(), 1e-13 * K.linfty_norm());
  }

  TEST(SolidCell, EqualsAutomaticDifferentiation)
  {
    expect_automatic_derivatives<2>(1);
    expect_automatic_derivatives<2>(2);
    expect_automatic_derivatives<3>(2);
  }

  /// A rotation by .8 rad about z and a shift.
  template <int dim>
  double
  turned(const dealii::Point<dim> &X, const unsigned int c)
  {
    const double angle = .8;
    return c == 0 ? std::cos(angle) * X[0] - std::sin(angle) * X[1] + .3 :
           c == 1 ? std::sin(angle) * X[0] + std::cos(angle) * X[1] - .2 :
                    X[dim - 1];
  }

  /// A turned and turning cell: velocity omega x (place).
  template <int dim>
  void
  turn(CellFixture<dim> &s, const double omega, const bool is_small)
  {
    const auto place = [is_small](const dealii::Point<dim> &X, const unsigned int c) {
      return is_small ? X[c] : turned(X, c);
    };
    s.motion.u = s.interpolate([&](const auto &X, const unsigned int c) { return place(X, c) - X[c]; });
    s.motion.v = s.interpolate([&](const auto &X, const unsigned int c) {
      return c == 0 ? -omega * place(X, 1) : c == 1 ? omega * place(X, 0) : 0.;
    });
  }

  template <int dim>
  void
  expect_no_force_of_rigid_motion()
  {
    for (const std::string law : {"central", "deviatoric", "morris"})
      for (const std::string &fem : {std::string(), projected, small, small + projected})
        {
          CellFixture<dim> s(viscous(law), degree(2) + fem);
          turn(s, 0., fem.find(small) == 0);
          EXPECT_LT(s.force().linfty_norm(), 1e-13) << law << fem << ": at rest";
          turn(s, 2., fem.find(small) == 0);
          const auto f = s.force();
          if (law != "morris")
            {
              EXPECT_LT(f.linfty_norm(), 1e-12) << law << fem;
              continue;
            }
          // mu grad v takes turning for shear: it dissipates mu W : W = 2 mu omega^2.
          double power = 0., volume = 0.;
          for (unsigned int a = 0; a < s.n(); ++a)
            power += f[a] * s.motion.v[a];
          for (unsigned int q = 0; q < s.cell.n_points(); ++q)
            volume += s.cell.volume(q);
          EXPECT_NEAR(power, 2. * .7 * 4. * volume, 1e-12) << fem;
        }
  }

  TEST(SolidCell, RigidMotionsGiveNoForce)
  {
    expect_no_force_of_rigid_motion<2>();
    expect_no_force_of_rigid_motion<3>();
  }

  TEST(SolidCell, UniformDilatationRateGivesTheBulkViscosity)
  {
    // Cauchy stress of L = I: mu (5/3 tr D) = 5 mu (central, in space), mu (morris), 0 (deviatoric).
    for (const auto &[law, stress] : std::map<std::string, double>{{"central", 5.}, {"morris", 1.}, {"deviatoric", 0.}})
      {
        CellFixture<3> s(viscous(law), degree(2));
        s.motion.u.assign(s.n(), 0.);
        s.motion.v = s.interpolate([](const auto &X, const unsigned int c) { return X[c]; });
        s.force();
        for (unsigned int q = 0; q < s.cell.n_points(); ++q)
          for (unsigned int i = 0; i < 3; ++i)
            for (unsigned int j = 0; j <= i; ++j)
              EXPECT_NEAR(s.cell.cauchy_stress(q)[i][j], i == j ? .7 * stress : 0., 1e-12) << law;
      }
  }

  TEST(SolidCell, UniformAccelerationFeelsTheMass)
  {
    CellFixture<2> s(elastic + "  set Density = 3\n", degree(2) + " set Inertia = true\n", "set Thickness = 0.5\n");
    s.motion.u.assign(s.n(), 0.);
    s.motion.a        = s.interpolate([](const auto &, const unsigned int c) { return c == 0 ? 2. : 0.; });
    const auto f      = s.force();
    double     sum[2] = {0., 0.}, volume = 0.;
    for (unsigned int a = 0; a < s.n(); ++a)
      sum[s.fe.system_to_component_index(a).first] += f[a];
    for (unsigned int q = 0; q < s.cell.n_points(); ++q)
      volume += s.cell.volume(q);
    // Area of the quadrilateral by its diagonals: |(0.9, 1.2) x (-1.2, 0.7)| / 2.
    EXPECT_NEAR(volume, .5 * .5 * (.9 * .7 + 1.2 * 1.2), 1e-14);
    EXPECT_NEAR(sum[0], 3. * 2. * volume, 1e-13);
    EXPECT_NEAR(sum[1], 0., 1e-13);
  }

  TEST(SolidCell, AnInvertedCellIsReported)
  {
    for (const std::string &fem : {std::string(), projected})
      {
        CellFixture<2> s(elastic, degree(1) + fem);
        s.motion.u = s.interpolate([](const auto &X, const unsigned int c) { return c == 0 ? -2. * X[0] : 0.; });
        dealii::Vector<double> f(s.n());
        EXPECT_EQ(s.cell.force(s.motion, f), StepStatus::inverted_point);
      }
  }
} // namespace
