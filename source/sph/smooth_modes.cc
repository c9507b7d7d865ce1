#include <stroma/sph/smooth_modes.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Stroma::Sph
{
  using dealii::Tensor;

  namespace
  {
    /// Least size of a cell of the grid, over the spacing: what it costs to factorise the equations grows faster with it in space.
    template <int dim>
    constexpr double cell_over_spacing = dim == 2 ? 2. : 3.;

    /// Added to the scaled diagonal: nodes that hardly see a particle.
    constexpr double least_of_diagonal = 1e-10;

    /// The three quadratic B-splines at @p t in a cell of length 1, or their derivatives.
    std::array<double, 3>
    spline_values(const double t)
    {
      return {{.5 * (1. - t) * (1. - t), .5 + t - t * t, .5 * t * t}};
    }
    std::array<double, 3>
    spline_slopes(const double t)
    {
      return {{t - 1., 1. - 2. * t, t}};
    }

    /// Digit @p d of @p number to @p base.
    int
    digit(unsigned int number, const unsigned int d, const int base)
    {
      for (unsigned int k = 0; k < d; ++k)
        number /= base;
      return number % base;
    }
  } // namespace

  template <int dim>
  SmoothModes<dim>::SmoothModes(const Neighbours<dim> &neighbours, const ParticleSet<dim> &particles,
                                const double spacing, const double reach, const std::vector<std::uint8_t> &n_left_out)
    : neighbours(neighbours)
    , spacing(spacing)
    , first(particles.size())
    , nodes(particles.size())
    , splines(particles.size())
  {
    lay_grid(particles, std::max(.5 * reach, cell_over_spacing<dim> * spacing));
    for (unsigned int i = 0; i < particles.size(); ++i)
      set_splines(particles.x[i], i, n_left_out[i]);
    of_all.assign(n_nodes * n_offsets, 0.);
    of_one.fill(of_all);
  }

  /// Cells of at least @p least around all particles, that fit into periods.
  template <int dim>
  void
  SmoothModes<dim>::lay_grid(const ParticleSet<dim> &particles, const double least)
  {
    std::array<double, 2 * dim> ends; // lower ones, and minus the upper ones
    ends.fill(std::numeric_limits<double>::max());
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        {
          ends[d]       = std::min(ends[d], particles.x[i][d]);
          ends[dim + d] = std::min(ends[dim + d], -particles.x[i][d]);
        }
    std::vector<double> all(ends.begin(), ends.end());
    dealii::Utilities::MPI::min(all, neighbours.communicator(), all);
    for (unsigned int d = 0; d < dim; ++d)
      {
        const bool   wraps  = neighbours.is_periodic(d);
        const double length = wraps ? neighbours.domain().side_length(d) : -all[dim + d] - all[d];
        lower[d]            = wraps ? neighbours.domain().lower_bound(d) : all[d];
        n_cells[d]          = std::max(1, static_cast<int>(length / least));
        size[d]             = std::max(length, least) / n_cells[d];
        n_nodes *= wraps ? n_cells[d] : n_cells[d] + 2;
      }
  }

  template <int dim>
  void
  SmoothModes<dim>::set_splines(const dealii::Point<dim> &x, const unsigned int i, const unsigned int n_left_out)
  {
    std::array<std::array<double, 3>, dim> values, slopes;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double u = (x[d] - lower[d]) / size[d];
        first[i][d]    = static_cast<int>(std::floor(u));
        if (!neighbours.is_periodic(d))
          first[i][d] = std::clamp(first[i][d], 0, n_cells[d] - 1);
        values[d] = spline_values(u - first[i][d]);
        slopes[d] = spline_slopes(u - first[i][d]);
      }
    for (unsigned int s = 0; s < n_splines; ++s)
      for (unsigned int e = n_left_out; e <= dim; ++e)
        {
          double product = e == 0 ? 1. / spacing : .5 / size[e - 1];
          for (unsigned int d = 0; d < dim; ++d)
            product *= (e == d + 1 ? slopes : values)[d][digit(s, d, 3)];
          splines[i][s][e] = product;
        }
    for (unsigned int s = 0; s < n_splines; ++s)
      {
        Node node = first[i];
        for (unsigned int d = 0; d < dim; ++d)
          node[d] += digit(s, d, 3);
        nodes[i][s] = index_of(node);
      }
  }

  template <int dim>
  unsigned int
  SmoothModes<dim>::index_of(const Node &node) const
  {
    unsigned int index = 0;
    for (unsigned int d = dim; d-- > 0;)
      {
        const int n = neighbours.is_periodic(d) ? n_cells[d] : n_cells[d] + 2;
        index       = index * n + ((node[d] % n) + n) % n;
      }
    return index;
  }

  /// The node that is @p offset, as in the sums, away from @p node.
  template <int dim>
  typename SmoothModes<dim>::Node
  SmoothModes<dim>::node_at(Node node, const unsigned int offset) const
  {
    for (unsigned int d = 0; d < dim; ++d)
      node[d] += digit(offset, d, n_along) - far;
    return node;
  }

  template <int dim>
  void
  SmoothModes<dim>::add_products(std::vector<double> &sums, const unsigned int i, const unsigned int j,
                                 const Factors &left, const Factors &right) const
  {
    static const auto offsets = [] { // of the splines' nodes from the first
      std::array<int, n_splines> all{};
      for (unsigned int s = 0; s < n_splines; ++s)
        for (unsigned int d = 0, unit = 1; d < dim; ++d, unit *= n_along)
          all[s] += digit(s, d, 3) * unit;
      return all;
    }();
    int between = 0, unit = 1; // of the first nodes, as an offset
    for (unsigned int d = 0; d < dim; ++d, unit *= n_along)
      between += (first[j][d] - first[i][d] + far) * unit;
    for (unsigned int s = 0; s < n_splines; ++s)
      {
        double *const row = &sums[nodes[i][s] * n_offsets + between - offsets[s]];
        for (unsigned int t = 0; t < n_splines; ++t)
          row[offsets[t]] += left[s] * right[t];
      }
  }

  template <int dim>
  void
  SmoothModes<dim>::add(const unsigned int i, const Block &block)
  {
    Factors left, right;
    for (unsigned int e = 0; e <= dim; ++e)
      {
        for (unsigned int s = 0; s < n_splines; ++s)
          {
            left[s]  = splines[i][s][e];
            right[s] = block[e] * splines[i][s];
          }
        add_products(of_all, i, i, left, right);
      }
  }

  template <int dim>
  void
  SmoothModes<dim>::add(const unsigned int i, const unsigned int j, const double weight, const Basis &own,
                        const Basis &other)
  {
    Factors left, right;
    for (unsigned int s = 0; s < n_splines; ++s)
      {
        left[s]  = weight * (own * splines[i][s]);
        right[s] = other * splines[j][s];
      }
    add_products(of_all, i, j, left, right);
  }

  template <int dim>
  void
  SmoothModes<dim>::add_to_component(const unsigned int k, const unsigned int i, const double weight, const Basis &own)
  {
    Factors left, right;
    for (unsigned int s = 0; s < n_splines; ++s)
      {
        right[s] = own * splines[i][s];
        left[s]  = weight * right[s];
      }
    add_products(of_one[k], i, i, left, right);
  }

  template <int dim>
  void
  SmoothModes<dim>::factorise()
  {
    dealii::Utilities::MPI::sum(of_all, neighbours.communicator(), of_all);
    for (unsigned int k = 0; k < dim; ++k)
      {
        dealii::Utilities::MPI::sum(of_one[k], neighbours.communicator(), of_one[k]);
        for (std::size_t e = 0; e < of_all.size(); ++e)
          of_one[k][e] += of_all[e];
        factorise(k, of_one[k]);
        of_one[k].clear();
      }
    of_all.clear();
  }

  template <int dim>
  void
  SmoothModes<dim>::factorise(const unsigned int k, const std::vector<double> &sums)
  {
    constexpr unsigned int here = (n_offsets - 1) / 2;
    scale[k].resize(n_nodes);
    for (unsigned int n = 0; n < n_nodes; ++n)
      scale[k][n] = sums[n * n_offsets + here] > 0. ? 1. / std::sqrt(sums[n * n_offsets + here]) : 0.;
    std::vector<Eigen::Triplet<double>> entries;
    for (unsigned int n = 0; n < n_nodes; ++n)
      {
        Node         node;
        unsigned int rest = n;
        for (unsigned int d = 0; d < dim; ++d)
          {
            const unsigned int n_here = neighbours.is_periodic(d) ? n_cells[d] : n_cells[d] + 2;
            node[d]                   = rest % n_here;
            rest /= n_here;
          }
        entries.emplace_back(n, n, scale[k][n] > 0. ? least_of_diagonal : 1.);
        for (unsigned int o = 0; o < n_offsets; ++o)
          if (const double sum = sums[n * n_offsets + o]; sum != 0.)
            {
              const unsigned int other = index_of(node_at(node, o));
              entries.emplace_back(n, other, sum * scale[k][n] * scale[k][other]);
            }
      }
    Eigen::SparseMatrix<double> matrix(n_nodes, n_nodes);
    matrix.setFromTriplets(entries.begin(), entries.end());
    factors[k].compute(matrix);
  }

  template <int dim>
  void
  SmoothModes<dim>::add_solution(Unknown *const y, const Unknown *const x) const
  {
    std::vector<double> sums(dim * n_nodes, 0.);
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
      for (unsigned int s = 0; s < n_splines; ++s)
        for (unsigned int k = 0; k < dim; ++k)
          sums[k * n_nodes + nodes[i][s]] += x[i][k] * splines[i][s];
    dealii::Utilities::MPI::sum(sums, neighbours.communicator(), sums);
    for (unsigned int k = 0; k < dim; ++k)
      {
        Eigen::Map<Eigen::VectorXd> values(sums.data() + k * n_nodes, n_nodes);
        const Eigen::VectorXd       scaled   = values.cwiseProduct(scale[k]);
        const Eigen::VectorXd       solution = factors[k].solve(scaled);
        values                               = solution.cwiseProduct(scale[k]);
      }
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
      for (unsigned int s = 0; s < n_splines; ++s)
        for (unsigned int k = 0; k < dim; ++k)
          y[i][k] += sums[k * n_nodes + nodes[i][s]] * splines[i][s];
  }

  template class SmoothModes<2>;
  template class SmoothModes<3>;
} // namespace Stroma::Sph
