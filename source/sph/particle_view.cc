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
    for (unsigned int i = 0; i < system.particles.n_owned; ++i)
      {
        auto state = state_of(i);
        if (sampler && !state.is_fixed)
          sampler->set_gradients(i, state);
        visit(state);
      }
  }

  template <int dim>
  void
  ParticleMethod<dim>::View::sample(const Output::StateFields &fields, Output::Samples &samples) const
  {
    if (!sampler)
      sampler = std::make_unique<ParticleSampler<dim>>(system, time);
    const auto answer = [&](const Output::Place &place, double *values) {
      Output::PointState state;
      if (!sampler->state_at(Output::point_of<dim>(place), state))
        return Output::knows_not;
      fields.fill(state, values);
      return Output::Rating(0);
    };
    Output::Samples folded;
    for (const auto &X : samples.X)
      folded.X.push_back(Output::place_of<dim>(sampler->folded(Output::point_of<dim>(X))));
    Output::ask_ranks(folded, fields.width(), sampler->extent(), sampler->reach(), Output::Asked::nearest, answer,
                      system.scene.comm);
    samples.values = std::move(folded.values);
    samples.found  = std::move(folded.found);
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
