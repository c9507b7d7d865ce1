#pragma once

#include <stroma/sph/constitution.h>
#include <stroma/sph/degraded_friction.h>
#include <stroma/sph/degraded_shear.h>
#include <stroma/sph/interfaces.h>
#include <stroma/sph/wall_pressure.h>

#include <memory>

namespace Stroma::Sph
{
  /**
   * Forces from stress, and how they change with a displacement: with the area vectors c_ij of the pairs
   *   L_i = 1/(2 V_i) sum_j (v_j - v_i) (x) c_ij B_i,     f_i = 1/2 sum_j (sigma_i B_i^T + sigma_j B_j^T) c_ij,
   * each minus the adjoint of the other, so that K_el = G^T V C G is symmetric ((9) of Heck 2017 has c_ij = 2 V_i V_j nabla_i W
   * and B = I). The correction B_i makes the gradient of linear velocities exact also where area vectors cannot do all that
   * is asked of them, at free surfaces: or else the rotation of a slender body, much larger than its strains, would cost energy.
   *
   * The gradient is smoothed, so modes of the size of the spacing are too soft, or not seen at all (hourglass modes). They are resisted by
   *   E = 1/2 sum_ij a_i P_ij |d_ij|^2,   d_ij = v_j - v_i - H_i (x_j - x_i),   a_i = s 4d/3 G_i V_i / sum_j P_ij r^2,
   * H_i the gradient of least squares with weights P, so E vanishes for linear velocities and H is where it is least (after
   * Ganzenmueller 2015). To leading order the smoothed energy of a wave of number k is (1 - k^2 m/(d + 2)) too small,
   * m = sum P r^4/sum P r^2; s = 1 adds just that much for shear. The forces of the state are those of HourglassControl.
   *
   * The friction of the central form, rate of deformation times 2 mu and 5/3 mu, has the same shape, so it is taken along here with
   * moduli mu and 5/3 mu (consistent formulation): central forces between the pairs of a lattice are too weak in its directions
   * by a fifth at the usual supports. combine() says how much of either is meant.
   *
   * Where materials of different moduli meet, pairs across are those of Interfaces: it changes L_i, and what forces come of stresses.
   *
   * Where a solid is degraded, its shear stress is that of DegradedShear, friction where factors differ that of DegradedFriction, and
   * hourglass control goes with the least factor around. There volumes are those of a vessel that cells fill: dilatation and mean stress m_i go
   * without B,
   *   tr L_i = 1/(2 V_i) sum_j (v_j - v_i).c_ij,     sigma_i B_i^T is (sigma_i - m_i I) B_i^T + m_i I,
   * so that V_i tr L_i of all particles sum up to what walls and bodies sweep, and a uniform pressure has no force, both as well as areas are closed.
   *
   * Fixed particles without a row have neither stress nor gradient: their pairs act as pairs with a point of the wall, where the
   * pressure of a fluid is continued by WallPressure. V_i is that share of a particle's volume which AreaVectors gives it.
   */
  template <int dim>
  class Elasticity
  {
  public:
    /// @param stabilisation s; 0: no hourglass control
    /// @param is_corrected whether gradients are, by B
    /// @param continues_pressure to walls: of fluids
    /// @param interfaces between materials, updated before; none: there are none
    /// @param degraded where something degrades @param degraded_friction the same
    Elasticity(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
               const std::vector<Constitution> &constitutions, double stabilisation, bool is_corrected,
               bool continues_pressure, const Interfaces<dim> *interfaces = nullptr,
               DegradedShear<dim> *degraded = nullptr, DegradedFriction<dim> *degraded_friction = nullptr);

    /// For the pairs and the volumes as they are now: tangent moduli, a_i, and moments. @p particles with ghosts. Collective.
    void update(const ParticleSet<dim> &particles);

    /// For degradation factors that have changed. Local.
    void update_degradation();

    /// Moduli of what follows: @p elastic times the tangent ones, and @p viscous times those of friction. Collective.
    void combine(double elastic, double viscous) const;

