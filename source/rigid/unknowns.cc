#include <stroma/rigid/unknowns.h>

#include <deal.II/base/mpi.h>

#include <Eigen/Dense>

#include <algorithm>

namespace Stroma::Rigid
{
  template <int dim>
  Unknowns<dim>::Unknowns(const Scene<dim> &scene)
    : scene(scene)
  {
    for (const auto &rigid : scene.rigid_bodies)
      {
        const auto corners = scene.bodies[rigid.body].bounding_box().get_boundary_points();
        lengths.push_back(.5 * corners.first.distance(corners.second));
      }
  }

  template <int dim>
  void
  Unknowns<dim>::number(dealii::IndexSet &owned, dealii::IndexSet &relevant)
  {
    first           = owned.size();
    const auto with = [&](dealii::IndexSet &of_material, const bool all) {
      dealii::IndexSet set(first + size());
      set.add_indices(of_material);
      if (all)
        set.add_range(first, first + size());
      set.compress();
      of_material = set;
    };
    const unsigned int n_ranks = dealii::Utilities::MPI::n_mpi_processes(scene.comm);
    with(owned, dealii::Utilities::MPI::this_mpi_process(scene.comm) + 1 == n_ranks);
    with(relevant, true);
  }

  template <int dim>
  unsigned int
  Unknowns<dim>::index_of(const unsigned int b) const
  {
    unsigned int r = 0;
    while (scene.rigid_bodies[r].body != b)
      ++r;
    return r;
  }

  template <int dim>
  bool
  Unknowns<dim>::is_prescribed(const unsigned int r, const unsigned int c) const
  {
    const auto &drive = scene.rigid_bodies[r].drive;
    if (c >= dim + n_rotations<dim>)
      return false;
    const auto kind = c < dim ? drive.translation[c] : drive.rotation[c - dim];
    return kind == DrivenBy::rest || kind == DrivenBy::displacement;
  }

  template <int dim>
  std::vector<std::pair<unsigned int, unsigned int>>
  Unknowns<dim>::all_prescribed() const
  {
    std::vector<std::pair<unsigned int, unsigned int>> all;
    for (unsigned int r = 0; r < scene.rigid_bodies.size(); ++r)
      for (unsigned int c = 0; c < per_body; ++c)
        if (is_prescribed(r, c))
          all.emplace_back(r, c);
    return all;
  }

  template <int dim>
  double
  Unknowns<dim>::prescribed_rate(const unsigned int r, const unsigned int c, const double t, const double h) const
  {
    const double now = prescribed(r, c, t);
    return (4. * (now - prescribed(r, c, t - h)) - (now - prescribed(r, c, t - 2. * h))) / (2. * h);
  }

  template <int dim>
  double
  Unknowns<dim>::prescribed(const unsigned int r, const unsigned int c, const double t) const
  {
    const auto pose = scene.rigid_bodies[r].pose(t);
    return c < dim ? pose.translation[c] : lengths[r] * pose.rotation[c - dim];
  }

  template <int dim>
  bool
  Unknowns<dim>::turn() const
  {
    return std::any_of(scene.rigid_bodies.begin(), scene.rigid_bodies.end(),
                       [](const auto &rigid) { return rigid.drive.turns(); });
  }

  template <int dim>
  std::vector<Pose<dim>>
  Unknowns<dim>::poses(const Vector &u) const
  {
    std::vector<double> values(size(), 0.);
    for (Dof i = 0; i < size(); ++i)
      if (u.has_ghost_elements() || u.in_local_range(first + i))
        values[i] = u(first + i);
    if (!u.has_ghost_elements())
      dealii::Utilities::MPI::sum(values, scene.comm, values);
    std::vector<Pose<dim>> poses(scene.rigid_bodies.size());
    for (unsigned int r = 0; r < poses.size(); ++r)
      {
        poses[r].pivot = scene.rigid_bodies[r].pivot;
        for (unsigned int c = 0; c < dim; ++c)
          poses[r].translation[c] = values[r * per_body + c];
        for (unsigned int k = 0; k < n_rotations<dim>; ++k)
          poses[r].rotation[k] = values[r * per_body + dim + k] / lengths[r];
      }
    return poses;
  }

  template <int dim>
  std::array<Axial<dim>, n_rotations<dim>>
  Unknowns<dim>::axes(const Axial<dim> &theta) const
  {
    std::array<Axial<dim>, n_rotations<dim>> columns;
    for (unsigned int k = 0; k < n_rotations<dim>; ++k)
      {
        Axial<dim> axis;
        axis[k]    = 1.;
        columns[k] = angular_velocity<dim>(theta, axis);
      }
    return columns;
  }

