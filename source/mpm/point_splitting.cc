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

    /// Halves points of @p box where they are stretched. The halves of point q have the ids n + 2 q and n + 2 q + 1, of n at the
    /// start: the same on any number of ranks.
    template <int dim>
    class Halving
    {
    public:
      Halving(const Points<dim> &points, const GridBox<dim> &box, const typename Points<dim>::InnerMarks &inner_marks)
        : points(points)
        , box(box)
        , inner_marks(inner_marks)
      {}

      /// Whether @p p is halved; what becomes of it, halved again where need be, is put at the end of @p parts.
      bool
      split(const LoosePoint<dim> &p, std::vector<LoosePoint<dim>> &parts)
      {
        const auto two = halves(p);
        if (!two)
          return false;
        for (const auto &half : *two)
          if (!split(half, parts))
            parts.push_back(half);
        return true;
      }

      int out_of_ids = 0; ///< 1 if a point stayed whole for want of ids

    private:
      std::optional<std::array<LoosePoint<dim>, 2>>
      halves(const LoosePoint<dim> &p)
      {
        const auto F    = points.deformation_of(p.numbers.data());
        const auto edge = long_edge(F, &p.numbers[points.sides.first], box.cell_size, longest);
        if (!edge)
          return std::nullopt;
        if (points.n_first_ids() + 2 * p.id + 1 > std::numeric_limits<dealii::types::particle_index>::max())
          {
            out_of_ids = 1;
            return std::nullopt;
          }
        const auto [axis, vector] = *edge;
        dealii::Tensor<1, dim> undeformed;
        undeformed[axis] = p.numbers[points.sides.first + axis];
        std::array<LoosePoint<dim>, 2> two{{p, p}};
        for (unsigned int upper = 0; upper < 2; ++upper)
          {
            const double quarter = upper ? .25 : -.25;
            auto        &half    = two[upper];
            half.id              = points.n_first_ids() + 2 * p.id + upper;
            half.x += quarter * vector;
            half.numbers[points.volume.first] *= .5;
            half.numbers[points.sides.first + axis] *= .5;
            if (points.support.stored())
              half.numbers[points.support.first] = static_cast<double>(
                static_cast<std::uint64_t>(half.numbers[points.support.first]) & ~inner_marks(axis, upper));
            for (unsigned int d = 0; d < dim; ++d)
              half.numbers[points.displacement.first + d] += quarter * (vector[d] - undeformed[d]);
          }
        if (!box.contains(two[0].x) || !box.contains(two[1].x))
          return std::nullopt;
        return two;
      }

      static constexpr double longest = .55; ///< cells; then two lie in each along each axis

      const Points<dim>                      &points;
      const GridBox<dim>                     &box;
      const typename Points<dim>::InnerMarks &inner_marks;
    };
  } // namespace

  template <int dim>
  void
  Points<dim>::split_stretched(const InnerMarks &inner_marks)
  {
    Halving<dim>                                                           halving(*this, grid.box(), inner_marks);
    std::vector<typename Handler::particle_iterator>                       stretched;
    std::vector<LoosePoint<dim>>                                           parts;
    std::vector<typename dealii::Triangulation<dim>::active_cell_iterator> cells; // of the parts
    for (const auto &cell : grid.triangulation.active_cell_iterators())
      {
        if (!cell->is_locally_owned())
          continue;
        const auto inside = handler.particles_in_cell(cell);
        for (auto point = inside.begin(); point != inside.end(); ++point)
          {
            const auto stored = point->get_properties();
            if (halving.split({point->get_id(), point->get_location(), {stored.begin(), stored.end()}}, parts))
              stretched.push_back(point);
            cells.resize(parts.size(), cell);
          }
      }
    if (dealii::Utilities::MPI::max(halving.out_of_ids, grid.triangulation.get_communicator()) == 1)
      Log::warning(
        "material points that are stretched stay whole, as there are no more numbers for their halves; a grid with fewer "
        "cells, or fewer points in each, leaves more");
    handler.remove_particles(stretched);
    for (std::size_t i = 0; i < parts.size(); ++i)
      handler.insert_particle(parts[i].x, {}, static_cast<dealii::types::particle_index>(parts[i].id), cells[i],
                              dealii::ArrayView<const double>(parts[i].numbers.data(), parts[i].numbers.size()));
  }

  template void Points<2>::split_stretched(const InnerMarks &);
  template void Points<3>::split_stretched(const InnerMarks &);
} // namespace Stroma::Mpm
