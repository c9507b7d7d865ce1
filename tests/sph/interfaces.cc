// Solids of different stiffness that meet: the operators, and the stresses of the first rows on either side.

#include "../base/keep_largest.h"
#include "method_fixture.h"

#include <stroma/sph/nsph_method.h>

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <sstream>

namespace
{
  using namespace Stroma;
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  std::string
  number(const double value)
  {
    std::ostringstream text;
    text.precision(17);
    text << "(" << value << ")";
    return text.str();
  }

  /// Soft material of shear modulus 1 and stiff one of shear modulus @p contrast; the relaxation time of both is 1 s.
  std::string
  materials(const double contrast, const double nu)
  {
    std::string text = "subsection Materials\n";
    for (const auto &[name, G] : {std::pair<std::string, double>{"soft", 1.}, {"stiff", contrast}})
      text += " subsection " + name + "\n  set Law = hypoelastic\n  set Shear modulus = " + number(G) +
              "\n  set Bulk modulus = " + number(2. * G * (1. + nu) / (3. * (1. - 2. * nu))) +
              "\n  set Viscosity = " + number(G) + "\n end\n";
    return text + "end\n";
  }

  std::string
  settings(const double spacing)
  {
    return "subsection NSPH\n set Scheme = backward Euler\n set Spacing = " + number(spacing) +
           "\nend\nsubsection Linear solver\n set Tolerance = 1e-9\nend\n";
  }

  const std::string inclusion =
    "subsection Bodies\n subsection matrix\n  set Shape = box\n  set Lower corner = -2, -2\n  set Upper corner = 2, 2\n"
    "  set Material = soft\n end\n subsection inclusion\n  set Shape = ball\n  set Centre = 0, 0\n  set Radius = 1\n"
    "  set Material = stiff\n end\nend\n";

  const std::string layers =
    "subsection Bodies\n subsection lower\n  set Shape = box\n  set Lower corner = -1, -1\n  set Upper corner = 1, 0\n"
    "  set Material = soft\n end\n subsection upper\n  set Shape = box\n  set Lower corner = -1, 0\n  set Upper corner = 1, 1\n"
    "  set Material = stiff\n end\nend\n";

  std::string
  moved_sides(const std::vector<std::string> &sides, const std::string &displacement)
  {
    std::string text = "subsection Supports\n";
    for (const auto &side : sides)
      text += " subsection " + side + "\n  set Where = side " + side + "\n  set Displacement = " + displacement +
              "\n end\n";
    return text + "end\n";
  }

  /// A circular inclusion of radius 1 in a plane under a remote stress sigma_xx = 1 Pa (Muskhelishvili's potentials, plane strain).
  struct Inclusion
  {
    Inclusion(const double contrast, const double nu)
      : kappa(3. - 4. * nu)
      , ratio(contrast)
    {
      const double g = 1. / contrast;
      A              = q * (g - 1.) / (g + kappa);
      B              = p * ((kappa - 1.) - g * (kappa - 1.)) / (1. + .5 * g * (kappa - 1.));
      D              = p + .5 * B;
      E              = -q * (1. + kappa) / (g + kappa);
    }

    /// Displacement of the matrix [m].
    std::string
    outside() const
    {
      const std::string r2 = "(x^2+y^2)", even = number((kappa - 1.) * p) + "-" + number(B) + "/" + r2,
                        odd = number(q) + "+" + number(kappa * A) + "/" + r2,
                        far = number(A) + "*(1/" + r2 + "^2-1/" + r2 + "^3)";
      return "1e-12*t/2*((" + even + "+" + odd + ")*x+" + far + "*(x^3-3*x*y^2)); 1e-12*t/2*((" + even + "-(" + odd +
             "))*y+" + far + "*(3*x^2*y-y^3))";
    }

    SymmetricTensor<2, 2>
    stress(const dealii::Point<2> &X) const
    {
      const std::complex<double> z(X[0], X[1]);
      const bool                 is_inside  = std::abs(z) < 1.;
      const auto                 dphi       = is_inside ? D : p - A / (z * z);
      const auto                 ddphi      = is_inside ? 0. : 2. * A / (z * z * z);
      const auto                 dpsi       = is_inside ? E : -q - B / (z * z) - 3. * A / (z * z * z * z);
      const double               sum        = 4. * std::real(dphi);
      const auto                 difference = 2. * (std::conj(z) * ddphi + dpsi); // sigma_yy - sigma_xx + 2 i sigma_xy
      SymmetricTensor<2, 2>      sigma;
      sigma[0][0] = .5 * (sum - difference.real());
      sigma[1][1] = .5 * (sum + difference.real());
      sigma[0][1] = .5 * difference.imag();
      return sigma;
    }

    static constexpr double p = .25, q = .5;
    const double            kappa, ratio;
    double                  A, B, D, E;
  };

