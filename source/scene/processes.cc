// The scene's processes: rigid bodies that propel themselves, and that degrade what is around them.

#include <stroma/base/text.h>
#include <stroma/scene/scene.h>

#include <algorithm>

namespace Stroma
{
  template <int dim>
  void
  Scene<dim>::add_processes(Parameters &p, const bool thickness_is_given)
  {
    std::vector<std::pair<std::string, unsigned int>> rigid;
    for (unsigned int b = 0; b < bodies.size(); ++b)
      if (bodies[b].rigid)
        rigid.emplace_back(bodies[b].name, b);
    {
      const auto section = p.section("Migration", "one subsection a rigid body that propels itself");
      for (const auto &name : p.names("migration"))
        {
          const auto subsection = p.section(name);
          if (rigid.empty())
            throw UserError(p.where_section(), "migration needs a rigid body; give a body 'Rigid = true'");
          if (dim == 2 && !thickness_is_given)
            throw UserError(p.where_section(), "the force of migration '" + name +
                                                 "' acts on a plane scene, so that its 'Thickness' counts; set it");
          migrations.emplace_back();
          migrations.back().add(p, name, rigid);
          check_propelled_body(migrations.back());
        }
    }
    const auto section = p.section("Degradation", "one subsection a rigid body that degrades the solid in front of it");
    for (const auto &name : p.names("degradation"))
      {
        const auto subsection = p.section(name);
        degradations.emplace_back();
        degradations.back().add(p, name, migrations);
        for (unsigned int other = 0; other + 1 < degradations.size(); ++other)
          if (degradations[other].body == degradations.back().body)
            throw UserError(p.where_section(), "degradations '" + degradations[other].name + "' and '" + name +
                                                 "' are both of rigid body '" + bodies[degradations.back().body].name +
                                                 "'; keep one of them");
      }
    if (!degradations.empty() && is_fluid())
      throw UserError(degradations.front().where, "a fluid cannot be degraded; give the material a law of solids");
  }

  /// Throws UserError for what is not inside of the material, or propels itself twice.
  template <int dim>
  void
  Scene<dim>::check_propelled_body(const Processes::Migration<dim> &migration) const
  {
    for (const auto &other : migrations)
      if (&other != &migration && other.body == migration.body)
        throw UserError(migration.where, "migrations '" + other.name + "' and '" + migration.name +
                                           "' are both of rigid body '" + bodies[migration.body].name +
                                           "'; keep one of them");
    if (std::find(periodic.begin(), periodic.end(), true) != periodic.end())
      throw UserError(migration.where, "a body that propels itself, '" + bodies[migration.body].name +
                                         "', is not solved in scenes that repeat; leave out 'Periodic'");
    const auto box = bodies[migration.body].bounding_box(), matrix = bounding_box();
    for (unsigned int d = 0; d < dim; ++d)
      if (box.side_length(d) >= matrix.side_length(d))
        throw UserError(bodies[migration.body].where, "rigid body '" + bodies[migration.body].name +
                                                        "' propels itself, but is as wide as the " + "material along " +
                                                        "xyz"[d] + " (" + brief(box.side_length(d)) + " m of " +
                                                        brief(matrix.side_length(d)) + " m); make it smaller");
      else if (box.lower_bound(d) <= matrix.lower_bound(d) || box.upper_bound(d) >= matrix.upper_bound(d))
        throw UserError(bodies[migration.body].where,
                        "rigid body '" + bodies[migration.body].name +
                          "' propels itself, but does not lie inside of the material along " + "xyz"[d] +
                          "; move it there");
  }

  template void Scene<2>::add_processes(Parameters &, bool);
  template void Scene<3>::add_processes(Parameters &, bool);
  template void Scene<2>::check_propelled_body(const Processes::Migration<2> &) const;
  template void Scene<3>::check_propelled_body(const Processes::Migration<3> &) const;
} // namespace Stroma