  template <int dim>
  Frame<dim>
  Unknowns<dim>::frame(const unsigned int r, const Pose<dim> &pose) const
  {
    constexpr unsigned int n           = n_rotations<dim>;
    constexpr double       h           = 1e-5; // [rad], of differences
    const auto             derivatives = [&](const Axial<dim> &theta) {
      const auto                            columns = axes(theta);
      const auto                            R = transpose(rotation_matrix<dim>(theta)); // its columns as rows
      std::array<dealii::Tensor<2, dim>, n> dR;
      for (unsigned int k = 0; k < n; ++k)
        {
          dealii::Tensor<2, dim> turned;
          for (unsigned int d = 0; d < dim; ++d)
            turned[d] = cross<dim>(columns[k], R[d]) / lengths[r];
          dR[k] = transpose(turned);
        }
      return dR;
    };
    Frame<dim> frame;
    frame.pose = pose;
    frame.R    = rotation_matrix<dim>(pose.rotation);
    frame.dR   = derivatives(pose.rotation);
    for (unsigned int l = 0; l < n && dim == 3; ++l)
      {
        Axial<dim> step;
        step[l]          = h;
        const auto above = derivatives(pose.rotation + step), below = derivatives(pose.rotation - step);
        for (unsigned int k = 0; k < n; ++k)
          frame.ddR[k][l] = (above[k] - below[k]) / (2. * h * lengths[r]);
      }
    if (dim == 2)
      frame.ddR[0][0] = -1. / (lengths[r] * lengths[r]) * frame.R;
    return frame;
  }

  template <int dim>
  void
  Unknowns<dim>::add_forces(const double t, Vector &external) const
  {
    for (unsigned int r = 0; r < scene.rigid_bodies.size(); ++r)
      {
        const auto force = scene.rigid_bodies[r].drive.force(t);
        for (unsigned int c = 0; c < dim; ++c)
          if (external.in_local_range(unknown(r, c)))
            external(unknown(r, c)) += force[c];
      }
  }

  template <int dim>
  Axial<dim>
  Unknowns<dim>::conjugate(const unsigned int r, const Axial<dim> &theta, const dealii::Tensor<2, dim> &virial,
                           const Axial<dim> &torque) const
  {
    const auto columns = axes(theta);
    const auto R       = transpose(rotation_matrix<dim>(theta)); // its columns as rows
    const auto M       = transpose(virial);
    Axial<dim> forces;
    for (unsigned int k = 0; k < n_rotations<dim>; ++k)
      {
        double work = columns[k] * torque;
        for (unsigned int d = 0; d < dim; ++d)
          work += M[d] * cross<dim>(columns[k], R[d]);
        forces[k] = work / lengths[r];
      }
    return forces;
  }

