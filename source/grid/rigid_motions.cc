#include <stroma/grid/rigid_motions.h>

#include <deal.II/base/mpi.h>

#include <Eigen/LU>

#include <algorithm>
#include <numeric>
#include <set>

namespace Stroma
{
  namespace
  {
    /// A held component counts if it holds more than this part of a motion of unit size.
    constexpr double tolerance = 1e-8;
    /// Larger sets of pieces that only hang together by corners are taken for held: the search costs their number cubed.
    constexpr unsigned int most_clusters = 200;
  } // namespace

  template <int dim>
  bool
  RigidMotions<dim>::Equations::add(Modes row)
  {
    if (is_complete())
      return false;
    const double size = row.norm();
    for (unsigned int twice = 0; twice < 2; ++twice)
      for (const auto &known : basis)
        row -= known.dot(row) * known;
    if (!(row.norm() > tolerance * size))
      return false;
    basis.push_back(row.normalized());
    return true;
  }

  template <int dim>
  RigidMotions<dim>::RigidMotions(const Scene<dim> &scene, const unsigned int n_pieces)
    : scene(scene)
    , n_pieces(n_pieces)
  {
    const auto box = scene.bounding_box();
    centre         = box.center();
    for (unsigned int d = 0; d < dim; ++d)
      length = std::max(length, box.side_length(d));
  }

  template <int dim>
  typename RigidMotions<dim>::Modes
  RigidMotions<dim>::row(const dealii::Point<dim> &X, const unsigned int c) const
  {
    const dealii::Tensor<1, dim> r   = (X - centre) / length;
    Modes                        row = Modes::Zero();
    row(c)                           = 1;
    if constexpr (dim == 2)
      row(2) = c == 0 ? -r[1] : r[0];
    else
      for (unsigned int axis = 0; axis < 3; ++axis)
        {
          if (c == (axis + 1) % 3)
            row(3 + axis) = -r[(axis + 2) % 3];
          if (c == (axis + 2) % 3)
            row(3 + axis) = r[(axis + 1) % 3];
        }
    return row;
  }

  template <int dim>
  void
  RigidMotions<dim>::hold(const unsigned int piece, const dealii::Point<dim> &X, const unsigned int c)
  {
    equations[{ground, piece + 1}].add(row(X, c));
  }

  template <int dim>
  void
  RigidMotions<dim>::hold_turns_across_periods(const unsigned int piece)
  {
    for (unsigned int axis = 0; axis < n_modes - dim; ++axis)
      for (unsigned int d = 0; d < dim; ++d)
        if (scene.periodic[d] && (dim == 2 || d != axis))
          equations[{ground, piece + 1}].add(Modes::Unit(dim + axis));
  }

  template <int dim>
  void
  RigidMotions<dim>::hold_turns(const unsigned int piece)
  {
    for (unsigned int mode = dim; mode < n_modes; ++mode)
      equations[{ground, piece + 1}].add(Modes::Unit(mode));
  }

  template <int dim>
  void
  RigidMotions<dim>::join(const unsigned int first, const unsigned int second, const dealii::Point<dim> &X,
                          const unsigned int c)
  {
    equations[std::minmax(first + 1, second + 1)].add(row(X, c));
  }

  template <int dim>
  void
  RigidMotions<dim>::gather()
  {
    std::vector<double> own;
    for (const auto &[pair, between] : equations)
      for (const auto &equation : between.basis)
        {
          own.push_back(pair.first);
          own.push_back(pair.second);
          own.insert(own.end(), equation.data(), equation.data() + n_modes);
        }
    equations.clear();
    for (const auto &numbers : dealii::Utilities::MPI::all_gather(scene.comm, own))
      for (std::size_t i = 0; i < numbers.size(); i += 2 + n_modes)
        equations[{static_cast<unsigned int>(numbers[i]), static_cast<unsigned int>(numbers[i + 1])}].add(
          Eigen::Map<const Modes>(numbers.data() + i + 2));
  }

  template <int dim>
  void
  RigidMotions<dim>::check_whole() const
  {
    Equations all;
    for (const auto &[pair, between] : equations)
      if (pair.first == ground)
        for (const auto &equation : between.basis)
          all.add(equation);
    if (all.is_complete())
      return;
    // The mode with the largest share in the motions that are left.
    Modes left = Modes::Ones();
    for (const auto &equation : all.basis)
      left -= equation.cwiseAbs2();
    Eigen::Index mode;
    left.maxCoeff(&mode);
    const std::string motion = mode < dim ? std::string("move along ") + "xyz"[mode] :
                                            (dim == 2 ? std::string("turn in the plane") :
                                                        std::string("turn about ") + "xyz"[mode - dim]);
    throw UserError(scene.bodies.front().where, "the supports leave the bodies free to " + motion +
                                                  "; hold them there, for example by a support on 'nearest' with the " +
                                                  "other components free");
  }

