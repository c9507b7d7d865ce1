#include <stroma/particles/border_volumes.h>
#include <stroma/sph/interfaces.h>

#include <algorithm>

namespace Stroma::Sph
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  namespace
  {
    /// Second moment sum P r (x) r of the own material's neighbours, trace over d V and determinant over that of an even one, that tell
    /// a gradient: an edge of a straight interface has .5, a corner .35.
    constexpr double least_own_moment = .15, least_own_evenness = .05;

    /// Faces are kept off the particles themselves, whose part of the pair could not be told from rounding.
    constexpr double least_share = .05;

    /// Halvings of a pair until its crossing with the interface is known.
    constexpr unsigned int n_halvings = 20;

    double
    harmonic_mean(const double a, const double b)
    {
      return a + b > 0. ? 2. * a * b / (a + b) : 0.;
    }
  } // namespace

  template <int dim>
  Interfaces<dim>::Interfaces(const Scene<dim> &scene, const std::vector<Constitution> &constitutions,
                              const Neighbours<dim> &neighbours, const double stabilisation)
    : scene(scene)
    , constitutions(constitutions)
    , neighbours(neighbours)
    , stabilisation(stabilisation)
  {}

  template <int dim>
  bool
  Interfaces<dim>::exist_among(const std::vector<Constitution> &constitutions)
  {
    return std::any_of(constitutions.begin(), constitutions.end(), [&](const Constitution &law) {
      const auto &one = constitutions.front();
      return law.G > 0. && (law.G != one.G || law.K != one.K || law.mu != one.mu);
    });
  }

  template <int dim>
  bool
  Interfaces<dim>::differ(const unsigned int material, const unsigned int other) const
  {
    const auto &a = constitutions[material], &b = constitutions[other];
    return a.G != b.G || a.K != b.K || a.mu != b.mu;
  }

  template <int dim>
  void
  Interfaces<dim>::find(Pairs<dim> &pairs, const ParticleSet<dim> &particles)
  {
    const unsigned int        n = pairs.n_rows();
    std::vector<std::uint8_t> tells(particles.size(), 0); // whether its own material's neighbours tell a gradient
    for (unsigned int i = 0; i < n; ++i)
      {
        SymmetricTensor<2, dim> moment;
        for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
          if (p >= pairs.row_fixed[i] || !differ(particles.material_of(i), particles.material_of(pairs.j[p])))
            moment += pairs.P[p] * symmetrize(outer_product(pairs.r[p], pairs.r[p]));
        const double mean = trace(moment) / dim;
        tells[i]          = mean > least_own_moment * particles.volume(i) &&
                   determinant(moment) > least_own_evenness * std::pow(mean, dim);
      }
    neighbours.update_ghosts(tells);
    across.clear();
    first.assign(1, 0);
    pairs.face.assign(pairs.n_pairs(), .5);
    for (unsigned int i = 0; i < n; ++i)
      {
        for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
          if (const unsigned int j = pairs.j[p];
              tells[i] && tells[j] && differ(particles.material_of(i), particles.material_of(j)))
            {
              across.push_back(new_pair(pairs, particles, i, p));
              pairs.face[p] = across.back().theta;
            }
        first.push_back(across.size());
      }
  }

  template <int dim>
  typename Interfaces<dim>::Pair
  Interfaces<dim>::new_pair(const Pairs<dim> &pairs, const ParticleSet<dim> &particles, const unsigned int i,
                            const unsigned int p)
  {
    Pair pair;
    pair.i        = i;
    pair.p        = p;
    pair.j        = pairs.j[p];
    const auto &a = constitutions[particles.material_of(i)], &b = constitutions[particles.material_of(pair.j)];
    pair.theta  = share(particles, i, pair.j);
    pair.weight = b.G / (a.G + b.G);
    pair.G      = harmonic_mean(a.G, b.G);
    pair.K      = harmonic_mean(a.K, b.K);
    pair.mu     = harmonic_mean(a.mu, b.mu);
    return pair;
  }

  /// theta, from the undeformed places, by halving from the particle with the lower id: the same seen from both.
  template <int dim>
  double
  Interfaces<dim>::share(const ParticleSet<dim> &particles, const unsigned int i, const unsigned int j)
  {
    if (particles.id[i] > particles.id[j])
      return 1. - share(particles, j, i);
    const auto [entry, is_new] = shares.try_emplace({particles.id[i], particles.id[j]}, .5);
    if (!is_new)
      return entry->second;
    const auto &X  = particles.X[i];
    const auto  to = neighbours.image_near(particles.X[j], X) - X;
    double      in = 0., out = 1.;
    for (unsigned int halving = 0; halving < n_halvings; ++halving)
      {
        const double middle   = .5 * (in + out);
        const auto   material = Particles::material_at(scene, Particles::inside_periods(scene, X + middle * to));
        (material && *material == particles.material_of(i) ? in : out) = middle;
      }
    return entry->second = std::clamp(.5 * (in + out), least_share, 1. - least_share);
  }

  template <int dim>
  void
  Interfaces<dim>::take(Pairs<dim> &pairs, const ParticleSet<dim> &particles)
  {
    volume.resize(pairs.n_rows());
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      volume[i] = particles.volume(i);
    for (Pair &pair : across)
      {
        pair.P          = pairs.P[pair.p];
        pair.r          = pairs.r[pair.p];
        pair.c          = pairs.c[pair.p];
        pairs.P[pair.p] = 0.;
        pairs.c[pair.p] = 0.;
      }
    one_sided.assign(particles.size(), {});
  }

  template <int dim>
  void
  Interfaces<dim>::combine(const double elastic, const double viscous) const
  {
    elastic_now = elastic;
    viscous_now = viscous;
  }

  template <int dim>
  void
  Interfaces<dim>::lift(Tensors &L, const Vectors &v) const
  {
    std::copy(L.begin(), L.begin() + volume.size(), one_sided.begin());
    neighbours.update_ghosts(one_sided);
    for (Pair &pair : across)
      {
        const unsigned int i = pair.i, j = pair.j;
        pair.jump = v[j] - v[i] - (pair.theta * one_sided[i] + (1. - pair.theta) * one_sided[j]) * pair.r;
        L[i] += pair.weight / volume[i] * outer_product(pair.jump, pair.c);
      }
  }

  template <int dim>
  void
  Interfaces<dim>::set_forces(const Tensors *sigma, const bool of_jumps) const
  {
    for (Pair &pair : across)
      {
        pair.force = 0.;
        if (sigma)
          pair.force += (pair.weight * (*sigma)[pair.i] + (1. - pair.weight) * (*sigma)[pair.j]) * pair.c;
        if (of_jumps)
          pair.force += stabilisation * 4. / 3. * modulus(pair) * pair.P * pair.jump;
      }
  }

  template <int dim>
  void
  Interfaces<dim>::add_moments(Tensors &T) const
  {
    for (const Pair &pair : across)
      T[pair.i] -= pair.theta / volume[pair.i] * outer_product(pair.force, pair.r);
  }

  template <int dim>
  void
  Interfaces<dim>::add_forces(Vectors &f) const
  {
    for (const Pair &pair : across)
      if (pair.i < f.size())
        f[pair.i] += pair.force;
  }

  template <int dim>
  SymmetricTensor<2, dim>
  Interfaces<dim>::block_of(const Pair &pair) const
  {
    const double G = modulus(pair), K = elastic_now * pair.K + viscous_now * 5. / 3. * pair.mu;
    const double B = .5 * (K + G / 3.);
    return 2. * pair.P *
           (std::max(G - B, .1 * G) * dealii::unit_symmetric_tensor<dim>() +
            (dim + 2) * B / pair.r.norm_square() * symmetrize(outer_product(pair.r, pair.r)));
  }

  template <int dim>
  SymmetricTensor<2, dim>
  Interfaces<dim>::pair_block(const unsigned int i, const std::size_t p) const
  {
    for (std::size_t q = first[i]; q < first[i + 1]; ++q)
      if (across[q].p == p)
        return block_of(across[q]);
    return {};
  }

  template <int dim>
  void
  Interfaces<dim>::add_diagonal(std::vector<SymmetricTensor<2, dim>> &blocks) const
  {
    for (const Pair &pair : across)
      if (pair.i < blocks.size())
        blocks[pair.i] += block_of(pair);
  }

  template class Interfaces<2>;
  template class Interfaces<3>;
} // namespace Stroma::Sph
