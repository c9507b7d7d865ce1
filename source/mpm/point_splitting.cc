// Points that were stretched are halved, so that cells keep as many as their shape functions need.

#include <stroma/base/log.h>
#include <stroma/mpm/points.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Mpm
{
  namespace
  {
    /// A point, or a part of one.
    template <int dim>
    struct LoosePoint
    {
      std::uint64_t       id;
      dealii::Point<dim>  x;
      std::vector<double> numbers;
    };

    /// The longest edge of the box of a point if it is longer than @p limit cells, and its vector now [m].
    template <int dim>
    std::optional<std::pair<unsigned int, dealii::Tensor<1, dim>>>
    long_edge(const dealii::Tensor<2, dim> &F, const double *sides, const dealii::Tensor<1, dim> &cell_size,
              double limit)
    {
      std::optional<std::pair<unsigned int, dealii::Tensor<1, dim>>> found;
      for (unsigned int k = 0; k < dim; ++k)
        {
          dealii::Tensor<1, dim> edge;
          double                 in_cells = 0;
          for (unsigned int i = 0; i < dim; ++i)
            {
              edge[i]  = F[i][k] * sides[k];
              in_cells = std::max(in_cells, std::abs(edge[i]) / cell_size[i]);
            }
          if (in_cells > limit)
            {
              limit = in_cells;
              found.emplace(k, edge);
            }
        }
      return found;
    }
  } // namespace

  /// The halves of point q have the ids n + 2 q and n + 2 q + 1, of n at the start: the same on any number of ranks.
  template <int dim>
  void
  Points<dim>::split_stretched()
  {
    constexpr double longest    = .55; // cells; then two lie in each along each axis
    constexpr auto   largest_id = std::numeric_limits<dealii::types::particle_index>::max();
    const auto      &box        = grid.box();

    std::vector<typename Handler::particle_iterator> stretched;
    std::vector<LoosePoint<dim>>                     parts; // some may have to be halved again
    int                                              out_of_ids = 0;
    const auto can_be_halved = [&](const LoosePoint<dim> &p, LoosePoint<dim> &lower, LoosePoint<dim> &upper) {
      const auto F    = deformation_of(p.numbers.data());
      const auto edge = long_edge(F, &p.numbers[sides.first], box.cell_size, longest);
      if (!edge)
        return false;
      if (next_id + 2 * p.id + 1 > largest_id)
        {
          out_of_ids = 1;
          return false;
        }
      dealii::Tensor<1, dim> undeformed;
      undeformed[edge->first] = p.numbers[sides.first + edge->first];
      for (auto *half : {&lower, &upper})
        {
          const double quarter = half == &lower ? -.25 : .25;
          *half                = p;
          half->id             = next_id + 2 * p.id + (half == &upper);
          half->x += quarter * edge->second;
          half->numbers[volume.first] *= .5;
          half->numbers[sides.first + edge->first] *= .5;
          for (unsigned int d = 0; d < dim; ++d)
            half->numbers[displacement.first + d] += quarter * (edge->second[d] - undeformed[d]);
        }
      return box.contains(lower.x) && box.contains(upper.x);
    };
    std::vector<std::pair<LoosePoint<dim>, typename dealii::Triangulation<dim>::active_cell_iterator>> halves;
    for (const auto &cell : grid.triangulation.active_cell_iterators())
      {
        if (!cell->is_locally_owned())
          continue;
        const auto inside = handler.particles_in_cell(cell);
        for (auto point = inside.begin(); point != inside.end(); ++point)
          {
            const auto      stored = point->get_properties();
            LoosePoint<dim> lower, upper;
            parts.assign(1, {point->get_id(), point->get_location(), {stored.begin(), stored.end()}});
            if (!can_be_halved(parts.front(), lower, upper))
              continue;
            stretched.push_back(point);
            while (!parts.empty())
              {
                const LoosePoint<dim> part = std::move(parts.back());
                parts.pop_back();
                if (can_be_halved(part, lower, upper))
                  {
                    parts.push_back(upper);
                    parts.push_back(lower);
                  }
                else
                  halves.emplace_back(part, cell);
              }
          }
      }
    if (dealii::Utilities::MPI::max(out_of_ids, grid.triangulation.get_communicator()) == 1)
      Log::warning(
        "material points that are stretched stay whole, as there are no more numbers for their halves; a grid with fewer "
        "cells, or fewer points in each, leaves more");
    handler.remove_particles(stretched);
    for (const auto &[half, cell] : halves)
      handler.insert_particle(half.x, {}, static_cast<dealii::types::particle_index>(half.id), cell,
                              dealii::ArrayView<const double>(half.numbers.data(), half.numbers.size()));
  }

  template void Points<2>::split_stretched();
  template void Points<3>::split_stretched();
} // namespace Stroma::Mpm