    /// sigma_i B_i^T, its mean without B where something degrades: what a stress is in the sums of forces.
    dealii::Tensor<2, dim>
    conjugate(const unsigned int i, const dealii::Tensor<2, dim> &sigma) const
    {
      if (correction.empty())
        return sigma;
      const auto B_T = transpose(correction[i]);
      return degraded ? sigma * B_T + trace(sigma) / dim * (unit() - B_T) : sigma * B_T;
    }

    /// L_i of all rows from velocities @p v with ghosts [1/s].
    /// Collective.
    void velocity_gradient(std::vector<dealii::Tensor<2, dim>> &L, const std::vector<dealii::Tensor<1, dim>> &v) const;

    /// L_i += the dilatation at walls of velocities @p v, which changes volumes but has no friction. Collective.
    void add_wall_dilatation(std::vector<dealii::Tensor<2, dim>>       &L,
                             const std::vector<dealii::Tensor<1, dim>> &v) const;

    /// f += of @p stresses, ghosts included, on free particles [N].
    /// @param shear deviatoric part of them; needed where something degrades
    void add_stress_force(std::vector<dealii::Tensor<1, dim>>                &f,
                          const std::vector<dealii::SymmetricTensor<2, dim>> &stresses,
                          const std::vector<dealii::SymmetricTensor<2, dim>> *shear = nullptr) const;
    /// What visit_wall_forces() goes by, without the sums. Collective.
    void set_stresses(const std::vector<dealii::SymmetricTensor<2, dim>> &stresses,
                      const std::vector<dealii::SymmetricTensor<2, dim>> *shear = nullptr) const;
    /// After add_stress_force() or set_stresses(): the parts of the pairs of row @p i with walls in it; calls visit(p, force).
    template <typename Visit>
    void
    visit_wall_forces(const unsigned int i, const Visit &visit) const
    {
      const auto g = walls ? walls->gradient(i, mean_stress) : dealii::Tensor<1, dim>();
      for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
        {
          const auto force = stress_force(i, p);
          visit(p, walls ? force + walls->pair_force(p, g) : force);
        }
    }

    /// What an increment of displacement @p u (ghosts included) does: f += -K u, K of the moduli last combined. Collective.
    void add_stiffness_force(std::vector<dealii::Tensor<1, dim>>       &f,
                             const std::vector<dealii::Tensor<1, dim>> &u) const;

    /// What pair_force() and visit_wall_responses() go by, without the sums. Collective.
    void set_increment(const std::vector<dealii::Tensor<1, dim>> &u) const;

    /// Of solids without interfaces or degradation: adds what increment @p u does to the stresses of set_stresses(). Collective.
    void add_increment(const std::vector<dealii::Tensor<1, dim>> &u) const;
    /// After set_stresses() and add_increment(u): f += both, and in the same sums the forces @p more, as Pairs::add_forces() takes them.
    template <typename Row>
    void
    add_forces_with(std::vector<dealii::Tensor<1, dim>> &f, const std::vector<dealii::Tensor<1, dim>> &u,
                    const Row &more) const
    {
      pairs.add_forces(f, [own = rows_of_increment<true>(u), &more](const unsigned int i) {
        return [own_i = own(i), more_i = more(i)](const unsigned int p) { return own_i(p) + more_i(p); };
      });
    }

    /// After add_stiffness_force(f, u) or set_increment(u): the part of pair @p p in it.
    dealii::Tensor<1, dim> pair_force(unsigned int i, std::size_t p,
                                      const std::vector<dealii::Tensor<1, dim>> &u) const;

    /// After these: the parts of the pairs of row @p i with fixed particles in it; calls visit(p, force).
    template <typename Visit>
    void
    visit_wall_responses(const unsigned int i, const std::vector<dealii::Tensor<1, dim>> &u, const Visit &visit) const
    {
      visit_wall_forces(i, [&](const unsigned int p, const dealii::Tensor<1, dim> &force) {
        visit(p, has_hourglass_control() ? force + hourglass_pair_force(i, p, u) : force);
      });
    }

