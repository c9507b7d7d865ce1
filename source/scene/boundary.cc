#include <stroma/base/text.h>
#include <stroma/scene/boundary.h>

namespace Stroma
{
  namespace
  {
    enum class SupportType
    {
      displacement,
      clamp,
      symmetry
    };
  }

  template <int dim>
  void
  Support<dim>::add(Parameters &p, const std::vector<std::string> &materials)
  {
    where = p.where_section();
    region.add(p, materials);
    SupportType type = SupportType::displacement;
    p.add_choice<SupportType>("Type", type,
                              "clamp: all components held; symmetry: only the normal one of a side; displacement: as given",
                              {{"displacement", SupportType::displacement},
                               {"clamp", SupportType::clamp},
                               {"symmetry", SupportType::symmetry}});
    if (type == SupportType::displacement)
      {
        displacement.add(p, "Displacement", "displacement since the start", "m", true);
        if (!displacement.given() && p.get_mode() == Parameters::Mode::read)
          throw UserError(p.where_section(), "'Displacement' is missing; give " + std::to_string(dim) +
                                               " components separated by ';', or 'Type = clamp' or 'symmetry'");
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
  Load<dim>::add(Parameters &p, const std::vector<std::string> &materials)
  {
    where = p.where_section();
    region.add(p, materials);
    density.add(p, "Force density", "force per undeformed volume", "N/m^3", false);
    total.add(p, "Total force", "force spread over the undeformed volume", "N", false);
    if (p.get_mode() == Parameters::Mode::document)
      return;
    if (density.given() == total.given())
      throw UserError(p.where_section(), "a load needs either 'Force density' or 'Total force', one of them");
    if (region.kind == Region<dim>::Kind::side)
      throw UserError(p.where("Where"), "a load acts on material, not on a side; use 'layer', 'box', 'ball', " +
                                          std::string("'material', 'nearest' or 'all'"));
    if (region.kind == Region<dim>::Kind::nearest && density.given())
      throw UserError(p.where("Force density"), "a load on the nearest point needs 'Total force'");
  }

  template struct Support<2>;
  template struct Support<3>;
  template struct Load<2>;
  template struct Load<3>;
} // namespace Stroma
