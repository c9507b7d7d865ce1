#pragma once

#include <stroma/materials/viscosity.h>
#include <stroma/output/state_fields.h>
#include <stroma/solid/stress_measures.h>
#include <stroma/sph/system.h>

#include <algorithm>
#include <string>
#include <vector>

namespace Stroma::Sph
{
  /// What is known of a particle, or of a place between particles, in the committed state.
  template <int dim> struct ParticleState
  {
    dealii::Tensor<1, dim>        u, v;                   ///< displacement [m], velocity [m/s]
    dealii::Tensor<2, dim>        u_gradient, v_gradient; ///< over the undeformed place; over the place now [1/s]
    dealii::SymmetricTensor<2, 3> cauchy;                 ///< [Pa]
    double                        pressure   = 0.; ///< of solids -tr/3 of the stress, of fluids that of its state [Pa]
    double                        V0         = 0.; ///< [m^3]
    double                        J          = 1.;
    double                        density    = 0.; ///< now [kg/m^3]
    double                        kernel_sum = 0.;
    unsigned int                  material   = 0;
    bool                          is_fixed   = false;
  };

  template <int dim>
  using StateField = Output::StateField<ParticleState<dim>>;

  /// Stress of viscosity alone with velocity gradient @p G, as finite elements have it [Pa].
  template <int dim>
  dealii::SymmetricTensor<2, 3>
  friction_stress(const Materials::Medium &medium, const dealii::Tensor<2, dim> &G)
  {
    dealii::Tensor<2, 3> in_space;
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = 0; b < dim; ++b)
        in_space[a][b] = G[a][b];
    return symmetrize(Materials::viscous_stress(medium, in_space));
  }

  /// The states of the owned particles. Stresses include those of viscosity, with the gradient that the particles see.
  template <int dim> class StateReader
  {
  public:
    explicit StateReader(const System<dim> &system) : system(system)
    {
      if (system.is_viscous())
      {
        v_gradient.resize(system.pairs.n_rows());
        system.elasticity->velocity_gradient(v_gradient, system.with_walls(system.particles.v));
      }
    }

    ParticleState<dim>
    operator()(const unsigned int i) const
    {
      const auto        &particles = system.particles;
      ParticleState<dim> state;
      state.u        = system.displacement(i);
      state.v        = particles.v[i];
      state.V0       = system.thickness() * particles.V0[i];
      state.J        = particles.J[i];
      state.material = system.material_of(i);
      state.density  = system.constitutions[state.material].rho / state.J;
      state.is_fixed = particles.is_fixed(i);
      state.pressure = system.constitutions[state.material].pressure(state.J);
      if (i < system.pairs.n_rows())
        state.kernel_sum = system.pairs.kernel_sum(system.particles, i);
      if (i < v_gradient.size())
        state.v_gradient = v_gradient[i];
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

  /// All fields that particles can be written with.
  template <int dim>
  std::vector<StateField<dim>>
  point_fields(const Scene<dim> &scene)
  {
    using S = ParticleState<dim>;
    std::vector<StateField<dim>> table
        = { { "displacement", "m", dim, [](const S &s, double *v) { std::copy(s.u.begin_raw(), s.u.end_raw(), v); } },
            { "velocity", "m_per_s", dim, [](const S &s, double *v) { std::copy(s.v.begin_raw(), s.v.end_raw(), v); } },
            { "von_mises", "Pa", 1, [](const S &s, double *v) { *v = Solid::von_mises(s.cauchy); } },
            { "pressure", "Pa", 1, [](const S &s, double *v) { *v  = s.pressure; } },
            { "cauchy_stress", "Pa", 6,
              [](const S &s, double *v)
              {
                for (unsigned int k = 0; k < 6; ++k)
                  v[k] = s.cauchy.access_raw_entry(k);
              } },
            { "J", "", 1, [](const S &s, double *v) { *v          = s.J; } },
            { "material", "", 1, [](const S &s, double *v) { *v   = s.material; } },
            { "volume", "m3", 1, [](const S &s, double *v) { *v   = s.V0; } },
            { "fixed", "", 1, [](const S &s, double *v) { *v      = s.is_fixed; } },
            { "kernel_sum", "", 1, [](const S &s, double *v) { *v = s.kernel_sum; } } };
    if (std::all_of(scene.media.begin(), scene.media.end(), [](const auto &medium) { return medium.density > 0.; }))
      table.push_back({ "density", "kg_per_m3", 1, [](const S &s, double *v) { *v = s.density; } });
    return table;
  }

  /// The fields that can be sampled: those of the points that finite elements know as well, and gradients.
  template <int dim>
  std::vector<StateField<dim>>
  sample_table(const Scene<dim> &scene)
  {
    using S                                 = ParticleState<dim>;
    const bool                     is_fluid = scene.is_fluid();
    const std::vector<std::string> shared
        = is_fluid ? std::vector<std::string>{ "velocity", "von_mises", "pressure" }
                   : std::vector<std::string>{ "displacement", "velocity", "von_mises", "pressure", "cauchy_stress" };
    auto table = Output::named(point_fields<dim>(scene), shared);
    if (is_fluid)
      table.push_back({ "velocity_gradient", "per_s", dim * dim, [](const S &s, double *v) {
                         s.v_gradient.unroll(v, v + dim * dim);
                       } });
    else
      table.push_back({ "displacement_gradient", "", dim * dim, [](const S &s, double *v) {
                         s.u_gradient.unroll(v, v + dim * dim);
                       } });
    return table;
  }
} // namespace Stroma::Sph
