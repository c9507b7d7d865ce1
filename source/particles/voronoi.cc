#include <stroma/particles/voronoi.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Stroma::Particles
{
  namespace
  {
    constexpr unsigned int most_iterations = 100;
    constexpr double       small_move = .03; ///< over the spacing, at which the iteration ends; samples make some noise
    constexpr double       relaxation = 1.5; ///< of each move: Lloyd's own is 1, and slower
    constexpr double       balance =
      .2; ///< change of a weight over the square of the spacing, by the share of volume that lacks
    constexpr int widest_search = 4; ///< rings of buckets in which a sample looks for its particle

    template <int dim>
    class Lloyd
    {
    public:
      Lloyd(const Scene<dim> &scene, const Lattice<dim> &lattice, unsigned int seed);

      /// Moves the particles to their centroids; returns the largest move over the spacing.
      double            improve();
      VoronoiCells<dim> cells();

    private:
      static constexpr int          samples_along = dim == 2 ? 8 : 6; ///< along each axis of a bucket
      static constexpr std::uint8_t empty         = VoxelMaterials::empty;
      using Index                                 = std::array<int, dim>;

      /// A particle near a bucket, or an image of one.
      struct Candidate
      {
        dealii::Point<dim>          place;
        dealii::Tensor<1, dim, int> shift;  ///< periods by which it is an image
        double                      weight; ///< [m^2]
        unsigned int                particle;
        std::uint8_t                material;
      };

      void               place_particles(unsigned int seed);
      void               label_samples();
      void               sort_into_buckets();
      void               sum_samples();
      void               sum_bucket(std::uint64_t bucket);
      void               gather(const Index &bucket, int ring);
      const Candidate   *nearest(const dealii::Point<dim> &X, std::uint8_t material, double reach) const;
      dealii::Point<dim> sample(const Index &index) const;
      Index              sample_index(const Index &bucket, unsigned int i) const;
      bool               try_move(unsigned int particle, dealii::Point<dim> X);
      void               balance_volumes();
      const std::int64_t *
      samples_of(const unsigned int p) const
      {
        return &sums[std::size_t(p) * (dim + 1)];
      }
      std::uint8_t material_at(const dealii::Point<dim> &X) const;

      const Scene<dim>     &scene;
      const Lattice<dim>   &lattice;
      const IndexBlock<dim> buckets;
      const unsigned int    samples_a_bucket = dealii::Utilities::fixed_power<dim>(samples_along);
      std::uint64_t         first_bucket, end_bucket; ///< of this rank
      double                smallest_spacing;

      std::vector<dealii::Point<dim>> place;
      std::vector<std::uint8_t>       material;
      std::vector<double>             weight; ///< of each particle in distances: subtracted from their squares [m^2]
      double                          largest_weight = 0.;
      std::vector<std::uint8_t>       sample_material; ///< of this rank's samples, bucket by bucket
      std::vector<unsigned int>       bucket_start, in_bucket;
      std::vector<Candidate>          candidates;
      int                             gathered_ring = 0;
      std::vector<std::int64_t>       sums; ///< of each particle: sum of its samples' indices, then their number
    };

    template <int dim>
    Lloyd<dim>::Lloyd(const Scene<dim> &scene, const Lattice<dim> &lattice, const unsigned int seed)
      : scene(scene)
      , lattice(lattice)
      , buckets(lattice.inside())
      , smallest_spacing(*std::min_element(lattice.spacing.begin_raw(), lattice.spacing.end_raw()))
    {
      const std::uint64_t rank    = dealii::Utilities::MPI::this_mpi_process(scene.comm);
      const std::uint64_t n_ranks = dealii::Utilities::MPI::n_mpi_processes(scene.comm);
      first_bucket                = buckets.size() * rank / n_ranks;
      end_bucket                  = buckets.size() * (rank + 1) / n_ranks;
      place_particles(seed);
      label_samples();
    }

    template <int dim>
    std::uint8_t
    Lloyd<dim>::material_at(const dealii::Point<dim> &X) const
    {
      return static_cast<std::uint8_t>(Particles::material_at(scene, X).value_or(empty));
    }

    template <int dim>
    void
    Lloyd<dim>::place_particles(const unsigned int seed)
    {
      for (std::uint64_t i = 0; i < buckets.size(); ++i)
        {
          const auto site = lattice.site(buckets.at(i));
          const auto here = material_at(site);
          if (here == empty)
            continue;
          place.push_back(site);
          material.push_back(here);
          weight.push_back(0.);
          auto shifted = site;
          for (unsigned int d = 0; d < dim; ++d)
            shifted[d] += (uniform(seed, i, d) - .5) * lattice.spacing[d];
          try_move(place.size() - 1, shifted);
        }
    }

    template <int dim>
    typename Lloyd<dim>::Index
    Lloyd<dim>::sample_index(const Index &bucket, unsigned int i) const
    {
      Index index;
      for (unsigned int d = 0; d < dim; ++d, i /= samples_along)
        index[d] = bucket[d] * samples_along + i % samples_along;
      return index;
    }

    template <int dim>
    dealii::Point<dim>
    Lloyd<dim>::sample(const Index &index) const
    {
      auto X = lattice.lower;
      for (unsigned int d = 0; d < dim; ++d)
        X[d] += (index[d] + .5) / samples_along * lattice.spacing[d];
      return X;
    }

    template <int dim>
    void
    Lloyd<dim>::label_samples()
    {
      sample_material.reserve((end_bucket - first_bucket) * samples_a_bucket);
      for (auto bucket = first_bucket; bucket < end_bucket; ++bucket)
        for (unsigned int i = 0; i < samples_a_bucket; ++i)
          sample_material.push_back(material_at(sample(sample_index(buckets.at(bucket), i))));
    }

    template <int dim>
    void
    Lloyd<dim>::sort_into_buckets()
    {
      std::vector<unsigned int> bucket_of(place.size());
      bucket_start.assign(buckets.size() + 1, 0);
      for (unsigned int p = 0; p < place.size(); ++p)
        {
          std::uint64_t bucket = 0;
          for (int d = dim - 1; d >= 0; --d)
            {
              const int along = static_cast<int>((place[p][d] - lattice.lower[d]) / lattice.spacing[d]);
              bucket          = bucket * buckets.n[d] + std::clamp<int>(along, 0, buckets.n[d] - 1);
            }
          bucket_of[p] = bucket;
          ++bucket_start[bucket + 1];
        }
      for (std::uint64_t b = 0; b < buckets.size(); ++b)
        bucket_start[b + 1] += bucket_start[b];
      in_bucket.resize(place.size());
      auto next = bucket_start;
      for (unsigned int p = 0; p < place.size(); ++p)
        in_bucket[next[bucket_of[p]]++] = p;
    }

    /// The particles of the buckets up to @p ring around this one.
    template <int dim>
    void
    Lloyd<dim>::gather(const Index &bucket, const int ring)
    {
      candidates.clear();
      gathered_ring = ring;
      IndexBlock<dim> around;
      for (unsigned int d = 0; d < dim; ++d)
        {
          around.first[d] = bucket[d] - ring;
          around.n[d]     = 2 * ring + 1;
        }
      for (std::uint64_t i = 0; i < around.size(); ++i)
        {
          const Index                 index = around.at(i);
          dealii::Tensor<1, dim, int> shift;
          dealii::Tensor<1, dim>      distance;
          std::uint64_t               number = 0;
          bool                        exists = true;
          for (int d = dim - 1; d >= 0; --d)
            {
              const int n = buckets.n[d];
              shift[d]    = index[d] >= 0 ? index[d] / n : -((n - 1 - index[d]) / n);
              distance[d] = shift[d] * (lattice.upper[d] - lattice.lower[d]);
              exists &= shift[d] == 0 || scene.periodic[d];
              number = number * n + (index[d] - shift[d] * n);
            }
          if (exists)
            for (unsigned int j = bucket_start[number]; j < bucket_start[number + 1]; ++j)
              candidates.push_back(
                {place[in_bucket[j]] + distance, shift, weight[in_bucket[j]], in_bucket[j], material[in_bucket[j]]});
        }
    }

    /// The nearest candidate of this material by weighted distance, if it must be nearer than all those beyond @p
    /// reach.
    template <int dim>
    const typename Lloyd<dim>::Candidate *
    Lloyd<dim>::nearest(const dealii::Point<dim> &X, const std::uint8_t of_material, const double reach) const
    {
      const Candidate *found = nullptr;
      double           least = reach * reach - largest_weight;
      for (const auto &candidate : candidates)
        {
          const double distance = candidate.place.distance_square(X) - candidate.weight;
          if (distance < least && candidate.material == of_material)
            {
              least = distance;
              found = &candidate;
            }
        }
      return found;
    }

    template <int dim>
    void
    Lloyd<dim>::sum_bucket(const std::uint64_t bucket)
    {
      const Index         index   = buckets.at(bucket);
      const std::uint8_t *of_here = &sample_material[(bucket - first_bucket) * samples_a_bucket];
      gather(index, 1);
      for (unsigned int i = 0; i < samples_a_bucket; ++i)
        {
          if (of_here[i] == empty)
            continue;
          const Index      at = sample_index(index, i);
          const auto       X  = sample(at);
          const Candidate *found;
          while (!(found = nearest(X, of_here[i], gathered_ring * smallest_spacing)) && gathered_ring < widest_search)
            gather(index, gathered_ring + 1);
          if (!found)
            continue;
          std::int64_t *sum = &sums[std::uint64_t(found->particle) * (dim + 1)];
          for (unsigned int d = 0; d < dim; ++d)
            sum[d] += at[d] - found->shift[d] * static_cast<int>(buckets.n[d]) * samples_along;
          ++sum[dim];
        }
    }

    template <int dim>
    void
    Lloyd<dim>::sum_samples()
    {
      sort_into_buckets();
      largest_weight = *std::max_element(weight.begin(), weight.end());
      sums.assign(place.size() * (dim + 1), 0);
      for (auto bucket = first_bucket; bucket < end_bucket; ++bucket)
        sum_bucket(bucket);
      dealii::Utilities::MPI::sum(sums, scene.comm, sums);
    }

    /// Moves it unless it would leave its material.
    template <int dim>
    bool
    Lloyd<dim>::try_move(const unsigned int particle, dealii::Point<dim> X)
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (const double period = lattice.upper[d] - lattice.lower[d]; scene.periodic[d])
          X[d] -= period * std::floor((X[d] - lattice.lower[d]) / period);
      if (material_at(X) != material[particle])
        return false;
      place[particle] = X;
      return true;
    }

    /// Lets cells grow that are smaller than the mean of their material, and others shrink.
    template <int dim>
    void
    Lloyd<dim>::balance_volumes()
    {
      std::vector<double> n_samples(empty, 0.), n_particles(empty, 0.);
      for (unsigned int p = 0; p < place.size(); ++p)
        {
          n_samples[material[p]] += samples_of(p)[dim];
          ++n_particles[material[p]];
        }
      for (unsigned int p = 0; p < place.size(); ++p)
        {
          const double mean = n_samples[material[p]] / n_particles[material[p]];
          weight[p] += balance * smallest_spacing * smallest_spacing * (1. - samples_of(p)[dim] / mean);
        }
    }

    template <int dim>
    double
    Lloyd<dim>::improve()
    {
      sum_samples();
      balance_volumes();
      double largest = 0.;
      for (unsigned int p = 0; p < place.size(); ++p)
        {
          const std::int64_t *sum = samples_of(p);
          if (sum[dim] == 0)
            continue;
          dealii::Tensor<1, dim> move;
          for (unsigned int d = 0; d < dim; ++d)
            move[d] = lattice.lower[d] + (double(sum[d]) / sum[dim] + .5) / samples_along * lattice.spacing[d] -
                      place[p][d];
          largest = std::max(largest, move.norm());
          if (!try_move(p, place[p] + relaxation * move))
            try_move(p, place[p] + move);
        }
      return largest / smallest_spacing;
    }

    template <int dim>
    VoronoiCells<dim>
    Lloyd<dim>::cells()
    {
      sum_samples();
      VoronoiCells<dim> result;
      result.centre        = place;
      result.sample_volume = lattice.site_volume() / samples_a_bucket;
      for (unsigned int p = 0; p < place.size(); ++p)
        result.n_samples.push_back(samples_of(p)[dim]);
      return result;
    }
  } // namespace

  template <int dim>
  VoronoiCells<dim>
  relaxed_voronoi_cells(const Scene<dim> &scene, const Lattice<dim> &lattice, const unsigned int seed)
  {
    Lloyd<dim> lloyd(scene, lattice, seed);
    for (unsigned int i = 0; i < most_iterations && lloyd.improve() > small_move; ++i)
      ;
    return lloyd.cells();
  }

  template VoronoiCells<2> relaxed_voronoi_cells(const Scene<2> &, const Lattice<2> &, unsigned int);
  template VoronoiCells<3> relaxed_voronoi_cells(const Scene<3> &, const Lattice<3> &, unsigned int);
} // namespace Stroma::Particles
