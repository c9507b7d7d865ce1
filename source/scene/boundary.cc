#include <stroma/base/text.h>
#include <stroma/scene/boundary.h>

namespace Stroma
{
  namespace
  {
    enum class SupportType
    {
      displacement,
      velocity,
      clamp,
      symmetry
    };
  }

  template <int dim>
  void
  Support<dim>::add(Parameters &p, const SceneNames &names)
  {
    where = p.where_section();
    region.add(p, names);
    SupportType type = SupportType::displacement;
    p.add_choice<SupportType>(
      "Type", type,
      "clamp: all components held; symmetry: only the normal one of a side; displacement, velocity: as given",
      {{"displacement", SupportType::displacement},
       {"velocity", SupportType::velocity},
       {"clamp", SupportType::clamp},
       {"symmetry", SupportType::symmetry}});
    if (type == SupportType::displacement || type == SupportType::velocity)
      {
        const bool        is_velocity = type == SupportType::velocity;
        const std::string entry       = is_velocity ? "Velocity" : "Displacement";
        auto             &motion      = is_velocity ? velocity : displacement;
        motion.add(p, entry, is_velocity ? "velocity, of a fluid" : "displacement since the start",
                   is_velocity ? "m/s" : "m", true);
        if (!motion.given() && p.get_mode() == Parameters::Mode::read)
          throw UserError(p.where_section(), "'" + entry + "' is missing; give " + std::to_string(dim) +
                                               " components separated by ';', or 'Type = clamp' or 'symmetry'");
        bool all_free = motion.given();
        for (unsigned int c = 0; c < dim && all_free; ++c)
          all_free = motion.is_free(c);
        if (all_free)
          throw UserError(p.where(entry),
                          "all components are free, so that this support holds nothing; prescribe one, or remove "
                          "the support");
        return;
      }
    if (type == SupportType::symmetry && region.kind != Region<dim>::Kind::side)
      throw UserError(p.where("Type"), "'symmetry' needs a side, but 'Where' is '" + region.text + "'");
    std::vector<std::string> components(dim, type == SupportType::clamp ? "0" : "free");
    components[region.axis] = "0";
    displacement.set(join(components, ";"));
  }

  template <int dim>
  void
  Load<dim>::add(Parameters &p, const SceneNames &names)
  {
    where = p.where_section();
    region.add(p, names);
    const bool document = p.get_mode() == Parameters::Mode::document;
    density.add(p, "Force density", "force per undeformed volume", "N/m^3", false);
    if (p.given("Traction") || document)
      traction.add(p, "Traction", "force per undeformed area of a side or rim", "N/m^2", false);
    total.add(p, "Total force", "force spread over the undeformed volume or area", "N", false);
    if (document)
      return;
    if (density.given() + traction.given() + total.given() != 1)
      throw UserError(p.where_section(),
                      "a load needs either 'Force density', 'Traction' or 'Total force', one of them");
    if (density.given() && region.is_boundary())
      throw UserError(p.where("Force density"),
                      "a side or rim has no volume; give 'Traction' or 'Total force', or use " +
                        std::string("'layer', 'box', 'ball', 'material' or 'all'"));
    if (traction.given() && !region.is_boundary())
      throw UserError(p.where("Traction"), "a traction acts on a 'side' or a 'rim'");
    const bool is_single = region.kind == Region<dim>::Kind::nearest || region.kind == Region<dim>::Kind::body;
    if (is_single && !total.given())
      throw UserError(p.where("Force density"), "a load on the nearest point or on a rigid body needs 'Total force'");
  }

  template struct Support<2>;
  template struct Support<3>;
  template struct Load<2>;
  template struct Load<3>;
} // namespace Stroma
