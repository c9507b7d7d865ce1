#include <stroma/particles/lattice_sum.h>
#include <stroma/sph/contact_state.h>
#include <stroma/sph/pairs.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace Stroma::Sph
{
  using dealii::Tensor;

  namespace
  {
    /// Closest that particle i is taken to be to a wall, over the spacing: bounds beta. Walls seen too far off cost accuracy
    /// beside curved bodies (cylinder array: 1.5 % of the drag at 40 particles a side, .6 % with the smaller one), but with
    /// explicit stresses stable steps would shrink as 1/beta.
    constexpr double least_distance = .02, least_distance_explicit = .25;
  } // namespace

  template <int dim>
  Pairs<dim>::Pairs(const Scene<dim> &scene, const std::vector<Mover<dim>> &movers, const Settings &settings)
    : scene(scene)
    , movers(movers)
    , settings(settings)
    , least_gap((settings.stress_update == StressUpdate::implicit_ ? least_distance : least_distance_explicit) *
                settings.arrangement.spacing)
  {
    for (unsigned int m = 0; m < movers.size() && !scene.contacts.empty(); ++m)
      {
        contact_of.push_back(-1);
        for (unsigned int c = 0; c < scene.contacts.size(); ++c)
          if (movers[m].rigid && movers[m].rigid->body == scene.contacts[c].body)
            contact_of.back() = static_cast<int>(c);
      }
    if (!settings.published() && std::isfinite(settings.arrangement.spacing)) // not so for `stroma template`
      with_kernel<dim>(settings.kernel, settings.h(), [&](const auto &kernel) {
        const auto &arrangement = settings.arrangement;
        F_factor                = 1. / lattice_sum<dim>(kernel.support(), arrangement.spacing, arrangement.name,
                                         [&](const double r) { return kernel.F(r) * r * r / dim; });
      });
    if (settings.walls == Walls::facets && !movers.empty() && std::isfinite(settings.arrangement.spacing))
      facets = std::make_unique<WallFacets<dim>>(scene, movers, settings.kernel, settings.h(),
                                                 settings.arrangement.spacing, !settings.published());
  }

  template <int dim>
  StepStatus
  Pairs<dim>::update(const ParticleSet<dim> &particles, const Neighbours<dim> &neighbours, const double t,
                     const std::vector<Rigid::Pose<dim>> &poses)
  {
    rotated_back.clear();
    for (const auto &pose : poses)
      rotated_back.push_back(transpose(Rigid::rotation_matrix<dim>(pose.rotation)));
    if (facets)
      look_at_facets(particles, neighbours, t, poses);
    find_turns(particles, t);
    const auto status = with_kernel<dim>(settings.kernel, settings.h(), [&](const auto &kernel) {
      return add_rows(particles, neighbours, kernel, t);
    });
    return reduce(status, neighbours.communicator());
  }

  template <int dim>
  template <typename KernelType>
  StepStatus
  Pairs<dim>::add_rows(const ParticleSet<dim> &particles, const Neighbours<dim> &neighbours, const KernelType &kernel,
                       const double t)
  {
    n_particles = particles.size();
    n_free      = particles.n_free;
    walls.clear();
    touching.clear();
    in_touch.assign(contact_of.empty() ? 0 : neighbours.n_rows(), 0);
    volume_share.clear();
    face.clear();
    const unsigned int n       = neighbours.n_rows();
    const double       support = kernel.support();
    const double       eta2    = settings.published() ? .01 * settings.h() * settings.h() : 0.;
    const double       closest = 1e-3 * settings.arrangement.spacing;
    resize(neighbours.neighbour.size() + parts.size());
    row_start.assign(1, 0);
    row_fixed.clear();
    row_later.clear();
    others_first.clear();
    StepStatus   status = StepStatus::ok;
    unsigned int q      = 0; // pairs so far
    for (unsigned int i = 0; i < n; ++i)
      {
        const auto   x_i = particles.x[i];
        const double V_i = F_factor * particles.volume(i);
        for (unsigned int p = neighbours.row_start[i]; p < neighbours.row_start[i + 1]; ++p)
          {
            const unsigned int k    = neighbours.neighbour[p];
            const auto         r_ik = particles.x[k] - x_i;
            const double       r2   = r_ik.norm_square();
            if (r2 >= support * support || !may_meet(particles, i, k))
              continue;
            if (r2 < closest * closest)
              status = StepStatus::moved_too_far;
            const double raw = kernel.F(std::sqrt(r2)) * V_i * particles.volume(k);
            j[q]             = k;
            r[q]             = r_ik;
            P[q]             = raw;
            c[q]             = 2. * raw * r_ik;
            friction[q]      = eta2 > 0. ? raw * r2 / (r2 + eta2) : raw;
            ++q;
          }
        row_fixed.push_back(std::partition_point(j.begin() + row_start[i], j.begin() + q,
                                                 [&](const unsigned int k) { return !particles.is_fixed(k); }) -
                            j.begin());
        find_later(particles, i);
        if (facets)
          q = settings.published() ? add_segments(particles, i, q) : add_facets(particles, i, q);
        row_start.push_back(q);
        for (unsigned int p = row_fixed[i]; p < q && !settings.published() && !facets; ++p)
          add_wall_point(particles, i, p, particles.volume(j[p]) * kernel.W(r[p].norm()), t);
        if (!contact_of.empty())
          row_start.back() = q = add_touching(particles, i, q);
      }
    resize(q);
    if (has_segments())
      volume_share.assign(gamma.begin(), gamma.begin() + n);
    return status;
  }

  /// Of row @p i, whose free neighbours are there.
  template <int dim>
  void
  Pairs<dim>::find_later(const ParticleSet<dim> &particles, const unsigned int i)
  {
    unsigned int p = row_start[i];
    for (; p < row_fixed[i] && particles.id[j[p]] < particles.id[i]; ++p)
      if (j[p] >= particles.n_owned && i < n_free)
        others_first.push_back({i, p});
    row_later.push_back(p);
  }

  /// Pairs of a particle with a body that has a contact are there while it touches the body.
  template <int dim>
  bool
  Pairs<dim>::may_meet(const ParticleSet<dim> &particles, const unsigned int i, const unsigned int k) const
  {
    if (contact_of.empty() || particles.is_fixed(i) == particles.is_fixed(k))
      return true;
    const bool i_is_fixed = particles.is_fixed(i);
    return may_meet_mover(particles, i_is_fixed ? k : i, particles.mover[i_is_fixed ? i : k]);
  }

  template <int dim>
  bool
  Pairs<dim>::may_meet_mover(const ParticleSet<dim> &particles, const unsigned int i, const unsigned int m) const
  {
    return contact_of.empty() || contact_of[m] < 0 ||
           (particles.contact[i] & ContactState::touches(contact_of[m])) != 0;
  }

  /// Pairs of row @p i that meet bodies with a contact; where these are frictionless, those of a body become one. Returns the end
  /// of the row, which was @p end.
  template <int dim>
  unsigned int
  Pairs<dim>::add_touching(const ParticleSet<dim> &particles, const unsigned int i, unsigned int end)
  {
    if (particles.is_fixed(i))
      return end;
    for (unsigned int p = row_fixed[i]; p < end; ++p)
      {
        const int contact = contact_of[meets_wall_point(p) ? wall(p).mover : particles.mover[j[p]]];
        if (contact < 0)
          continue;
        const auto type   = scene.contacts[contact].type;
        const bool slides = meets_wall_point(p) && (type == Contact::Type::frictionless ||
                                                    (particles.contact[i] & ContactState::slides(contact)) != 0);
        if (slides)
          end = join(p, end);
        in_touch[i] = 1;
        touching.push_back({i, p, static_cast<unsigned int>(contact), slides});
      }
    return end;
  }

  /// Makes one pair, @p first, of those up to @p end that meet the same mover: with the nearest place of the body, and what they
  /// have along the normal. Returns the new end.
  template <int dim>
  unsigned int
  Pairs<dim>::join(const unsigned int first, const unsigned int end)
  {
    WallPoint   &point  = walls[j[first] - n_particles];
    const auto   n      = point.normal;
    const double gap    = std::max(point.gap, least_gap);
    double       moment = 0., area = 0., viscous = 0., missing = 0.;
    unsigned int others = first + 1; // of other movers
    for (unsigned int p = first; p < end; ++p)
      if (wall(p).mover == point.mover)
        {
          moment += P[p] * (r[p] * n) * (r[p] * n);
          area += c[p] * n;
          viscous += friction[p];
          missing += wall(p).missing;
        }
      else
        {
          j[others]        = j[p];
          r[others]        = r[p];
          P[others]        = P[p];
          c[others]        = c[p];
          friction[others] = friction[p];
          ++others;
        }
    point.X         = point.X - rotated_back[point.mover] * (r[first] + gap * n);
    point.slides    = true;
    point.missing   = missing;
    r[first]        = -gap * n;
    P[first]        = moment / (gap * gap);
    c[first]        = area * n;
    friction[first] = viscous;
    return others;
  }

  template <int dim>
  void
  Pairs<dim>::let_slide(std::vector<Tensor<1, dim>> &v) const
  {
    for (const auto &pair : touching)
      if (pair.slides)
        v[j[pair.p]] = v[pair.i] + along_normal(pair.p, v[j[pair.p]] - v[pair.i]);
  }

  template <int dim>
  void
  Pairs<dim>::leave_out_touching()
  {
    for (const auto &pair : touching)
      P[pair.p] = 0.;
  }

  template <int dim>
  void
  Pairs<dim>::resize(const std::size_t n)
  {
    j.resize(n);
    r.resize(n);
    P.resize(n);
    c.resize(n);
    friction.resize(n);
  }

  template <int dim>
  void
  Pairs<dim>::extrapolate(const std::size_t p, const double beta)
  {
    r[p] /= beta;
    P[p] *= beta * beta;
    c[p] *= beta;
    friction[p] *= beta;
  }

  template <int dim>
  void
  Pairs<dim>::add_wall_point(const ParticleSet<dim> &particles, const unsigned int i, const std::size_t p,
                             const double missing, const double t)
  {
    const unsigned int k       = j[p];
    const unsigned int m       = particles.mover[k];
    const Mover<dim>  &wall    = movers[m];
    const auto         r_ki    = particles.x[i] - particles.x[k];
    const auto         surface = wall.nearest(scene, particles.X[k] + turn_back(particles, k) * r_ki);
    extrapolate(p, 1. - wall.distance(scene, particles.X[k]) / std::max(surface.distance, least_gap));
    const auto X      = place_on_wall(particles, k, r_ki + r[p], t);
    j[p]              = n_points();
    const auto normal = wall.deforms() ? turns[k].there * surface.normal : surface.normal * rotated_back[m];
    walls.push_back({m, X, normal, surface.distance, missing});
  }

  template <int dim>
  void
  Pairs<dim>::find_turns(const ParticleSet<dim> &particles, const double t)
  {
    turns.clear();
    if (std::none_of(movers.begin(), movers.end(), [](const auto &mover) { return mover.deforms(); }))
      return;
    turns.resize(particles.size());
    for (unsigned int k = 0; k < particles.size(); ++k)
      if (particles.is_fixed(k) && movers[particles.mover[k]].deforms())
        {
          turns[k].there = movers[particles.mover[k]].gradient_of_motion(scene, particles.X[k], t);
          turns[k].back  = invert(turns[k].there);
        }
  }

  /// Where a side moves by a displacement u that varies along it, the place whose X + u(X) is where the line crosses it, by two
  /// rounds of Newton's method with the gradient beside the particle.
  template <int dim>
  dealii::Point<dim>
  Pairs<dim>::place_on_wall(const ParticleSet<dim> &particles, const unsigned int k, const dealii::Tensor<1, dim> &r,
                            const double t) const
  {
    const Mover<dim> &wall = movers[particles.mover[k]];
    const auto       &X_k  = particles.X[k];
    const auto       &back = turn_back(particles, k);
    auto              X    = wall.foot(X_k + back * r);
    if (!wall.deforms())
      return X;
    const auto at  = wall.foot(X_k);
    const auto now = at + wall.displacement(scene, at, t) + turns[k].there * (X_k - at) + r;
    for (unsigned int round = 0; round < 2; ++round)
      X = wall.foot(X + back * (now - X - wall.displacement(scene, X, t)));
    return X;
  }

  template <int dim>
  double
  Pairs<dim>::kernel_sum(const ParticleSet<dim> &particles, const unsigned int i, const bool material_only) const
  {
    return with_kernel<dim>(settings.kernel, settings.h(), [&](const auto &kernel) {
      double psi = particles.volume(i) * kernel.W(0.);
      for (unsigned int p = row_start[i]; p < (material_only ? row_fixed[i] : row_start[i + 1]); ++p)
        psi += meets_wall_point(p) ? wall(p).missing :
                                     particles.volume(j[p]) * kernel.W((particles.x[j[p]] - particles.x[i]).norm());
      return psi;
    });
  }

  template class Pairs<2>;
  template class Pairs<3>;
} // namespace Stroma::Sph
