// The committed state of ParticleMethod, to look at.

#include "particle_sampler.h"

#include <stroma/sph/particle_method.h>

namespace Stroma::Sph
{
  template <int dim>
  class ParticleMethod<dim>::View : public Output::StateView
  {
  public:
    View(const ParticleMethod &method, const bool with_gradients)
      : system(*method.system)
      , time(method.time)
      , state_of(system)
    {
      if (with_gradients)
        sampler = std::make_unique<ParticleSampler<dim>>(system, time);
    }

    std::size_t
    n_points() const override
    {
      return system.particles.n_owned;
    }

    void for_each_point(const Visit &visit) const override;
    void sample(const Output::StateFields &fields, Output::Samples &samples) const override;

  private:
    const System<dim>                            &system;
    const double                                  time;
    const StateReader<dim>                        state_of;
    mutable std::unique_ptr<ParticleSampler<dim>> sampler; ///< made when it is asked for
  };

  template <int dim>
  void
  ParticleMethod<dim>::View::for_each_point(const Visit &visit) const
  {
    const auto gradients = sampler ? sampler->gradients() : std::vector<typename ParticleSampler<dim>::Gradients>();
    for (unsigned int i = 0; i < system.particles.n_owned; ++i)
      {
        auto state = state_of(i);
        if (i < gradients.size() && gradients[i].found)
          {
            state.u_gradient = Output::in_space<dim>(gradients[i].u);
            state.v_gradient = Output::in_space<dim>(gradients[i].v);
          }
        visit(state);
      }
  }

  template <int dim>
  void
  ParticleMethod<dim>::View::sample(const Output::StateFields &fields, Output::Samples &samples) const
  {
    if (!sampler)
      sampler = std::make_unique<ParticleSampler<dim>>(system, time);
    sampler->sample(fields, samples);
  }

  template <int dim>
  std::unique_ptr<Output::StateView>
  ParticleMethod<dim>::state(const bool with_gradients)
  {
    return std::make_unique<View>(*this, with_gradients);
  }

  template class ParticleMethod<2>;
  template class ParticleMethod<3>;
} // namespace Stroma::Sph
