#pragma once

#include <stroma/scene/scene.h>

#include <deal.II/base/symmetric_tensor.h>

#include <vector>

namespace Stroma::Sph
{
  /// The constants of one material, as particles see it: Hooke's law in rate form, or the equation of state (7) of Heck 2017.
  struct Constitution
  {
    double G   = 0.; ///< shear modulus [Pa], 0 for a fluid
    double K   = 0.; ///< bulk modulus at the reference density [Pa]
    double xi  = 1.; ///< exponent of (7): 7 for fluids, 1 for solids
    double mu  = 0.; ///< viscosity [Pa s]
    double rho = 0.; ///< reference density [kg/m^3], 0 where it is not given

    /// (7) with the bulk modulus K of the scene: p = K/xi ((rho/rho_0)^xi - 1), 1/J = rho/rho_0 [Pa].
    double pressure(double J) const;
    /// -J dp/dJ [Pa].
    double bulk_tangent(double J) const;
    /// Modulus of longitudinal waves at the reference density [Pa].
    double
    p_wave_modulus() const
    {
      return K + 4. / 3. * G;
    }
  };

  /// One a material. The law's moduli at the undeformed state count: particles integrate Hooke's law in rate form.
  /// @param published take 'Bulk modulus' of a fluid as the factor of (7), so that the true one is xi times as large
  /// Throws UserError: an incompressible fluid, a viscosity that is missing (unless @p may_be_inviscid) or 'deviatoric', a law
  /// with history, plane stress, operators that differ between materials.
  template <int dim>
  std::vector<Constitution> constitutions_of(const Scene<dim> &scene, const std::string &method, bool published,
                                             bool may_be_inviscid);

  /// S + 2 G dt dev D, dev in three dimensions; @p L velocity gradient.
  template <int dim>
  dealii::SymmetricTensor<2, dim>
  deviatoric_rate(const double G, const dealii::Tensor<2, dim> &L)
  {
    dealii::SymmetricTensor<2, dim> rate = 2. * G * symmetrize(L);
    const double                    mean = 2. / 3. * G * trace(L);
    for (unsigned int d = 0; d < dim; ++d)
      rate[d][d] -= mean;
    return rate;
  }
} // namespace Stroma::Sph