  template <int dim>
  Axial<dim>
  Unknowns<dim>::torque(const unsigned int r, const Axial<dim> &theta, const Axial<dim> &forces) const
  {
    constexpr unsigned int      n       = n_rotations<dim>;
    const auto                  columns = axes(theta);
    Eigen::Matrix<double, n, n> J_transposed;
    Eigen::Matrix<double, n, 1> conjugate;
    for (unsigned int k = 0; k < n; ++k)
      {
        conjugate(k) = forces[k] * lengths[r];
        for (unsigned int i = 0; i < n; ++i)
          J_transposed(k, i) = columns[k][i];
      }
    const Eigen::Matrix<double, n, 1> solved = J_transposed.partialPivLu().solve(conjugate);
    Axial<dim>                        torque;
    for (unsigned int k = 0; k < n; ++k)
      torque[k] = solved(k);
    return torque;
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  Unknowns<dim>::results(const Vector &u, const std::function<double(Dof)> &force_on) const
  {
    std::vector<std::pair<std::string, double>> all;
    const auto                                  where = poses(u);
    for (unsigned int r = 0; r < where.size(); ++r)
      {
        std::vector<double> forces(per_body, 0.);
        for (unsigned int c = 0; c < per_body; ++c)
          if (u.in_local_range(unknown(r, c)))
            forces[c] = force_on(unknown(r, c));
        dealii::Utilities::MPI::sum(forces, scene.comm, forces);
        dealii::Tensor<1, dim> force;
        Axial<dim>             conjugate;
        std::copy_n(forces.begin(), dim, force.begin_raw());
        std::copy_n(forces.begin() + dim, n_rotations<dim>, conjugate.begin_raw());
        for (const auto &result :
             scene.rigid_bodies[r].results(where[r], -force, -torque(r, where[r].rotation, conjugate)))
          all.push_back(result);
      }
    return all;
  }

  template <int dim>
  void
  Unknowns<dim>::add_pattern(Solvers::Pattern &pattern) const
  {
    for (Dof i = first; i < first + size(); ++i)
      if (pattern.in_local_range(i))
        pattern.add(i, i);
  }

  template <int dim>
  void
  Unknowns<dim>::fill_empty_rows(Matrix &K, Vector &r, const Solvers::Constraints &constraints) const
  {
    const double scale = scene.materials.front()->p_wave_modulus() * scene.thickness;
    for (Dof i = first; i < first + size(); ++i)
      if (K.in_local_range(i) && K.diag_element(i) == 0.)
        {
          K.set(i, i, scale);
          r(i) = constraints.is_constrained(i) ? scale * constraints.get_inhomogeneity(i) : 0.;
        }
    K.compress(dealii::VectorOperation::insert);
    r.compress(dealii::VectorOperation::insert);
  }

  template <int dim>
  void
  Unknowns<dim>::set_motions(std::vector<Vector> &modes, const dealii::Point<dim> &centre, const double length,
                             const std::function<bool(Dof)> &is_held) const
  {
    const auto set = [&](const unsigned int mode, const Dof dof, const double value) {
      if (modes[mode].in_local_range(dof) && !is_held(dof))
        modes[mode](dof) = value;
    };
    for (unsigned int r = 0; r < scene.rigid_bodies.size(); ++r)
      for (unsigned int k = 0; k < n_rotations<dim>; ++k)
        {
          Axial<dim> axis;
          axis[k]        = 1. / length;
          const auto arm = cross<dim>(axis, scene.rigid_bodies[r].pivot - centre);
          for (unsigned int c = 0; c < dim; ++c)
            {
              set(c, unknown(r, c), 1.);
              set(dim + k, unknown(r, c), arm[c]);
            }
          set(dim + k, unknown(r, dim + k), lengths[r] / length);
        }
  }

  template <int dim>
  void
  Unknowns<dim>::hold(RigidMotions<dim> &motions, const unsigned int first_piece,
                      const std::function<bool(Dof)> &is_held) const
  {
    for (unsigned int r = 0; r < scene.rigid_bodies.size(); ++r)
      {
        if (is_held(unknown(r, dim)))
          motions.hold_turns(first_piece + r);
        for (unsigned int c = 0; c < dim; ++c)
          if (is_held(unknown(r, c)))
            motions.hold(first_piece + r, scene.rigid_bodies[r].pivot, c);
      }
  }

  template <int dim>
  void
  Unknowns<dim>::visit_loads(const double t, const unsigned int first_piece,
                             const typename FreeParts<dim>::AddForce &add) const
  {
    if (dealii::Utilities::MPI::this_mpi_process(scene.comm) == 0)
      for (unsigned int r = 0; r < scene.rigid_bodies.size(); ++r)
        add(first_piece + r, scene.rigid_bodies[r].pivot, scene.rigid_bodies[r].drive.force(t));
    visit_torques(t, first_piece, add);
  }

  template <int dim>
  void
  Unknowns<dim>::visit_torques(const double t, const unsigned int first_piece,
                               const typename FreeParts<dim>::AddForce &add) const
  {
    if (dealii::Utilities::MPI::this_mpi_process(scene.comm) != 0)
      return;
    for (unsigned int r = 0; r < scene.rigid_bodies.size(); ++r)
      {
        const auto &rigid  = scene.rigid_bodies[r];
        const auto  torque = rigid.drive.torque(t);
        for (unsigned int k = 0; k < n_rotations<dim>; ++k)
          {
            const unsigned int along = dim == 2 ? 0 : (k + 1) % 3, across = dim == 2 ? 1 : (k + 2) % 3;
            const auto         arm   = lengths[r] * dealii::Point<dim>::unit_vector(along);
            const auto         force = .5 * torque[k] / lengths[r] * dealii::Point<dim>::unit_vector(across);
            add(first_piece + r, rigid.pivot + arm, force);
            add(first_piece + r, dealii::Point<dim>(rigid.pivot - arm), -force);
          }
      }
  }

  template struct Frame<2>;
  template struct Frame<3>;
  template class Unknowns<2>;
  template class Unknowns<3>;
} // namespace Stroma::Rigid