    /// Block of pair @p p of row @p i in a stiffness between neighbours alone that is like K for smooth motions:
    /// (G - B) P + (d + 2) B P e (x) e, B = (K + G/3)/2, each at least 0.
    dealii::SymmetricTensor<2, dim> pair_block(unsigned int i, std::size_t p) const;

    /// What stress and hourglass control of row @p i are made of besides its pairs: moduli as combined, the shear modulus that share
    /// which is not degraded.
    struct Row
    {
      double                 volume, G, K, a;
      dealii::Tensor<2, dim> correction, inverse_moment;
    };
    Row row(unsigned int i) const;

    /// Adds about the diagonal blocks of K.
    void add_diagonal(std::vector<dealii::SymmetricTensor<2, dim>> &blocks) const;

    /// P of the pairs, what hourglass control goes by.
    const std::vector<double> &
    weights() const
    {
      return degraded ? degraded_friction->weights() : pairs.P;
    }

    bool
    has_hourglass_control() const
    {
      return stabilisation > 0.;
    }
    /// a_i of the moduli at rest [Pa]; 0 for particles that nothing resists.
    double
    hourglass_stiffness(const unsigned int i) const
    {
      return hourglass_per_G[i] * G[i] * (degraded ? degraded->least(i) : 1.);
    }

  private:
    void conjugate_stresses(bool of_jumps) const;
    /// pair_block() of one with a facet.
    dealii::SymmetricTensor<2, dim> facet_block(unsigned int i, std::size_t p) const;
    /// Stress of a gradient, of the moduli last combined.
    dealii::Tensor<2, dim> stress_of(unsigned int i, const dealii::Tensor<2, dim> &L) const;
    /// Of a pair within one material.
    dealii::Tensor<1, dim> hourglass_pair_force(unsigned int i, std::size_t p,
                                                const std::vector<dealii::Tensor<1, dim>> &u) const;

    /// The part of pair @p p in the force of the stresses.
    dealii::Tensor<1, dim>
    stress_force(const unsigned int i, const std::size_t p) const
    {
      auto force = .5 * (stress[i] + stress[pairs.j[p]]) * pairs.c[p];
      if (degraded && degraded->touches(i))
        force += degraded->pair_force(i, p);
      return pairs.slides(p) ? pairs.along_normal(p, force) : force;
    }
    /// Takes shear stresses at walls along which particles slide out of the forces.
    void remove_shear(std::vector<dealii::Tensor<1, dim>> &f) const;

    /// Of increment @p u: dilatation at walls times its elastic modulus into stress and mean_stress.
    void add_wall_responses(const std::vector<dealii::Tensor<1, dim>> &u) const;
    /// Takes the elastic shear of degraded rows, @p elastic times the modulus, out of what is combined.
    void combine_degraded(double elastic, double viscous) const;
    /// Puts the elastic shear stress of increment @p u into `stress`, of degraded rows, and friction where factors differ.
    void add_degraded_responses(const std::vector<dealii::Tensor<1, dim>> &u) const;
    void set_correction(unsigned int i);
    void set_hourglass_stiffness(unsigned int i);
    /// Shear modulus as combined, for what only preconditions.
    double
    G_of(const unsigned int i) const
    {
      return degraded && degraded->touches(i) ? G_now[i] + elastic_now * degraded->share(i) * G[i] : G_now[i];
    }

    static dealii::Tensor<2, dim>
    unit()
    {
      return dealii::Tensor<2, dim>(dealii::unit_symmetric_tensor<dim>());
    }

    /// Gradient @p L of particle @p i times B_i, with the trace of L where something degrades.
    dealii::Tensor<2, dim>
    corrected(const unsigned int i, const dealii::Tensor<2, dim> &L) const
    {
      if (correction.empty())
        return L;
      const auto product = L * correction[i];
      return degraded ? product + trace(L - product) / dim * unit() : product;
    }

    /// Sums over pairs in L_i of @p u and, with hourglass control, in H_i; not again if they are known.
    void sum_differences(const std::vector<dealii::Tensor<1, dim>> &u) const;
    template <bool hourglass>
    void sum_differences(const std::vector<dealii::Tensor<1, dim>> &u) const;
    /// L_i of these sums.
    dealii::Tensor<2, dim>
    gradient_of_sum(const unsigned int i) const
    {
      return corrected(i, sums[i].L / (2. * volume[i]));
    }