  /// Joins what is rigidly joined, again and again; @p between follows. The cluster of each number.
  template <int dim>
  std::vector<unsigned int>
  RigidMotions<dim>::rigid_clusters(std::map<Pair, Equations> &between) const
  {
    std::vector<unsigned int> cluster(n_pieces + 1);
    std::iota(cluster.begin(), cluster.end(), 0u);
    const auto root = [&](unsigned int i) {
      while (cluster[i] != i)
        i = cluster[i] = cluster[cluster[i]];
      return i;
    };
    for (bool merged = true; merged;)
      {
        merged = false;
        for (const auto &entry : between)
          if (const unsigned int a = root(entry.first.first), b = root(entry.first.second);
              a != b && entry.second.is_complete())
            {
              cluster[std::max(a, b)] = std::min(a, b); // the ground stays a root
              merged                  = true;
            }
        std::map<Pair, Equations> next;
        for (const auto &[pair, equations_of] : between)
          if (const unsigned int a = root(pair.first), b = root(pair.second); a != b)
            for (const auto &equation : equations_of.basis)
              next[std::minmax(a, b)].add(equation);
        between = std::move(next);
      }
    for (unsigned int i = 0; i <= n_pieces; ++i)
      cluster[i] = root(i);
    return cluster;
  }

  template <int dim>
  std::vector<typename RigidMotions<dim>::FreeGroup>
  RigidMotions<dim>::free_groups() const
  {
    auto                                   between = equations;
    const auto                             cluster = rigid_clusters(between);
    std::vector<std::vector<unsigned int>> members(n_pieces + 1);
    for (unsigned int i = 1; i <= n_pieces; ++i)
      members[cluster[i]].push_back(i - 1);
    std::vector<std::vector<unsigned int>> joined(n_pieces + 1);
    for (const auto &entry : between)
      if (entry.first.first != ground)
        {
          joined[entry.first.first].push_back(entry.first.second);
          joined[entry.first.second].push_back(entry.first.first);
        }
    std::vector<FreeGroup> groups;
    std::vector<bool>      seen(n_pieces + 1, false);
    for (unsigned int start = 1; start <= n_pieces; ++start)
      if (cluster[start] == start && !seen[start])
        {
          std::vector<unsigned int> clusters = {start};
          seen[start]                        = true;
          for (std::size_t i = 0; i < clusters.size(); ++i)
            for (const unsigned int other : joined[clusters[i]])
              if (!seen[other])
                {
                  seen[other] = true;
                  clusters.push_back(other);
                }
          if (clusters.size() <= most_clusters)
            if (auto group = free_group(clusters, between, members); group.motions.cols() > 0)
              groups.push_back(std::move(group));
        }
    return groups;
  }

  template <int dim>
  typename RigidMotions<dim>::FreeGroup
  RigidMotions<dim>::free_group(const std::vector<unsigned int> &clusters, const std::map<Pair, Equations> &between,
                                const std::vector<std::vector<unsigned int>> &members) const
  {
    const auto place = [&](const unsigned int cluster) {
      return n_modes * (std::find(clusters.begin(), clusters.end(), cluster) - clusters.begin());
    };
    FreeGroup                    group;
    std::vector<Eigen::VectorXd> rows;
    const auto                   take = [&](const unsigned int a, const unsigned int b) {
      if (const auto found = between.find({a, b}); found != between.end())
        for (const auto &equation : found->second.basis)
          {
            Eigen::VectorXd row            = Eigen::VectorXd::Zero(n_modes * clusters.size());
            row.segment(place(b), n_modes) = equation;
            if (a != ground)
              row.segment(place(a), n_modes) = -equation;
            group.is_held |= a == ground;
            rows.push_back(row);
          }
    };
    for (const unsigned int b : clusters)
      {
        take(ground, b);
        for (const unsigned int a : clusters)
          if (a < b)
            take(a, b);
      }
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(std::max<std::size_t>(rows.size(), 1), n_modes * clusters.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
      system.row(i) = rows[i].transpose();
    Eigen::FullPivLU<Eigen::MatrixXd> factors(system);
    factors.setThreshold(tolerance);
    if (factors.dimensionOfKernel() == 0)
      return group;
    const Eigen::MatrixXd kernel = factors.kernel();
    for (const unsigned int c : clusters)
      group.pieces.insert(group.pieces.end(), members[c].begin(), members[c].end());
    group.motions.resize(n_modes * group.pieces.size(), kernel.cols());
    std::size_t p = 0;
    for (const unsigned int c : clusters)
      for (std::size_t i = 0; i < members[c].size(); ++i, ++p)
        group.motions.middleRows(n_modes * p, n_modes) = kernel.middleRows(place(c), n_modes);
    group.motions.colwise().normalize();
    return group;
  }

  template class RigidMotions<2>;
  template class RigidMotions<3>;
} // namespace Stroma
