#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

#include <array>
#include <cstdint>
#include <vector>

namespace Stroma::Particles
{
  /**
   * The particles of this rank, field by field in contiguous arrays: first the free ones it owns, then the fixed ones it
   * owns (layers beyond held sides, fillings of rigid bodies), then ghosts: copies of other ranks' particles and periodic
   * images. Within each part they are, or were not long ago, sorted by cell, and within a cell by id.
   *
   * A field that the scene does not need is empty.
   */
  template <int dim>
  struct ParticleSet
  {
    unsigned int n_free  = 0; ///< owned, moved by the equations of motion: indices [0, n_free)
    unsigned int n_owned = 0; ///< with the fixed ones: [0, n_owned); ghosts are [n_owned, size())

    std::vector<std::uint64_t>                   id;
    std::vector<dealii::Point<dim>>              x;  ///< place [m]
    std::vector<dealii::Point<dim>>              X;  ///< place at the start [m]
    std::vector<dealii::Tensor<1, dim>>          v;  ///< velocity [m/s]
    std::vector<double>                          V0; ///< undeformed volume [m^3]; in 2D area [m^2], of thickness 1
    std::vector<double>                          J;  ///< density ratio rho_0 / rho = V / V0
    std::vector<std::uint8_t>                    material; ///< index; stored if the scene has several
    std::vector<std::uint16_t>                   mover; ///< no_mover for free ones; else index into the scene's movers
    std::vector<dealii::SymmetricTensor<2, dim>> S;     ///< deviatoric stress [Pa]; in 2D S_zz = -(S_xx + S_yy); solids

    std::vector<double> intact; ///< degradation factor f: 1 solid, 0 fluid; where something degrades
    std::vector<std::uint8_t>
                        open; ///< whether it lay at a free surface at the start (AreaVectors); where something degrades
    std::vector<double> excess; ///< s - 1 of Packing at the start; fluids
    std::vector<std::array<dealii::Tensor<1, dim + 1>, dim>>
      closure; ///< unknowns of AreaVectors; where areas are closed

    std::vector<std::uint64_t>       contact; ///< state bits, see Sph::ContactState; of fixed ones all; with a contact
    std::vector<std::vector<double>> contact_gaps; ///< h_0 of Sph::Contacts, for each contact [m]

    // Of when neighbours were searched and pairs found last: both serve until particles have moved too far from there.
    std::vector<dealii::Point<dim>> x_search; ///< place at the search; ghosts of it are those of that place [m]
    std::vector<dealii::Point<dim>> x_pairs;  ///< place of the pairs [m]; empty: they have to be found anew
    std::vector<double>             J_pairs;  ///< density ratio of the pairs

    static constexpr std::uint16_t no_mover = 65535;

    unsigned int
    size() const
    {
      return static_cast<unsigned int>(id.size());
    } ///< with ghosts
    bool
    is_fixed(const unsigned int i) const
    {
      return mover[i] != no_mover;
    }
    double
    volume(const unsigned int i) const
    {
      return V0[i] * J[i];
    }
    unsigned int
    material_of(const unsigned int i) const
    {
      return material.empty() ? 0 : material[i];
    }

    /// Calls visit(name, vector) for each field that a particle carries, in a fixed order.
    template <typename Visit>
    void
    visit_fields(const Visit &visit)
    {
      visit("id", id);
      visit("place", x);
      visit("initial place", X);
      visit("velocity", v);
      visit("initial volume", V0);
      visit("volume ratio", J);
      visit("material", material);
      visit("mover", mover);
      visit("deviatoric stress", S);
      visit("degradation factor", intact);
      visit("free surface", open);
      visit("excess", excess);
      visit("closure", closure);
      visit("contact", contact);
      for (unsigned int c = 0; c < contact_gaps.size(); ++c)
        visit(c == 0 ? "contact gap" : ("contact gap " + std::to_string(c + 1)).c_str(), contact_gaps[c]);
      visit("place of search", x_search);
      visit("place of pairs", x_pairs);
      visit("volume ratio of pairs", J_pairs);
    }
  };
} // namespace Stroma::Particles
