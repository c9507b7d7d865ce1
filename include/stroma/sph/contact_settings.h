#pragma once

#include <stroma/base/parameters.h>

namespace Stroma::Sph
{
  /// What tells whether a particle touches a rigid body that has a contact.
  enum class ContactCriterion
  {
    surface, ///< the material's surface meets the body's, see Contacts
    heck,    ///< distances of particles, 2.5.5 of Heck 2017
    none     ///< every particle within the kernel's support does
  };

  /// Contact of the particles with rigid bodies. Distances are over the spacing, from a particle to the first layer of particles
  /// that the body stands for, half a spacing within its surface.
  struct ContactSettings
  {
    ContactCriterion criterion         = ContactCriterion::surface;
    bool             tension_cut_off   = true;
    double           distance          = 1.;  ///< of primary particles, heck
    double           release           = 1.1; ///< at which they leave, heck
    double           support_threshold = .8;  ///< of (33) from which on a particle is not at the surface, heck
    double           repulsion         = 0.;  ///< below which a particle is pushed off besides, heck; 0: never

    /// Declares and reads the section Contact of a method.
    void add(Parameters &p, bool published);
  };
} // namespace Stroma::Sph
