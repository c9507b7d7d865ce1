#pragma once

#include <stroma/materials/viscosity.h>
#include <stroma/output/point_state.h>
#include <stroma/solid/stress_measures.h>
#include <stroma/sph/system.h>

#include <vector>

namespace Stroma::Sph
{
  /// Stress of viscosity alone with velocity gradient @p G, as finite elements have it [Pa].
  inline dealii::SymmetricTensor<2, 3>
  friction_stress(const Materials::Medium &medium, const dealii::Tensor<2, 3> &G)
  {
    return symmetrize(Materials::viscous_stress(medium, G));
  }

  /// Where values of owned particle @p i belong to: of solids its undeformed place, of fluids its place now, as finite
  /// elements have them.
  template <int dim>
  dealii::Point<dim>
  place_of(const System<dim> &system, const unsigned int i)
  {
    return system.has_solids() ? system.particles.X[i] : system.particles.x[i];
  }

  /// The states of the owned particles. Stresses include those of viscosity, with the gradient that the particles see.
  template <int dim>
  class StateReader
  {
  public:
    explicit StateReader(const System<dim> &system)
      : system(system)
    {
      if (system.is_viscous())
        {
          v_gradient.resize(system.pairs.n_rows());
          system.elasticity->velocity_gradient(v_gradient, system.with_walls(system.particles.v));
        }
    }

    Output::PointState
    operator()(const unsigned int i) const
    {
      const auto        &particles = system.particles;
      Output::PointState state;
      state.X        = Output::place_of<dim>(place_of(system, i));
      state.x        = Output::place_of<dim>(particles.x[i]);
      state.u        = Output::in_space<dim>(system.displacement(i));
      state.v        = Output::in_space<dim>(particles.v[i]);
      state.V0       = system.thickness() * particles.V0[i];
      state.J        = particles.J[i];
      state.material = system.material_of(i);
      state.density  = system.constitutions[state.material].rho / state.J;
      state.is_fixed = particles.is_fixed(i);
      state.intact   = particles.intact.empty() ? 1. : particles.intact[i];
      state.pressure = system.constitutions[state.material].pressure(state.J);
      if (i < system.pairs.n_rows())
        state.kernel_sum = system.pairs.kernel_sum(system.particles, i);
      if (i < v_gradient.size())
        state.v_gradient = Output::in_space<dim>(v_gradient[i]);
      state.cauchy = solid_stress(i) - state.pressure * dealii::unit_symmetric_tensor<3>();
      if (i < v_gradient.size())
        state.cauchy += friction_stress(system.scene.media[state.material], state.v_gradient);
      if (system.has_solids())
        state.pressure = Solid::pressure(state.cauchy);
      return state;
    }

  private:
    /// The deviatoric stress of Hooke's law; 0 for fluids.
    dealii::SymmetricTensor<2, 3>
    solid_stress(const unsigned int i) const
    {
      dealii::SymmetricTensor<2, 3> stress;
      if (!system.has_solids())
        return stress;
      const auto &S = system.particles.S[i];
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = a; b < dim; ++b)
          stress[a][b] = S[a][b];
      if (dim == 2)
        stress[2][2] = -trace(S);
      return stress;
    }

    const System<dim>                  &system;
    std::vector<dealii::Tensor<2, dim>> v_gradient; ///< of the rows, where something is viscous [1/s]
  };
} // namespace Stroma::Sph
