#include <stroma/mpm/point_weights.h>

#include <deal.II/base/mpi.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

namespace Stroma::Mpm
{
  namespace
  {
    template <int dim>
    constexpr unsigned int n_moments = 1 << dim;

    template <int dim>
    using Moments = Eigen::Matrix<double, n_moments<dim>, 1>;

    /// phi_k at a place of the unit cell: the products of its coordinates from the cell's centre.
    template <int dim>
    Moments<dim>
    monomials(const dealii::Point<dim> &xi)
    {
      Moments<dim> phi;
      phi[0] = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int k = 0; k < 1u << d; ++k)
          phi[k | 1u << d] = phi[k] * (xi[d] - .5);
      return phi;
    }

    /// What a point stands for now, in the plane or in space.
    template <int dim>
    struct PointBox
    {
      double                                         volume; ///< [m^dim]
      dealii::Tensor<1, dim>                         size;   ///< of the upright box of a part [m]
      std::array<dealii::Tensor<1, dim>, (1 << dim)> part;   ///< their centres, from the point [m]

      PointBox(const Points<dim> &points, const double *numbers, const dealii::Tensor<1, dim> &cell_size)
      {
        const auto             F      = points.deformation_of(numbers);
        const double          *sides  = numbers + points.sides.first;
        double                 filled = 1.;
        dealii::Tensor<2, dim> edge; // by columns, of a part
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int i = 0; i < dim; ++i)
            edge[i][k] = .5 * F[i][k] * sides[k];
        volume = points.undeformed_size(numbers) * determinant(F);
        for (unsigned int i = 0; i < dim; ++i)
          {
            for (unsigned int k = 0; k < dim; ++k)
              size[i] = std::max(size[i], std::abs(edge[i][k]));
            filled *= size[i];
          }
        const double scale = std::pow(volume / part.size() / filled, 1. / dim);
        for (unsigned int i = 0; i < dim; ++i)
          size[i] = std::min(scale * size[i], cell_size[i]); // within the ghost cells
        for (unsigned int s = 0; s < part.size(); ++s)
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int k = 0; k < dim; ++k)
              part[s][i] += (s >> k & 1 ? .5 : -.5) * edge[i][k];
      }
    };

    /// Sums up the moments of the cells of all ranks.
    template <int dim>
    class CellMoments
    {
    public:
      explicit CellMoments(const BackgroundGrid<dim> &grid)
        : grid(grid)
      {
        for (const auto &cell : grid.triangulation.active_cell_iterators())
          if (!cell->is_artificial() && grid.box().contains(cell->center()) && grid.is_active(cell))
            known.emplace(grid.box().cell_number(cell->center()), cell->subdomain_id());
      }

      /// Adds the parts of the box of a point in the cell @p own.
      void
      add(const PointBox<dim> &box, const dealii::Point<dim> &x, const std::uint64_t own)
      {
        for (const auto &from_point : box.part)
          add_box(x + from_point, box.size, box.volume / box.part.size(), own);
      }

      /// Brings what other ranks know of this rank's cells. Collective.
      void
      exchange()
      {
        const MPI_Comm                              comm = grid.triangulation.get_communicator();
        const unsigned int                          self = dealii::Utilities::MPI::this_mpi_process(comm);
        std::map<unsigned int, std::vector<double>> parcels;
        for (const auto &[number, sum] : sums)
          if (const unsigned int owner = known.at(number); owner != self)
            {
              parcels[owner].push_back(static_cast<double>(number));
              parcels[owner].insert(parcels[owner].end(), sum.begin(), sum.end());
            }
        for (const auto &[from, arrived] : dealii::Utilities::MPI::some_to_some(comm, parcels))
          for (auto next = arrived.begin(); next != arrived.end(); next += 1 + n_moments<dim>)
            of(static_cast<std::uint64_t>(*next)) += Eigen::Map<const Moments<dim>>(&*next + 1);
      }

      Moments<dim> &
      of(const std::uint64_t number)
      {
        return sums.emplace(number, Moments<dim>::Zero()).first->second;
      }

    private:
      using Index = std::array<int, dim>;

      /// Number of a cell with points; none for others.
      std::optional<std::uint64_t>
      number_of(const Index &index) const
      {
        std::uint64_t number = 0;
        for (int d = dim - 1; d >= 0; --d)
          {
            if (index[d] < 0 || index[d] >= static_cast<int>(grid.box().n_cells[d]))
              return std::nullopt;
            number = number * grid.box().n_cells[d] + index[d];
          }
        return known.count(number) ? std::optional(number) : std::nullopt;
      }

      Index
      index_of(std::uint64_t number) const
      {
        Index index;
        for (unsigned int d = 0; d < dim; ++d)
          {
            index[d] = static_cast<int>(number % grid.box().n_cells[d]);
            number /= grid.box().n_cells[d];
          }
        return index;
      }

      /// An upright box, cut by the cells' faces.
      void
      add_box(const dealii::Point<dim> &centre, const dealii::Tensor<1, dim> &size, const double volume,
              const std::uint64_t own)
      {
        struct Piece
        {
          int    cell;
          double middle, share; // in cells from the grid's lower end; of the box
        };
        std::array<std::array<Piece, 3>, dim> pieces;
        std::array<unsigned int, dim>         n{};
        unsigned int                          n_all = 1;
        for (unsigned int d = 0; d < dim; ++d)
          {
            const double h      = grid.box().cell_size[d];
            const double length = size[d] / h;
            double       begin  = (centre[d] - grid.box().lower[d]) / h - .5 * length;
            const double upper  = begin + length;
            while (n[d] < 3 && begin < upper - 1e-9)
              {
                const double face = std::min(std::floor(begin + 1e-9) + 1., upper);
                pieces[d][n[d]++] = {static_cast<int>(std::floor(begin + 1e-9)), .5 * (begin + face),
                                     (face - begin) / length};
                begin             = face;
              }
            n_all *= n[d];
          }
        for (unsigned int i = 0; i < n_all; ++i)
          {
            Index              index;
            dealii::Point<dim> middle;
            double             part = volume;
            for (unsigned int d = 0, rest = i; d < dim; rest /= n[d++])
              {
                const Piece &piece = pieces[d][rest % n[d]];
                index[d]           = piece.cell;
                middle[d]          = piece.middle;
                part *= piece.share;
              }
            const auto found  = number_of(index);
            const auto target = found.value_or(own);
            const auto at     = found ? index : index_of(own);
            for (unsigned int d = 0; d < dim; ++d)
              middle[d] -= at[d];
            of(target) += part * monomials<dim>(middle);
          }
      }

      const BackgroundGrid<dim>                      &grid;
      std::unordered_map<std::uint64_t, unsigned int> known; ///< owners of cells with points, owned and ghost ones
      std::map<std::uint64_t, Moments<dim>>           sums;
    };

    /// The weights of the points of a cell, from their volumes, monomials and the moments that they should have.
    template <int dim>
    void
    fit(const std::vector<double> &v, const std::vector<Moments<dim>> &phi, const Moments<dim> &wanted,
        std::vector<double> &weight)
    {
      constexpr double open = 1e-3, least = .2; // of the trace of G, of the mean weight
      using Gram       = Eigen::Matrix<double, n_moments<dim>, n_moments<dim>>;
      Gram         G   = Gram::Zero();
      Moments<dim> has = Moments<dim>::Zero();
      for (std::size_t p = 0; p < v.size(); ++p)
        {
          has += v[p] * phi[p];
          G += v[p] * phi[p] * phi[p].transpose();
        }
      const double                              mean = wanted[0] / has[0];
      const Eigen::SelfAdjointEigenSolver<Gram> eigen(G);
      Moments<dim>                              in_modes = eigen.eigenvectors().transpose() * (wanted - mean * has);
      for (unsigned int k = 0; k < n_moments<dim>; ++k)
        in_modes[k] = eigen.eigenvalues()[k] > open * G.trace() ? in_modes[k] / eigen.eigenvalues()[k] : 0.;
      const Moments<dim> series = eigen.eigenvectors() * in_modes;

      double part = 1., sum = 0.;
      weight.resize(v.size());
      for (std::size_t p = 0; p < v.size(); ++p)
        {
          weight[p] = series.dot(phi[p]);
          part      = std::min(part, -weight[p] > (1. - least) * mean ? (1. - least) * mean / -weight[p] : 1.);
        }
      for (std::size_t p = 0; p < v.size(); ++p)
        sum += v[p] * (weight[p] = mean + part * weight[p]);
      for (double &w : weight)
        w *= wanted[0] / sum;
    }
  } // namespace

  template <int dim>
  void
  set_weights(Points<dim> &points, const BackgroundGrid<dim> &grid)
  {
    const auto         &box = grid.box();
    CellMoments<dim>    moments(grid);
    std::vector<double> volumes;
    for (const auto &active : grid.active_cells())
      for (const auto &point : points.handler.particles_in_cell(active.cell))
        moments.add(PointBox<dim>(points, point.get_properties().data(), box.cell_size), point.get_location(),
                    box.cell_number(active.cell->center()));
    moments.exchange();
    std::vector<Moments<dim>> phi;
    std::vector<double>       weight;
    for (const auto &active : grid.active_cells())
      {
        volumes.clear();
        phi.clear();
        for (const auto &point : points.handler.particles_in_cell(active.cell))
          {
            const double *numbers = point.get_properties().data();
            volumes.push_back(points.undeformed_size(numbers) * determinant(points.deformation_of(numbers)));
            phi.push_back(monomials<dim>(point.get_reference_location()));
          }
        fit<dim>(volumes, phi, moments.of(box.cell_number(active.cell->center())), weight);
        auto next = weight.begin();
        for (auto &point : points.handler.particles_in_cell(active.cell))
          point.get_properties()[points.weight.first] = *next++;
      }
  }

  template void set_weights(Points<2> &, const BackgroundGrid<2> &);
  template void set_weights(Points<3> &, const BackgroundGrid<3> &);
} // namespace Stroma::Mpm
