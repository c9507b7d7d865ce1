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
        add_motion(p, type == SupportType::velocity);
        add_rotation(p, type == SupportType::velocity);
        return;
      }
    p.all_declared();
    if (type == SupportType::symmetry && region.kind != Region<dim>::Kind::side)
      throw UserError(p.where("Type"), "'symmetry' needs a side, but 'Where' is '" + region.text + "'");
    std::vector<std::string> components(dim, type == SupportType::clamp ? "0" : "free");
    components[region.axis] = "0";
    displacement.set(join(components, ";"));
    holds_rotation = true;
  }

  template <int dim>
  void
  Support<dim>::add_motion(Parameters &p, const bool of_velocity)
  {
    const std::string entry  = of_velocity ? "Velocity" : "Displacement";
    auto             &motion = of_velocity ? velocity : displacement;
    motion.add(p, entry, of_velocity ? "velocity, of a fluid" : "displacement since the start",
               of_velocity ? "m/s" : "m", true);
    if (!motion.given() && p.get_mode() == Parameters::Mode::read)
      throw UserError(p.where_section(), "'" + entry + "' is missing; give " + std::to_string(dim) +
                                           " components separated by ';', or 'Type = clamp' or 'symmetry'");
    bool all_free = motion.given();
    for (unsigned int c = 0; c < dim && all_free; ++c)
      all_free = motion.is_free(c);
    const bool turns = p.given(of_velocity ? "Angular velocity" : "Rotation");
    if (all_free && !turns && p.get_mode() == Parameters::Mode::read)
      throw UserError(p.where(entry),
                      region.kind == Region<dim>::Kind::body ?
                        "all components are free; give its 'Rotation' too ('free', or 0: it does not turn)" :
                        "all components are free, so that this support holds nothing; prescribe one, or "
                        "remove the support");
  }

  template <int dim>
  void
  Support<dim>::add_rotation(Parameters &p, const bool of_velocity)
  {
    const std::string entry = of_velocity ? "Angular velocity" : "Rotation";
    if (!p.given(entry) && p.get_mode() == Parameters::Mode::read)
      return;
    if (of_velocity)
      angular_velocity.add(p, entry, "angular velocity of a rigid body, in rad/s", "1/s", true);
    else
      rotation.add(p, entry, "rotation of a rigid body about its pivot since the start, in radians", "1", true);
    holds_rotation = true;
    if (region.kind != Region<dim>::Kind::body && p.get_mode() == Parameters::Mode::read)
      throw UserError(p.where(entry), "'" + entry + "' turns a rigid body, but 'Where' is '" + region.text +
                                        "'; write 'Where = body NAME', or a 'Displacement' that depends on place");
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
      traction.add(p, "Traction",
                   "force per undeformed area of a side or rim, in the file's units of force and length, not of stress",
                   "N/m^2", false);
    total.add(p, "Total force", "force spread over the undeformed volume or area, or at the pivot of a rigid body", "N",
              false);
    if (p.given("Torque") || document)
      torque.add(p, "Torque", "torque on a rigid body", "N*m", false);
    if (!document)
      check(p);
  }

  template <int dim>
  void
  Load<dim>::check(const Parameters &p) const
  {
    const bool is_on_body = region.kind == Region<dim>::Kind::body;
    if (torque.given() && !is_on_body)
      throw UserError(p.where("Torque"),
                      "'Torque' turns a rigid body, but 'Where' is '" + region.text + "'; write 'Where = body NAME'");
    if (density.given() + traction.given() + total.given() != 1 &&
        !(torque.given() && !density.given() && !traction.given()))
      throw UserError(p.where_section(),
                      "a load needs either 'Force density', 'Traction' or 'Total force', one of them");
    if (density.given() && region.is_boundary())
      throw UserError(p.where("Force density"),
                      "a side or rim has no volume; give 'Traction' or 'Total force', or use " +
                        std::string("'layer', 'box', 'ball', 'material' or 'all'"));
    if (traction.given() && !region.is_boundary())
      throw UserError(p.where("Traction"), "a traction acts on a 'side' or a 'rim'");
    if ((region.kind == Region<dim>::Kind::nearest || is_on_body) && density.given())
      throw UserError(p.where("Force density"), "a load on the nearest point or on a rigid body needs 'Total force'");
  }

  template struct Support<2>;
  template struct Support<3>;
  template struct Load<2>;
  template struct Load<3>;
} // namespace Stroma
