#include <stroma/particles/border_volumes.h>

#include <cmath>
#include <limits>
#include <optional>

namespace Stroma::Particles
{
  namespace
  {
    /// Along each edge of a cell.
    template <int dim>
    constexpr int samples_at_border = dim == 2 ? 16 : 6;

    /// The cells of a lattice and what lies in them.
    template <int dim>
    class BorderCells
    {
    public:
      using Index = std::array<int, dim>;

      BorderCells(const Scene<dim> &scene, const Lattice<dim> &lattice)
        : scene(scene)
        , lattice(lattice)
      {
        const auto samples = around(samples_at_border<dim>);
        for (const auto &sample : samples)
          {
            dealii::Tensor<1, dim> offset;
            for (unsigned int d = 0; d < dim; ++d)
              offset[d] = ((sample[d] + .5) / samples_at_border<dim> - .5) * lattice.spacing[d];
            offsets.push_back(offset);
          }
        for (auto step : around(3))
          {
            for (auto &s : step)
              s -= 1;
            steps.push_back(step);
          }
      }

      /// Volume of the particle at site @p own of material @p material, over that of a cell.
      double
      share(const Index &own, const unsigned int material) const
      {
        int n = offsets.size();
        for (const auto &step : steps)
          {
            const Index cell        = moved(own, step);
            const auto  of_cell     = material_of(cell);
            const bool  is_own_cell = cell == own;
            if (!of_cell || (!is_own_cell && *of_cell == material))
              continue;
            for (const auto &offset : offsets)
              {
                const auto Y  = lattice.site(cell) + offset;
                const auto at = material_at(scene, inside_periods(scene, Y));
                if (!at || *at == *of_cell || (!is_own_cell && *at != material))
                  continue;
                if (const auto taker = nearest(cell, Y, *at))
                  n += is_own_cell ? -1 : *taker == own;
              }
          }
        return double(n) / offsets.size();
      }

    private:
      static std::vector<Index>
      around(const unsigned int n)
      {
        IndexBlock<dim> block;
        block.n.fill(n);
        std::vector<Index> all;
        for (std::uint64_t i = 0; i < block.size(); ++i)
          all.push_back(block.at(i));
        return all;
      }
      static Index
      moved(Index index, const Index &step)
      {
        for (unsigned int d = 0; d < dim; ++d)
          index[d] += step[d];
        return index;
      }
      std::optional<unsigned int>
      material_of(const Index &cell) const
      {
        return material_at(scene, inside_periods(scene, lattice.site(cell)));
      }

      /// Of the sites next to @p cell of material @p material that which is nearest to @p Y.
      std::optional<Index>
      nearest(const Index &cell, const dealii::Point<dim> &Y, const unsigned int material) const
      {
        std::optional<Index> found;
        double               least = std::numeric_limits<double>::max();
        for (const auto &step : steps)
          {
            const Index  site     = moved(cell, step);
            const double distance = Y.distance(lattice.site(site));
            if (distance < least * (1. - 1e-9) && material_of(site) == material)
              {
                least = distance;
                found = site;
              }
          }
        return found;
      }

      const Scene<dim>                   &scene;
      const Lattice<dim>                 &lattice;
      std::vector<dealii::Tensor<1, dim>> offsets; ///< of the samples from the site
      std::vector<Index>                  steps;   ///< to the cell itself and the next ones
    };
  } // namespace

  template <int dim>
  dealii::Point<dim>
  inside_periods(const Scene<dim> &scene, dealii::Point<dim> X)
  {
    const auto box = scene.bounding_box();
    for (unsigned int d = 0; d < dim; ++d)
      if (scene.periodic[d])
        X[d] -= box.side_length(d) * std::floor((X[d] - box.lower_bound(d)) / box.side_length(d));
    return X;
  }

  template <int dim>
  std::vector<double>
  shares_at_borders(const Scene<dim> &scene, const Lattice<dim> &lattice, const ParticleSet<dim> &particles)
  {
    const BorderCells<dim> cells(scene, lattice);
    const auto             sites = lattice.inside();
    std::vector<double>    shares;
    for (unsigned int i = 0; i < particles.size(); ++i)
      shares.push_back(cells.share(sites.at(particles.id[i]), particles.material_of(i)));
    return shares;
  }

  template dealii::Point<2>    inside_periods(const Scene<2> &, dealii::Point<2>);
  template dealii::Point<3>    inside_periods(const Scene<3> &, dealii::Point<3>);
  template std::vector<double> shares_at_borders(const Scene<2> &, const Lattice<2> &, const ParticleSet<2> &);
  template std::vector<double> shares_at_borders(const Scene<3> &, const Lattice<3> &, const ParticleSet<3> &);
} // namespace Stroma::Particles
