// Neighbours against a search over all particles, on any number of ranks.

#include "../world.h"

#include <stroma/base/errors.h>
#include <stroma/particles/neighbours.h>

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace
{
  using namespace Stroma;
  using namespace Stroma::Particles;
  namespace mpi = dealii::Utilities::MPI;

  /// One particle as all ranks know it.
  template <int dim>
  struct Known
  {
    dealii::Point<dim> x;
    double             V0;
    bool               fixed;
  };

  /// By id.
  template <int dim>
  using All = std::map<std::uint64_t, Known<dim>>;

  struct Neighbour
  {
    std::uint64_t       id;
    std::vector<double> from_here; ///< place of the neighbour relative to the particle

    bool
    operator==(const Neighbour &other) const
    {
      return id == other.id && from_here == other.from_here;
    }
  };

  using Rows = std::map<std::uint64_t, std::vector<Neighbour>>;

  /// Random particles, ids with gaps; a few far away; every fifth fixed.
  template <int dim>
  All<dim>
  random_particles(const unsigned int n, const bool far)
  {
    std::mt19937                           random(11);
    std::uniform_real_distribution<double> number(0., 1.);
    All<dim>                               all;
    for (unsigned int i = 0; i < n; ++i)
      {
        Known<dim> &p = all[3 * i + (i % 7 == 0 ? (std::uint64_t{1} << 40) : 0)];
        for (unsigned int d = 0; d < dim; ++d)
          p.x[d] = number(random) * (far && i % 50 == 0 ? 3. : 1.);
        p.V0    = .5 + number(random);
        p.fixed = i % 5 == 2;
      }
    return all;
  }

  template <int dim>
  ParticleSet<dim>
  of_this_rank(const All<dim> &all)
  {
    ParticleSet<dim> particles;
    for (const bool fixed : {false, true})
      {
        for (const auto &[id, p] : all)
          if (p.fixed == fixed && id % mpi::n_mpi_processes(world) == mpi::this_mpi_process(world))
            {
              particles.id.push_back(id);
              particles.x.push_back(p.x);
              particles.X.push_back(p.x);
              particles.V0.push_back(p.V0);
              particles.mover.push_back(p.fixed ? 0 : ParticleSet<dim>::no_mover);
            }
        (fixed ? particles.n_owned : particles.n_free) = particles.size();
      }
    return particles;
  }

  /// The rows that must come out, found by looking at all pairs and images.
  template <int dim>
  Rows
  expected_rows(const All<dim> &all, const typename Neighbours<dim>::Settings &settings)
  {
    Rows         rows;
    const double reach = settings.support + settings.skin;
    for (const auto &[id, p] : all)
      if (!p.fixed || settings.rows_of_fixed)
        for (const bool fixed : {false, true})
          for (const auto &[other_id, other] : all)
            for (unsigned int k = 0; other.fixed == fixed && k < (dim == 2 ? 9 : 27); ++k)
              {
                dealii::Point<dim> x      = other.x;
                bool               exists = true, shifted = false;
                for (unsigned int d = dim, rest = k; d-- > 0; rest /= 3)
                  if (rest % 3 != 1)
                    {
                      exists  = exists && settings.periodic[d];
                      shifted = true;
                      x[d] += (static_cast<int>(rest % 3) - 1) * settings.domain.side_length(d);
                    }
                if (exists && (shifted || other_id != id) && (x - p.x).norm_square() <= reach * reach)
                  {
                    Neighbour neighbour{other_id, {}};
                    for (unsigned int d = 0; d < dim; ++d)
                      neighbour.from_here.push_back(x[d] - p.x[d]);
                    rows[id].push_back(neighbour);
                  }
              }
    return rows;
  }

  template <int dim>
  void
  expect_rows(const Neighbours<dim> &neighbours, const ParticleSet<dim> &particles, const Rows &expected)
  {
    for (unsigned int i = 0; i < neighbours.n_rows(); ++i)
      {
        std::vector<Neighbour> row;
        for (unsigned int k = neighbours.row_start[i]; k < neighbours.row_start[i + 1]; ++k)
          {
            const unsigned int j = neighbours.neighbour[k];
            row.push_back({particles.id[j], {}});
            for (unsigned int d = 0; d < dim; ++d)
              row.back().from_here.push_back(particles.x[j][d] - particles.x[i][d]);
          }
        const auto wanted = expected.find(particles.id[i]);
        EXPECT_TRUE(row == (wanted == expected.end() ? std::vector<Neighbour>() : wanted->second))
          << "row of particle " << particles.id[i];
      }
  }

  template <int dim>
  void
  expect_order(const Neighbours<dim> &neighbours, const ParticleSet<dim> &particles, const All<dim> &all)
  {
    EXPECT_EQ(mpi::sum(particles.n_owned, world), all.size());
    EXPECT_EQ(mpi::sum(neighbours.n_rows(), world),
              neighbours.n_rows() == particles.n_free ? neighbours.n_equations : all.size());
    std::uint64_t n_free = 0;
    for (const auto &[id, p] : all)
      n_free += p.fixed ? 0 : 1;
    EXPECT_EQ(neighbours.n_equations, n_free);
    for (unsigned int i = 0; i < particles.size(); ++i)
      {
        const Known<dim> &p = all.at(particles.id[i]);
        EXPECT_EQ(particles.is_fixed(i), p.fixed);
        EXPECT_EQ(particles.V0[i], p.V0);
        EXPECT_EQ(neighbours.equation[i] == neighbours.no_equation, p.fixed);
        if (i < particles.n_owned)
          {
            EXPECT_EQ(p.x, particles.x[i]);
            EXPECT_EQ(p.fixed, i >= particles.n_free);
            EXPECT_TRUE(p.fixed || neighbours.equation[i] == neighbours.first_equation + i);
          }
      }
  }

  template <typename T>
  void
  expect_updated(const T &neighbours, const std::vector<std::uint64_t> &id, const unsigned int n_owned)
  {
    const auto check = [&](auto value_of) {
      std::vector<decltype(value_of(0))> field(id.size());
      for (unsigned int i = 0; i < n_owned; ++i)
        field[i] = value_of(id[i]);
      neighbours.update_ghosts(field);
      for (unsigned int i = 0; i < id.size(); ++i)
        EXPECT_TRUE(field[i] == value_of(id[i]));
      field.clear();
      neighbours.update_ghosts(field);
      EXPECT_TRUE(field.empty());
    };
    check([](const std::uint64_t i) { return 3. * i; });
    check([](const std::uint64_t i) { return i; });
    check([](const std::uint64_t i) { return static_cast<std::uint8_t>(i); });
    check([](const std::uint64_t i) { return dealii::Tensor<1, 2>({1. * i, 2. * i}); });
    check([](const std::uint64_t i) { return dealii::Tensor<1, 3>({1. * i, 2. * i, 5. * i}); });
    check([](const std::uint64_t i) {
      return dealii::Tensor<2, 3>({{1. * i, 2., 3.}, {4., 5., 6.}, {7., 8. * i, 9.}});
    });
    check([](const std::uint64_t i) {
      dealii::SymmetricTensor<2, 2> s;
      s[0][1] = i;
      return s;
    });
    check([](const std::uint64_t i) { return std::array<double, 5>{{1. * i, 2., 3., 4., 5. * i}}; });
  }

  /// Places as rebuild() folds them.
  template <int dim>
  void
  fold(All<dim> &all, const typename Neighbours<dim>::Settings &settings)
  {
    for (auto &[id, p] : all)
      for (unsigned int d = 0; d < dim; ++d)
        if (settings.periodic[d])
          {
            const double period = settings.domain.side_length(d), lower = settings.domain.lower_bound(d);
            if (p.x[d] < lower || p.x[d] >= lower + period)
              p.x[d] -= period * std::floor((p.x[d] - lower) / period);
          }
  }

  /// Moves all particles, the owned ones and what all ranks know of them, by random steps.
  template <int dim>
  void
  move(All<dim> &all, ParticleSet<dim> &particles, const double step)
  {
    std::mt19937                           random(5);
    std::uniform_real_distribution<double> number(-step, step);
    for (auto &[id, p] : all)
      for (unsigned int d = 0; d < dim; ++d)
        p.x[d] += number(random);
    for (unsigned int i = 0; i < particles.n_owned; ++i)
      particles.x[i] = all.at(particles.id[i]).x;
  }

  template <int dim>
  typename Neighbours<dim>::Settings
  make_settings(const double reach, const unsigned int n_periodic, const bool rows_of_fixed)
  {
    typename Neighbours<dim>::Settings settings;
    dealii::Point<dim>                 lower, upper;
    for (unsigned int d = 0; d < dim; ++d)
      {
        settings.periodic[d] = d < n_periodic;
        upper[d]             = 1.;
      }
    settings.support       = .8 * reach;
    settings.skin          = .2 * reach;
    settings.domain        = dealii::BoundingBox<dim>({lower, upper});
    settings.rows_of_fixed = rows_of_fixed;
    return settings;
  }

  template <int dim>
  void
  check(const double reach, const unsigned int n_periodic, const unsigned int n, const bool rows_of_fixed)
  {
    const auto      settings  = make_settings<dim>(reach, n_periodic, rows_of_fixed);
    auto            all       = random_particles<dim>(n, n_periodic == 0);
    auto            particles = of_this_rank(all);
    Neighbours<dim> neighbours(settings, world);
    EXPECT_TRUE(neighbours.outdated(particles));
    for (unsigned int round = 0; round < 3; ++round)
      {
        neighbours.rebuild(particles);
        EXPECT_FALSE(neighbours.outdated(particles));
        expect_order(neighbours, particles, all);
        expect_rows(neighbours, particles, expected_rows(all, settings));
        expect_updated(neighbours, particles.id, particles.n_owned);

        const auto was       = all;
        const auto before    = particles;
        const auto row_start = neighbours.row_start, neighbour = neighbours.neighbour;
        neighbours.rebuild(particles);
        EXPECT_EQ(before.id, particles.id);
        EXPECT_EQ(before.x, particles.x);
        EXPECT_EQ(row_start, neighbours.row_start);
        EXPECT_EQ(neighbour, neighbours.neighbour);

        move(all, particles, .4 * reach);
        neighbours.update_ghost_places(particles.x);
        for (unsigned int i = particles.n_owned; i < particles.size(); ++i)
          {
            const std::uint64_t id = particles.id[i];
            EXPECT_LT(((particles.x[i] - before.x[i]) - (all.at(id).x - was.at(id).x)).norm(), 1e-14);
          }
        EXPECT_TRUE(neighbours.outdated(particles));
        fold(all, settings);
      }
    EXPECT_EQ(neighbours.n_rebuilds, 6u);
  }

  TEST(MpiNeighbours, AreAllFoundIn2D)
  {
    check<2>(.07, 0, 700, false);
    check<2>(.3, 0, 300, true);
  }

  TEST(MpiNeighbours, AreAllFoundAcrossPeriodicFacesIn2D)
  {
    check<2>(.11, 1, 500, true);
    check<2>(.11, 2, 500, false);
    check<2>(.49, 2, 60, true); // two cells a period
    check<2>(.5, 2, 60, true);
  }

  TEST(MpiNeighbours, AreAllFoundIn3D)
  {
    check<3>(.16, 0, 500, false);
    check<3>(.2, 2, 300, true);
    check<3>(.45, 3, 60, false);
  }

  TEST(MpiNeighbours, AreFewOrNone)
  {
    check<2>(.1, 0, 1, true);
    check<2>(.1, 1, 2, true);
    ParticleSet<3> none;
    Neighbours<3>  neighbours(make_settings<3>(.1, 0, true), world);
    neighbours.rebuild(none);
    EXPECT_EQ(neighbours.n_rows(), 0u);
    EXPECT_EQ(neighbours.n_equations, 0u);
  }

  TEST(MpiNeighbours, AreRestoredFromThePlacesOfTheSearch)
  {
    const auto settings  = make_settings<2>(.2, 1, false);
    const auto searched  = random_particles<2>(200, false);
    auto       moved     = searched;
    auto       particles = of_this_rank(searched);
    particles.x_search   = particles.x;
    move(moved, particles, .05);
    Neighbours<2> neighbours(settings, world);
    neighbours.restore(particles, 0);
    expect_order(neighbours, particles, moved);
    EXPECT_TRUE(neighbours.outdated(particles));
    particles.x = particles.x_search;
    EXPECT_FALSE(neighbours.outdated(particles));
    expect_rows(neighbours, particles, expected_rows(searched, settings));
  }

  TEST(MpiNeighbours, KeepTheirOrderWhileAllStayOnTheirRanks)
  {
    const auto    settings  = make_settings<2>(.2, 1, false);
    auto          all       = random_particles<2>(200, false);
    auto          particles = of_this_rank(all);
    Neighbours<2> neighbours(settings, world);
    neighbours.rebuild(particles);
    const auto owned_ids = [&] {
      return std::vector<std::uint64_t>(particles.id.begin(), particles.id.begin() + particles.n_owned);
    };
    const auto ids = owned_ids();
    for (unsigned int round = 0; round < 19; ++round)
      {
        if (mpi::n_mpi_processes(world) == 1) // elsewhere some would change their rank
          move(all, particles, .02);
        fold(all, settings);
        neighbours.rebuild(particles);
        expect_rows(neighbours, particles, expected_rows(all, settings));
        EXPECT_EQ(ids, owned_ids());
        EXPECT_EQ(neighbours.n_orders, 1u);
      }
    neighbours.rebuild(particles);
    EXPECT_EQ(neighbours.n_orders, 2u);
    neighbours.rebuild(particles, true);
    EXPECT_EQ(neighbours.n_orders, 3u);
    expect_order(neighbours, particles, all);
    expect_rows(neighbours, particles, expected_rows(all, settings));
  }

  TEST(MpiNeighbours, ImagesFollowTheirParticles)
  {
    const auto    settings  = make_settings<2>(.2, 2, false);
    auto          all       = random_particles<2>(100, false);
    auto          particles = of_this_rank(all);
    Neighbours<2> neighbours(settings, world);
    neighbours.rebuild(particles);
    const auto before = particles.x;
    ASSERT_GT(particles.size(), particles.n_owned);
    const dealii::Tensor<1, 2> step({.015, -.01}), long_step({.02, .005});
    for (unsigned int i = 0; i < particles.n_owned; ++i)
      particles.x[i] += step;
    neighbours.update_ghost_places(particles.x);
    EXPECT_FALSE(neighbours.outdated(particles));
    for (unsigned int i = 0; i < particles.size(); ++i)
      EXPECT_LT((particles.x[i] - before[i] - step).norm(), 1e-15);

    // One far particle, on one rank, is enough.
    for (unsigned int i = 0; i < particles.n_owned; ++i)
      if (particles.id[i] == 3)
        particles.x[i] = before[i] + long_step;
    EXPECT_TRUE(neighbours.outdated(particles));

    const dealii::Point<2> near = neighbours.image_near({.98 + 2., .5}, {-.01, .52});
    EXPECT_NEAR(near[0], -.02, 1e-15);
    EXPECT_EQ(near[1], .5);
  }

  TEST(MpiNeighbours, AreSharedEvenly)
  {
    auto          particles = of_this_rank(random_particles<2>(20000, false));
    Neighbours<2> neighbours(make_settings<2>(.03, 0, false), world);
    neighbours.rebuild(particles);
    EXPECT_LT(std::abs(20000. / mpi::n_mpi_processes(world) - particles.n_owned), 100.);
  }

  TEST(MpiNeighbours, NeedPeriodsOfTwiceTheReach)
  {
    EXPECT_THROW(Neighbours<2>(make_settings<2>(.51, 1, false), world), UserError);
    EXPECT_NO_THROW(Neighbours<2>(make_settings<2>(.51, 0, false), world));
  }
} // namespace
