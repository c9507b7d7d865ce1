#pragma once

#include "../particles/scene_fixture.h"

#include <stroma/sph/nsph_method.h>

#include <gtest/gtest.h>

#include <cmath>

namespace DegradedBlock
{
  using namespace Stroma;
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  /// A block with a cell in its middle, held at its lower end, with factors that fall across it.
  template <int dim>
  struct Block
  {
    explicit Block(const double jitter, const double stabilisation = 1.)
      : fixture(text())
    {
      Sph::Settings settings;
      settings.arrangement.spacing = 1.;
      settings.arrangement.jitter  = jitter;
      settings.stabilisation       = stabilisation;
      system = std::make_unique<Sph::System<dim>>(fixture.scene, settings, Sph::Dynamics::overdamped, 1., timers);
      system->arrange();
      EXPECT_EQ(system->update_geometry(true), StepStatus::ok);
      system->set_step(0., 1.);
    }

    static std::string
    text()
    {
      const auto at = [](const std::string &x) { return x + ", " + x + (dim == 2 ? "" : ", " + x); };
      return "subsection Materials\n subsection gel\n  set Law = hypoelastic\n  set Young's modulus = 1\n"
             "  set Poisson's ratio = 0.3\n  set Viscosity = 1\n end\nend\n"
             "subsection Bodies\n subsection block\n  set Shape = box\n  set Upper corner = " +
             at(dim == 2 ? "16" : "12") + "\n end\n subsection cell\n  set Shape = ball\n  set Centre = " + at("6") +
             "\n  set Radius = 2\n  set Rigid = true\n end\nend\n" + (dim == 2 ? "set Thickness = 1\n" : "") +
             "subsection Migration\n subsection run\n  set Body = cell\n  set Force = 1\n end\nend\n"
             "subsection Degradation\n subsection front\n  set Rate = 1\n  set Decay length = 1\n  set Width = 2\n"
             "  set Initial width = 0\n end\nend\n" +
             clamped({"y-min"});
    }

    template <typename Factor>
    void
    set_factors(const Factor &f)
    {
      auto &particles = system->particles;
      for (unsigned int i = 0; i < particles.n_free; ++i)
        particles.intact[i] = f(particles.X[i]);
      system->neighbours->update_ghosts(particles.intact);
      system->elasticity->update_degradation();
    }

    ParticleScene<dim>                fixture;
    Timers                            timers;
    std::unique_ptr<Sph::System<dim>> system;
  };

  /// Fluid, solid, and a narrow range of everything between.
  template <int dim>
  double
  front(const dealii::Point<dim> &X)
  {
    return std::min(1., std::max(0., .3 * (X[0] - 5. + .4 * X[1])));
  }

  template <int dim>
  Tensor<1, dim>
  some_velocity(const dealii::Point<dim> &X)
  {
    Tensor<1, dim> v;
    for (unsigned int c = 0; c < dim; ++c)
      v[c] = std::sin(1.3 * X[0] + 2. * c) * std::cos(.9 * X[1] - c);
    return v;
  }

  template <int dim>
  SymmetricTensor<2, dim>
  some_stress(const dealii::Point<dim> &X)
  {
    SymmetricTensor<2, dim> S;
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = a; b < dim; ++b)
        S[a][b] = std::cos(.7 * X[0] + a + 2. * b) + .2 * X[1];
    return S;
  }
} // namespace DegradedBlock
