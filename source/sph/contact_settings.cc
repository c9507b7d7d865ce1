#include <stroma/sph/contact_settings.h>

namespace Stroma::Sph
{
  void
  ContactSettings::add(Parameters &p, const bool published)
  {
    const auto section  = p.section("Contact", "of particles with the rigid bodies of the scene's section 'Contact'");
    const bool document = p.get_mode() == Parameters::Mode::document;
    if (published)
      criterion = ContactCriterion::heck;
    p.add_choice<ContactCriterion>(
      "Criterion", criterion,
      "surface: a particle touches a body where the material's surface meets the body's; heck: where particles are "
      "close (section 2.5.5 of Heck et al. 2017), the default of 'Formulation = published'; none: wherever the kernel "
      "reaches the body, so that material is pressed before it is touched",
      {{"surface", ContactCriterion::surface}, {"heck", ContactCriterion::heck}, {"none", ContactCriterion::none}});
    if (criterion == ContactCriterion::surface || document)
      p.add("Tension cut-off", tension_cut_off,
            "whether particles come off where the body would pull; if not, they stick for good");
    if (criterion != ContactCriterion::heck && !document)
      return;
    const std::string what = ", over the spacing; to the first layer of particles that stands for a body, half a "
                             "spacing within its surface, or on it with 'Walls = facets'";
    p.add("Distance", distance, "of a primary particle, within which it touches" + what, "", Range::closed(.5, 2.));
    p.add("Release distance", release, "of a primary particle, beyond which it touches no more" + what, "",
          Range::closed(.5, 3.));
    p.add("Support threshold", support_threshold,
          "kernel's sum over the material (33) from which on a particle is not at the surface, and touches with a "
          "primary one in its support",
          "", Range::closed(0., 1.5));
    p.add("Repulsion distance", repulsion,
          "below which a particle is pushed away besides, by its P-wave modulus times what is missing of the distance, "
          "times area over spacing; the paper has .7; 0: never" +
            what,
          "", Range::closed(0., 1.));
    p.all_declared();
    if (release < distance)
      throw UserError(p.where("Release distance"), "'Release distance' must not be below 'Distance'");
  }
} // namespace Stroma::Sph