  /// Elastic stresses over 1e-6 of @p text after one long step; calls visit(X, material, stress).
  template <typename Visit>
  void
  visit_stresses(const std::string &text, const Visit &visit)
  {
    ParticleScene<2>      scene(text);
    Timers                timers;
    Solvers::StepSettings steps;
    steps.end_time = 1e6;
    Open<Sph::NsphMethod<2>> method(scene.parameters, scene.scene, steps, timers);
    StepWork                 work;
    method.setup(nullptr);
    const double t = 1e6; // of the displacements 1e-12 t; friction is left over as 1/t
    EXPECT_EQ(method.advance(0., t, work), StepStatus::ok);
    const auto  sigma     = method.system->stresses();
    const auto &particles = method.system->particles;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      visit(particles.X[i], particles.material_of(i), 1e6 * sigma[i]);
  }

  /// Mean and root mean square of what the stresses of a set of particles miss, over the exact ones.
  struct Misfit
  {
    void
    add(const SymmetricTensor<2, 2> &sigma, const SymmetricTensor<2, 2> &exact)
    {
      const double scale = exact * exact;
      sums[0] += (sigma - exact) * exact / scale;
      sums[1] += (sigma - exact) * (sigma - exact) / scale;
      sums[2] += 1.;
    }
    double
    mean() const
    {
      return total(0) / total(2);
    }
    double
    rms() const
    {
      return std::sqrt(total(1) / total(2));
    }
    double
    total(const unsigned int k) const
    {
      return dealii::Utilities::MPI::sum(sums[k], MPI_COMM_WORLD);
    }
    double sums[3] = {0., 0., 0.};
  };

  TEST(Interfaces, MpiFirstRowsOfAnInclusion)
  {
    const double nu = .3, dp = .1;
    for (const double contrast : {10., 1e4})
      {
        const Inclusion exact(contrast, nu);
        Misfit          stiff_row, soft_row, inside;
        visit_stresses(materials(contrast, nu) + inclusion +
                         moved_sides({"x-min", "x-max", "y-min", "y-max"}, exact.outside()) + settings(dp),
                       [&](const auto &X, const unsigned int material, const auto &sigma) {
                         const double r = X.norm();
                         if (r < 1. + dp && r > 1. - dp)
                           (material == 1 ? stiff_row : soft_row).add(sigma, exact.stress(X));
                         if (r < .7)
                           inside.add(sigma, exact.stress(X));
                       });
        EXPECT_LT(std::abs(stiff_row.mean()), .03) << contrast;
        EXPECT_LT(std::abs(soft_row.mean()), .03) << contrast;
        EXPECT_LT(std::abs(inside.mean()), .01) << contrast;
        EXPECT_LT(stiff_row.rms(), .1) << contrast;
        EXPECT_LT(soft_row.rms(), .1) << contrast;
      }
  }

  TEST(Interfaces, MpiLayersInSeriesAndInParallel)
  {
    // nu = 0, so each layer has its own stress along it; across both have the same, G e and 2 G e in shear and stretch.
    for (const double contrast : {10., 100., 1e4})
      {
        double     series = 0., parallel = 0.;
        const auto text = materials(contrast, 0.) + layers + settings(.1);
        visit_stresses(text + moved_sides({"x-min", "x-max", "y-min", "y-max"}, "1e-12*t*x; 0"),
                       [&](const auto &X, const unsigned int material, const auto &sigma) {
                         const double exact = 2. * (material == 1 ? contrast : 1.);
                         if (std::abs(X[0]) < .6) // beside the sides areas do not balance along the interface
                           keep_largest(parallel, std::abs(sigma[0][0] / exact - 1.));
                       });
        const double shear = 2. / (1. + 1. / contrast); // of the sides' displacement over the two layers' height
        visit_stresses(text + "subsection Periodic\n set Directions = x\nend\n" +
                         moved_sides({"y-min", "y-max"}, "1e-12*t*y; 1e-12*t*y"),
                       [&](const auto &, const unsigned int, const auto &sigma) {
                         keep_largest(series, std::abs(sigma[0][1] / shear - 1.));
                         keep_largest(series, std::abs(sigma[1][1] / (2. * shear) - 1.));
                       });
        EXPECT_LT(dealii::Utilities::MPI::max(series, MPI_COMM_WORLD), .01) << contrast;
        EXPECT_LT(dealii::Utilities::MPI::max(parallel, MPI_COMM_WORLD), .01) << contrast;
      }
  }

  /// Disordered particles of a plane with an inclusion, and random velocities and stresses.
  struct DisorderedBed
  {
    explicit DisorderedBed(const double contrast)
      : scene(materials(contrast, .3) + inclusion + "subsection Periodic\n set Directions = x, y\nend\n")
    {
      Sph::Settings sph;
      sph.arrangement.spacing = .2;
      sph.arrangement.jitter  = .2;
      system = std::make_unique<Sph::System<2>>(scene.scene, sph, Sph::Dynamics::overdamped, 1., timers);
      system->arrange();
      for (unsigned int k = 0; k < 3; ++k)
        EXPECT_EQ(system->update_geometry(true), StepStatus::ok);
      system->set_step(0., 1.);
    }