    /// Stresses and a_i H_i of @p u, with hourglass control or without; then their forces.
    template <bool hourglass>
    void set_responses(const std::vector<dealii::Tensor<1, dim>> &u, bool onto_stresses = false) const;
    /// Forces of pairs, for Pairs::add_forces(), of `stress` and with hourglass control of @p u.
    template <bool hourglass>
    auto
    rows_of_increment(const std::vector<dealii::Tensor<1, dim>> &u) const
    {
      return [j = pairs.j.data(), c = pairs.c.data(), r = pairs.r.data(), P = weights().data(), w = u.data(),
              s = stress.data(), h = aH.data(), a_of = a.data()](const unsigned int i) {
        return [=, w_i = w[i], s_i = s[i], h_i = hourglass ? h[i] : dealii::Tensor<2, dim>(),
                a_i = hourglass ? a_of[i] : 0.](const unsigned int p) {
          const unsigned int     k     = j[p];
          dealii::Tensor<1, dim> force = .5 * ((s_i + s[k]) * c[p]);
          if constexpr (hourglass)
            force += P[p] * ((a_i + a_of[k]) * (w[k] - w_i) - (h_i + h[k]) * r[p]);
          return force;
        };
      };
    }
    template <bool hourglass>
    void add_stiffness_force(std::vector<dealii::Tensor<1, dim>>       &f,
                             const std::vector<dealii::Tensor<1, dim>> &u) const;

    const Pairs<dim>                &pairs;
    const Neighbours<dim>           &neighbours;
    const std::vector<Constitution> &constitutions;
    const double                     stabilisation;
    const bool                       is_corrected;
    const Interfaces<dim> *const     interfaces;
    DegradedShear<dim> *const        degraded;
    DegradedFriction<dim> *const     degraded_friction;

    std::unique_ptr<WallPressure<dim>>  walls;           ///< where pressures are continued to them
    std::vector<double>                 volume;          ///< of rows, their share [m^dim]
    std::vector<double>                 G, K, mu;        ///< tangent moduli of rows [Pa], viscosity [Pa s]
    std::vector<double>                 hourglass_per_G; ///< a_i/G_i of rows
    std::vector<dealii::Tensor<2, dim>> inverse_moment;  ///< (sum_j P r (x) r)^-1 of rows, walls where they are seen
    std::vector<dealii::Tensor<2, dim>> correction; ///< B, ghosts included; empty where gradients are not corrected

    // As combined.
    mutable std::vector<double> G_now, K_now;                       ///< of rows
    mutable double              elastic_now = 1., viscous_now = 0.; ///< factors of elastic moduli and of friction
    mutable std::vector<double> K_of_state;                         ///< elastic part of K_now, where there are walls
    mutable std::vector<double> a; ///< ghosts included; empty without hourglass control

    // Of the last displacement increment asked for.
    mutable std::vector<dealii::Tensor<2, dim>> stress;      ///< sigma B^T, ghosts included [Pa]
    mutable std::vector<dealii::Tensor<2, dim>> gradient;    ///< of rows; where there are interfaces
    mutable std::vector<double>                 mean_stress; ///< elastic; ghosts included, where there are walls [Pa]
    mutable std::vector<double>                 wall_dilatation; ///< times volume; of rows
    struct Gradients
    {
      dealii::Tensor<2, dim> L, H;

      void
      operator+=(const Gradients &other)
      {
        L += other.L;
        H += other.H;
      }
    };
    mutable std::vector<Gradients> sums; ///< of points, right for rows
    /// Velocities that `sums` are of, those that a gradient was asked of last: friction mostly wants the same. Empty: of others.
    mutable std::vector<dealii::Tensor<1, dim>> summed;
    mutable std::vector<dealii::Tensor<2, dim>> aH; ///< a_i H_i, ghosts included; empty without hourglass control
  };
} // namespace Stroma::Sph
