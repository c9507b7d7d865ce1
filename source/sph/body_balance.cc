#include <stroma/sph/body_balance.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Sph
{
  using dealii::Tensor;

  namespace
  {
    /// Number @p k of Rigid::n_motions.
    template <int dim>
    double &
    number(Rigid::Twist<dim> &twist, const unsigned int k)
    {
      return k < dim ? twist.velocity[k] : twist.angular_velocity[k - dim];
    }
  } // namespace

  template <int dim>
  BodyBalance<dim>::BodyBalance(const Scene<dim> &scene, const std::vector<Mover<dim>> &movers)
    : scene(scene)
    , movers(movers)
    , first(1, 0)
    , n_pairs(movers.size())
    , drag_now(movers.size())
  {
    for (unsigned int m = 0; m < movers.size(); ++m)
      {
        const auto *const rigid = movers[m].rigid;
        for (unsigned int k = 0; rigid && k < Rigid::n_motions<dim>; ++k)
          if (is_by_balance(k < dim ? rigid->drive.translation[k] : rigid->drive.rotation[k - dim]))
            unknowns.push_back({m, k});
        first.push_back(size());
        length.push_back(rigid ? Rigid::gyration(*rigid) : 1.);
      }
    drag.reinit(size(), size());
  }

  template <int dim>
  void
  BodyBalance<dim>::update(const ParticleSet<dim> &particles, const Pairs<dim> &pairs,
                           const std::vector<Rigid::Pose<dim>> &poses_of_pairs)
  {
    poses = poses_of_pairs;
    rows.clear();
    ends.clear();
    n_pairs.assign(movers.size(), 0);
    rotation.clear();
    for (const auto &pose : poses)
      rotation.push_back(Rigid::rotation_matrix<dim>(pose.rotation));
    for (unsigned int i = 0; i < particles.n_free; ++i)
      {
        const std::size_t begin = pairs.row_fixed[i], end = pairs.row_start[i + 1], n_before = ends.size();
        bool              sees = false;
        for (std::size_t p = begin; p < end; ++p)
          {
            const unsigned int m = pairs.mover(particles, p);
            ends.push_back({none, {}});
            if (!moves(m))
              continue;
            ends.back() = {m, arm(m, pairs.place_on_wall(particles, p))};
            sees        = true;
            ++n_pairs[m];
          }
        if (sees)
          rows.push_back({i, begin, n_before, end - begin, 1. / pairs.row_factor(i)});
        else
          ends.resize(n_before);
      }
    find_places(particles, pairs);
    dealii::Utilities::MPI::sum(n_pairs, scene.comm, n_pairs);
  }

  /// Published pairs end in fixed particles, all others in points of their own.
  template <int dim>
  void
  BodyBalance<dim>::find_places(const ParticleSet<dim> &particles, const Pairs<dim> &pairs)
  {
    places.clear();
    for (unsigned int i = particles.n_free; i < particles.size(); ++i)
      if (particles.is_fixed(i) && moves(particles.mover[i]))
        places.push_back({static_cast<unsigned int>(particles.mover[i]), i, arm(particles.mover[i], particles.X[i])});
    for (const auto &row : rows)
      for (std::size_t e = row.first; e < row.first + row.size; ++e)
        if (const unsigned int point = pairs.j[row.first_pair + (e - row.first)];
            ends[e].mover != none && point >= particles.size())
          places.push_back({ends[e].mover, point, ends[e].arm});
  }

  template <int dim>
  bool
  BodyBalance<dim>::resists(const unsigned int m) const
  {
    const auto &resistance = movers[m].rigid->resistance;
    return resistance.drag > 0. || (resistance.largest_approach > 0. && !touches(m));
  }

  template <int dim>
  typename BodyBalance<dim>::Unknowns
  BodyBalance<dim>::unknowns_of(const Twists &twists) const
  {
    Unknowns q;
    for (const auto &[m, k] : unknowns)
      {
        auto twist = twists[m];
        q.push_back(number(twist, k) * (k < dim ? 1. : length[m]));
      }
    return q;
  }

  template <int dim>
  typename BodyBalance<dim>::Twists
  BodyBalance<dim>::twists_of(const Unknowns &q) const
  {
    Twists twists(movers.size());
    for (unsigned int u = 0; u < size(); ++u)
      {
        const auto [m, k]    = unknowns[u];
        number(twists[m], k) = q[u] / (k < dim ? 1. : length[m]);
      }
    return twists;
  }

  template <int dim>
  void
  BodyBalance<dim>::add_velocities(Velocities &v, const Unknowns &q) const
  {
    const auto twists = twists_of(q);
    for (const Place &place : places)
      v[place.point] += twists[place.mover].at(place.arm);
  }

  template <int dim>
  void
  BodyBalance<dim>::set_velocities(Velocities &v, const Unknowns &q) const
  {
    const auto twists = twists_of(q);
    for (const Place &place : places)
      v[place.point] = twists[place.mover].at(place.arm);
  }

  template <int dim>
  typename BodyBalance<dim>::Unknowns
  BodyBalance<dim>::sum(const std::vector<Rigid::Wrench<dim>> &wrenches) const
  {
    Unknowns forces;
    for (const auto &[m, k] : unknowns)
      forces.push_back(k < dim ? wrenches[m].force[k] : wrenches[m].torque[k - dim] / length[m]);
    dealii::Utilities::MPI::sum(forces, scene.comm, forces);
    return forces;
  }

  template <int dim>
  std::vector<Rigid::Wrench<dim>>
  BodyBalance<dim>::wrenches_of(const Unknowns &forces) const
  {
    std::vector<Rigid::Wrench<dim>> wrenches(movers.size());
    for (unsigned int u = 0; u < size(); ++u)
      {
        const auto [m, k] = unknowns[u];
        if (k < dim)
          wrenches[m].force[k] = forces[u];
        else
          wrenches[m].torque[k - dim] = forces[u] * length[m];
      }
    return wrenches;
  }

  template <int dim>
  typename BodyBalance<dim>::Unknowns
  BodyBalance<dim>::loads(const double t) const
  {
    Unknowns forces;
    for (const auto &[m, k] : unknowns)
      {
        const auto &drive = movers[m].rigid->drive;
        forces.push_back((k < dim ? drive.force(t)[k] : drive.torque(t)[k - dim] / length[m]) / thickness());
      }
    return forces;
  }

  template <int dim>
  double
  BodyBalance<dim>::least_of(const Unknowns &loads) const
  {
    double least = std::numeric_limits<double>::infinity();
    for (unsigned int m = 0; m < movers.size(); ++m)
      {
        double square = 0.;
        for (unsigned int u = first[m]; u < first[m + 1]; ++u)
          square += loads[u] * loads[u];
        if (square > 0.)
          least = std::min(least, std::sqrt(square));
      }
    return least;
  }

  template <int dim>
  void
  BodyBalance<dim>::set_resistance(const double t, const double dt)
  {
    acting = loads(t);
    for (unsigned int m = 0; m < movers.size(); ++m)
      {
        if (!moves(m))
          continue;
        const auto  &rigid    = *movers[m].rigid;
        const double approach = rigid.resistance.largest_approach;
        drag_now[m]           = rigid.resistance.drag / thickness();
        if (approach > 0. && !touches(m))
          {
            double force = 0.;
            for (unsigned int u = first[m]; u < first[m + 1]; ++u)
              force += std::abs(acting[u]);
            drag_now[m] = std::max({drag_now[m], force * dt / approach, std::numeric_limits<double>::min()});
          }
      }
    drag = spread(drag_now);
  }

  template <int dim>
  dealii::FullMatrix<double>
  BodyBalance<dim>::spread(const std::vector<double> &amounts) const
  {
    dealii::FullMatrix<double> matrix(size(), size());
    for (unsigned int m = 0; m < movers.size(); ++m)
      {
        if (!moves(m))
          continue;
        const auto M = Rigid::mass_matrix(*movers[m].rigid, amounts[m], poses[m]);
        for (unsigned int u = first[m]; u < first[m + 1]; ++u)
          for (unsigned int w = first[m]; w < first[m + 1]; ++w)
            {
              const unsigned int k = unknowns[u].motion, l = unknowns[w].motion;
              matrix(u, w) = M(k, l) / ((k < dim ? 1. : length[m]) * (l < dim ? 1. : length[m]));
            }
      }
    return matrix;
  }

  template <int dim>
  std::vector<double>
  BodyBalance<dim>::masses() const
  {
    std::vector<double> all;
    for (const auto &mover : movers)
      all.push_back(mover.rigid ? mover.rigid->resistance.mass / thickness() : 0.);
    return all;
  }

  template <int dim>
  typename BodyBalance<dim>::Unknowns
  BodyBalance<dim>::rates(const Unknowns &forces, const Unknowns &q, const dealii::FullMatrix<double> &resisting,
                          const dealii::FullMatrix<double> &inverse_mass) const
  {
    dealii::Vector<double> left(forces.begin(), forces.end()), rates(size());
    if (!resisting.empty())
      {
        resisting.residual(rates, dealii::Vector<double>(q.begin(), q.end()), left); // left - resisting q
        left = rates;
      }
    inverse_mass.vmult(rates, left);
    return {rates.begin(), rates.end()};
  }

  template <int dim>
  typename BodyBalance<dim>::Unknowns
  BodyBalance<dim>::drag_force(const Twists &twists) const
  {
    Unknowns forces(size());
    for (unsigned int u = 0; u < size(); ++u)
      {
        const auto [m, k] = unknowns[u];
        const auto M      = Rigid::mass_matrix(*movers[m].rigid, drag_now[m], poses[m]);
        auto       twist  = twists[m];
        for (unsigned int l = 0; l < Rigid::n_motions<dim>; ++l)
          forces[u] -= M(k, l) * number(twist, l) / (k < dim ? 1. : length[m]);
      }
    return forces;
  }

  template <int dim>
  Tensor<1, dim>
  BodyBalance<dim>::motion(const unsigned int u, const Tensor<1, dim> &arm) const
  {
    const auto [m, k] = unknowns[u];
    Rigid::Twist<dim> twist;
    number(twist, k) = k < dim ? 1. : 1. / length[m];
    return twist.at(arm);
  }

  template <int dim>
  void
  BodyBalance<dim>::add_block(dealii::FullMatrix<double> &sum, const End &end,
                              const dealii::SymmetricTensor<2, dim> &block) const
  {
    for (unsigned int u = first[end.mover]; u < first[end.mover + 1]; ++u)
      for (unsigned int w = first[end.mover]; w < first[end.mover + 1]; ++w)
        sum(u, w) += motion(u, end.arm) * (block * motion(w, end.arm));
  }

  template class BodyBalance<2>;
  template class BodyBalance<3>;
} // namespace Stroma::Sph