    Sph::System<2>::Velocities
    random(const unsigned int seed) const
    {
      Sph::System<2>::Velocities v(system->pairs.n_points());
      for (unsigned int i = 0; i < system->particles.size(); ++i)
        for (unsigned int c = 0; c < 2; ++c)
          v[i][c] = std::sin(1e4 * (system->particles.id[i] + .37 * c + .71 * seed));
      return v;
    }

    double
    power(const Sph::System<2>::Velocities &f, const Sph::System<2>::Velocities &v) const
    {
      double sum = 0.;
      for (unsigned int i = 0; i < system->particles.n_free; ++i)
        sum += f[i] * v[i];
      return dealii::Utilities::MPI::sum(sum, MPI_COMM_WORLD);
    }

    ParticleScene<2>                scene;
    Timers                          timers;
    std::unique_ptr<Sph::System<2>> system;
  };

  TEST(Interfaces, MpiStiffnessIsSymmetricPositiveAndKeepsMomentum)
  {
    for (const double contrast : {3., 1e4})
      {
        const DisorderedBed        bed(contrast);
        Sph::StepOperator<2>       A(*bed.system);
        const auto                 a = bed.random(1), b = bed.random(2);
        Sph::System<2>::Velocities Aa, Ab;
        A.set_step(10.);
        A.force(Aa, a);
        A.force(Ab, b);
        const double size = std::sqrt(bed.power(Aa, Aa) * bed.power(b, b));
        EXPECT_NEAR(bed.power(Aa, b), bed.power(Ab, a), 1e-13 * size);
        EXPECT_LT(bed.power(Aa, a), 0.);
        EXPECT_LT(bed.power(Ab, b), 0.);
        Sph::System<2>::Velocities along(a.size());
        for (auto &v : along)
          v[0] = 1.;
        EXPECT_LT(std::abs(bed.power(Aa, along)), 1e-13 * size);
      }
  }

  TEST(Interfaces, MpiForcesAreMinusTheAdjointOfTheGradient)
  {
    const DisorderedBed bed(10.);
    auto               &system = *bed.system;
    auto               &p      = system.particles;
    const auto          v      = bed.random(3);
    for (unsigned int i = 0; i < p.n_owned; ++i)
      for (unsigned int c = 0; c < 3; ++c)
        p.S[i].access_raw_entry(c) = std::sin(1e3 * (p.id[i] + .29 * c));
    system.neighbours->update_ghosts(p.S);
    Sph::System<2>::Velocities f;
    system.state_forces(f, 1.);
    std::vector<Tensor<2, 2>> L(system.pairs.n_rows());
    system.elasticity->velocity_gradient(L, v);
    double work = 0., size = 0.;
    for (unsigned int i = 0; i < p.n_free; ++i)
      {
        work += p.volume(i) * scalar_product(Tensor<2, 2>(p.S[i]), L[i]);
        size += p.volume(i) * p.S[i].norm() * L[i].norm();
      }
    work = dealii::Utilities::MPI::sum(work, MPI_COMM_WORLD);
    size = dealii::Utilities::MPI::sum(size, MPI_COMM_WORLD);
    EXPECT_NEAR(bed.power(f, v), -work, 1e-13 * size);
  }

  TEST(Interfaces, MpiVolumesAtABorderAreThoseOfTheirSide)
  {
    ParticleScene<2>               scene(materials(10., .3) + inclusion);
    Particles::ArrangementSettings settings;
    settings.spacing         = .1;
    settings.follows_borders = true;
    const auto particles     = Particles::arrange(scene.scene, settings, scene.movers, 0.);
    double     volumes[2] = {0., 0.}, least = 1., largest = 0.;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      {
        volumes[particles.material_of(i)] += particles.V0[i];
        least = std::min(least, particles.V0[i]);
        keep_largest(largest, particles.V0[i]);
        if (std::abs(particles.X[i].norm() - 1.) > .15)
          {
            EXPECT_NEAR(particles.V0[i], .01, 2e-5); // whole cells; of equal ones, 316 would share the circle
          }
      }
    dealii::Utilities::MPI::sum(volumes, MPI_COMM_WORLD, volumes);
    EXPECT_NEAR(volumes[1], dealii::numbers::PI, 1e-12);
    EXPECT_NEAR(volumes[0] + volumes[1], 16., 1e-12);
    EXPECT_LT(dealii::Utilities::MPI::min(least, MPI_COMM_WORLD), .007);
    EXPECT_GT(dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD), .013);
  }
} // namespace
