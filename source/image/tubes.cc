#include <stroma/image/tubes.h>

#include <algorithm>
#include <cmath>
#include <queue>

namespace Stroma::Image
{
  namespace
  {
    using Vector = std::array<double, 3>;

    // Lengths in mean radii.
    constexpr double persistence_length = 22, branch_length = 18, radius_length = 10, margin = 8;
    // Standard deviation of log(radius) along a tube and between first tubes, and radii in mean radii.
    constexpr double radius_drift = 0.15, radius_spread = 0.3, first_radius = 1.4, least_branch_radius = 0.55;

    /// The growing end of a tube; `own_radius` is what its drifting radius returns to.
    struct Tip
    {
      Vector position, direction;
      double radius, own_radius;
      /// Length to grow before touching another tube counts: out of the parent.
      double blind_length;
    };

    Vector
    normalised(Vector v)
    {
      const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
      for (double &component : v)
        component /= length;
      return v;
    }

    class TubeGrowth
    {
    public:
      TubeGrowth(const PhantomSettings &settings, Random &random)
        : settings(settings)
        , random(random)
        , flat(settings.size[2] == 1)
      {
        labels.size       = settings.size;
        labels.voxel_size = settings.voxel_size;
        labels.data.assign(labels.n_voxels(), 0);
        n_missing = std::llround(settings.vessel_fraction * labels.n_voxels());
      }

      Volume<std::uint8_t>
      run()
      {
        while (n_missing > 0)
          {
            if (tips.empty())
              start_tube();
            const Tip tip = tips.front();
            tips.pop();
            grow(tip);
          }
        return std::move(labels);
      }

    private:
      double
      edge(const unsigned int d) const
      {
        return settings.size[d] * settings.voxel_size[d];
      }

      /// The margin around the box in which tubes also grow, so that the box's faces are like any other place.
      double
      margin_of(const unsigned int d) const
      {
        return flat && d == 2 ? 0 : margin * settings.radius;
      }

      Vector
      random_direction()
      {
        const double x = random.normal(), y = random.normal(), z = random.normal();
        return normalised({{x, y, flat ? 0 : z}});
      }

      /// Two tips that grow away from a random place.
      void
      start_tube()
      {
        Vector position;
        for (unsigned int d = 0; d < 3; ++d)
          position[d] = flat && d == 2 ? edge(d) / 2 : random.uniform() * (edge(d) + 2 * margin_of(d)) - margin_of(d);
        const Vector direction = random_direction();
        const double radius    = first_radius * settings.radius * std::exp(radius_spread * random.normal());
        tips.push({position, direction, radius, radius, 0});
        tips.push({position, {{-direction[0], -direction[1], -direction[2]}}, radius, radius, 0});
      }

      bool
      in_box(const Vector &position, const double extra) const
      {
        for (unsigned int d = 0; d < 3; ++d)
          if (position[d] < -extra * margin_of(d) || position[d] >= edge(d) + extra * margin_of(d))
            return false;
        return true;
      }

      bool
      is_vessel(const Vector &position) const
      {
        if (!in_box(position, 0))
          return false;
        const auto voxel = [&](const unsigned int d) {
          return std::min<unsigned int>(position[d] / settings.voxel_size[d], settings.size[d] - 1);
        };
        return labels.at(voxel(0), voxel(1), voxel(2)) != 0;
      }

      void
      grow(Tip tip)
      {
        double length_left = -1; // not yet about to join another tube
        while (n_missing > 0 && in_box(tip.position, 1) && length_left != 0)
          {
            const double step = tip.radius / 2;
            stamp(tip);
            advance(tip, step);
            if (length_left > 0)
              length_left = std::max(length_left - step, 0.);
            else if (tip.blind_length <= 0 && is_vessel(ahead(tip, 1.3 * tip.radius + step)))
              length_left = 1.3 * tip.radius + step;
            else if (random.uniform() < step / (branch_length * settings.radius))
              branch(tip);
          }
      }

      static Vector
      ahead(const Tip &tip, const double length)
      {
        Vector position = tip.position;
        for (unsigned int d = 0; d < 3; ++d)
          position[d] += length * tip.direction[d];
        return position;
      }

      /// Random walk of direction and radius over `step`.
      void
      advance(Tip &tip, const double step)
      {
        tip.position = ahead(tip, step);
        tip.blind_length -= step;
        const double bend = std::sqrt(step / (persistence_length * settings.radius));
        for (unsigned int d = 0; d < (flat ? 2 : 3); ++d)
          tip.direction[d] += bend * random.normal();
        tip.direction      = normalised(tip.direction);
        const double share = step / (radius_length * settings.radius);
        const double log_r = std::log(tip.radius / tip.own_radius) * (1 - std::min(share, 1.)) +
                             radius_drift * std::sqrt(2 * share) * random.normal();
        tip.radius = tip.own_radius * std::exp(std::clamp(log_r, -3 * radius_drift, 3 * radius_drift));
      }

      /// Split off a side branch if both branches stay thick enough.
      void
      branch(Tip &tip)
      {
        const double side_share = 0.2 + 0.3 * random.uniform();
        const double side = tip.own_radius * std::cbrt(side_share), rest = tip.own_radius * std::cbrt(1 - side_share);
        if (side < least_branch_radius * settings.radius)
          return;
        const Vector sideways = random_direction();
        Vector       direction;
        for (unsigned int d = 0; d < 3; ++d)
          direction[d] = 0.7 * tip.direction[d] + sideways[d];
        tips.push({tip.position, normalised(direction), side, side, 3 * tip.radius + 2 * side});
        tip.own_radius   = rest;
        tip.blind_length = std::max(tip.blind_length, 2 * side);
      }

      /// Make the voxels whose centres are within the tip's radius vessel, until none is missing.
      void
      stamp(const Tip &tip)
      {
        std::array<unsigned int, 3> first, end;
        for (unsigned int d = 0; d < 3; ++d)
          {
            const double h = settings.voxel_size[d], n = settings.size[d];
            first[d] = std::clamp(std::ceil((tip.position[d] - tip.radius) / h - 0.5), 0., n);
            end[d]   = std::clamp(std::floor((tip.position[d] + tip.radius) / h - 0.5) + 1, 0., n);
          }
        for (unsigned int z = first[2]; z < end[2]; ++z)
          for (unsigned int y = first[1]; y < end[1]; ++y)
            for (unsigned int x = first[0]; x < end[0]; ++x)
              if (labels.at(x, y, z) == 0 && n_missing > 0 && is_within(tip, {{x, y, z}}))
                {
                  labels.at(x, y, z) = 255;
                  --n_missing;
                }
      }

      bool
      is_within(const Tip &tip, const std::array<unsigned int, 3> &voxel) const
      {
        double distance_square = 0;
        for (unsigned int d = 0; d < 3; ++d)
          {
            const double distance = (voxel[d] + 0.5) * settings.voxel_size[d] - tip.position[d];
            distance_square += distance * distance;
          }
        return distance_square <= tip.radius * tip.radius;
      }

      const PhantomSettings &settings;
      Random                &random;
      const bool             flat;
      Volume<std::uint8_t>   labels;
      long long              n_missing;
      std::queue<Tip>        tips;
    };
  } // namespace

  Volume<std::uint8_t>
  grow_tubes(const PhantomSettings &settings, Random &random)
  {
    return TubeGrowth(settings, random).run();
  }
} // namespace Stroma::Image
