#include <stroma/base/memory.h>
#include <stroma/base/text.h>
#include <stroma/materials/table.h>
#include <stroma/scene/scene.h>

#include <algorithm>

namespace Stroma
{
  namespace
  {
    /// Names of the subsections here; an example name when documenting.
    std::vector<std::string>
    names_or_example(const Parameters &p, const std::string &kind, const std::string &example)
    {
      auto names = p.names(kind);
      if (names.empty() && p.get_mode() == Parameters::Mode::document)
        names.push_back(example);
      return names;
    }

    template <int dim>
    void
    add_materials(Parameters &p, Scene<dim> &scene)
    {
      const auto section   = p.section("Materials", "one subsection a material, named as you like");
      scene.material_names = names_or_example(p, "material", "tissue");
      if (scene.material_names.empty())
        throw UserError(p.where_section(), "no material; add a subsection with a 'Law' to section Materials");
      if (scene.material_names.size() >= VoxelMaterials::empty)
        throw UserError(p.where_section(), "at most 254 materials");
      for (const auto &name : scene.material_names)
        {
          const auto subsection = p.section(name);
          if (name == "empty" || name == "all others")
            throw UserError(p.where_section(), "a material cannot be called '" + name +
                                                 "': that is a word of 'Materials' of images; rename it");
          scene.material_where.push_back(p.where_section());
          scene.materials.push_back(Materials::create(p, scene.plane));
          Materials::Medium medium;
          medium.is_fluid     = scene.materials.back()->name() == "fluid";
          medium.bulk_modulus = scene.materials.back()->p_wave_modulus();
          medium.add(p);
          scene.media.push_back(medium);
          if (medium.is_fluid != scene.media.front().is_fluid)
            throw UserError(p.where("Law"), "a scene holds either fluids or solids; '" + name + "' and '" +
                                              scene.material_names.front() + "' differ");
        }
    }

    /// A surface from a file, which names no unit, that is far from the size of all other bodies is in another one.
    template <int dim>
    void
    check_surface_units(const Scene<dim> &scene)
    {
      constexpr double too_large = 100., too_small = 1e-3;
      const auto       size = [](const auto &body) {
        const auto [lower, upper] = body.bounding_box().get_boundary_points();
        return lower.distance(upper);
      };
      double largest = 0.;
      for (const auto &body : scene.bodies)
        largest = std::max(largest, body.is_surface() ? 0. : size(body));
      for (const auto &body : scene.bodies)
        if (const double ratio = size(body) / largest;
            largest > 0. && body.is_surface() && (ratio >= too_large || ratio <= too_small))
          throw UserError(body.where, "the surface of body '" + body.name + "' is " + brief(size(body)) +
                                        " m large, the largest other body " + brief(largest) +
                                        " m; check its 'Length unit', that of the coordinates in its file");
    }

    template <int dim>
    void
    add_bodies(Parameters &p, Scene<dim> &scene)
    {
      const auto section = p.section("Bodies", "one subsection a body; where bodies overlap the later one wins");
      const auto names   = names_or_example(p, "body", "specimen");
      if (names.empty())
        throw UserError(p.where_section(), "no body; add a subsection with a 'Shape' to section Bodies");
      for (const auto &name : names)
        {
          const auto subsection = p.section(name);
          scene.bodies.emplace_back();
          scene.bodies.back().add(p, name, scene.material_names, scene.comm);
        }
      if (std::all_of(scene.bodies.begin(), scene.bodies.end(), [](const auto &body) { return body.rigid; }))
        throw UserError(p.where_section(), "every body is rigid; add one that is made of a material");
      scene.body_names = names;
      if (p.get_mode() == Parameters::Mode::read)
        check_surface_units(scene);
    }

    /// Supports or loads, a subsection each.
    template <typename Acting>
    void
    add_each(std::vector<Acting> &all, Parameters &p, const std::vector<std::string> &names, const SceneNames &known)
    {
      for (const auto &name : names)
        {
          const auto subsection = p.section(name);
          all.emplace_back();
          all.back().name = name;
          all.back().add(p, known);
        }
    }
  } // namespace

  template <int dim>
  Scene<dim>::Scene(Parameters &p, const MPI_Comm comm)
    : comm(comm)
  {
    p.add("Title", title, "what the scene is, for people");
    constexpr double GB           = 1e9;
    double           memory_limit = 0.;
    p.add("Memory limit", memory_limit,
          "memory [GB] that the run may be estimated to take; 0: what the machine has free", "", Range::non_negative());
    Memory::set_limit(GB * memory_limit);
    const bool thickness_is_given = p.given("Thickness");
    if (dim == 2)
      {
        p.add("Thickness", thickness, "thickness of the plane scene; forces are for this thickness", "m",
              Range::positive());
        p.add_choice<Materials::PlaneModel>("Plane", plane,
                                            "third direction: plane strain, or plane stress at the point",
                                            {{"strain", Materials::PlaneModel::strain},
                                             {"stress", Materials::PlaneModel::stress}});
      }
    p.all_declared();
    add_materials(p, *this);
    add_bodies(p, *this);
    const SceneNames known{material_names, body_names};
    {
      const auto section = p.section("Supports", "one subsection a support: prescribed displacements");
      add_each(supports, p, names_or_example(p, "support", "bottom"), known);
    }
    {
      const auto section = p.section("Loads", "one subsection a load: dead forces on material");
      add_each(loads, p, names_or_example(p, "load", "weight"), known);
    }
    add_periodic(p);
    add_contacts(p);
    add_processes(p, thickness_is_given);
    check_supports_and_loads();
    make_rigid_bodies();
    add_exact_solution(p);
  }

  /// What no method can give a meaning to.
  template <int dim>
  void
  Scene<dim>::check_supports_and_loads() const
  {
    using Kind       = typename Region<dim>::Kind;
    const auto check = [&](const auto &acting, const std::string &what, const bool depends_on_place) {
      const auto &region = acting.region;
      if (region.kind == Kind::side && periodic[region.axis])
        throw UserError(acting.where, what + " '" + acting.name + "' acts on " + region.text +
                                        ", where the scene repeats; " +
                                        "take that direction out of 'Periodic/Directions'");
      if (region.kind != Kind::body)
        return;
      const auto &body = bodies[region.body];
      if (!body.rigid)
        throw UserError(acting.where, "'body " + body.name + "' is not rigid; use 'material', 'box' or 'all'");
      if (depends_on_place)
        throw UserError(acting.where,
                        what + " '" + acting.name + "' on rigid body '" + body.name +
                          "' depends on place, but a rigid body moves as a whole; use t and constants only");
    };
    for (const auto &support : supports)
      check(support, "support",
            support.displacement.depends_on_place() || support.velocity.depends_on_place() ||
              support.rotation.depends_on_place() || support.angular_velocity.depends_on_place());
    for (const auto &load : loads)
      check(load, "load", load.total.depends_on_place() || load.torque.depends_on_place());
    for (unsigned int c = 0; c < contacts.size(); ++c)
      for (unsigned int other = 0; other < c; ++other)
        if (contacts[c].body == contacts[other].body)
          throw UserError(contacts[c].where, "contacts '" + contacts[other].name + "' and '" + contacts[c].name +
                                               "' are both of rigid body '" + bodies[contacts[c].body].name +
                                               "'; keep one of them");
  }

  template <int dim>
  void
  Scene<dim>::add_periodic(Parameters &p)
  {
    const auto               section = p.section("Periodic", "directions in which the scene repeats itself");
    std::vector<std::string> directions;
    p.add("Directions", directions, "of x, y, z; the bodies' bounding box is one period");
    where_periodic = p.where("Directions");
    for (const auto &direction : directions)
      {
        const auto axis = std::string("xyz").substr(0, dim).find(direction);
        if (direction.size() != 1 || axis == std::string::npos)
          throw UserError(p.where("Directions"), "'Directions' was given as '" + shown(join(directions, ", ")) +
                                                   "'; it must be of: " + (dim == 2 ? "x, y" : "x, y, z"));
        periodic[axis] = true;
        for (const auto &body : bodies)
          if (body.is_image() && (body.voxels.first[axis] > 0 || body.voxels.past[axis] < body.voxels.size[axis]))
            throw UserError(p.where("Directions"), "the image of body '" + body.name + "' ends in empty voxels along " +
                                                     direction + ", so its period there is not known; crop it ('Crop " +
                                                     "first', 'Crop size'), or leave the direction out");
      }
  }

  template <int dim>
  void
  Scene<dim>::add_contacts(Parameters &p)
  {
    const auto section = p.section("Contact", "one subsection a rigid body that touches the material");
    for (const auto &name : p.names("contact"))
      {
        const auto subsection = p.section(name);
        Contact    contact;
        contact.name  = name;
        contact.where = p.where_section();
        std::vector<std::pair<std::string, unsigned int>> rigid;
        for (unsigned int b = 0; b < bodies.size(); ++b)
          if (bodies[b].rigid)
            rigid.emplace_back(bodies[b].name, b);
        if (rigid.empty())
          throw UserError(contact.where, "contact needs a rigid body; give a body 'Rigid = true'");
        contact.body = rigid.front().second;
        p.add_choice<unsigned int>("Body", contact.body, "the rigid body", rigid);
        p.add_choice<Contact::Type>("Type", contact.type,
                                    "stick: no slip while in contact; frictionless; Coulomb: stick up to a friction",
                                    {{"stick", Contact::Type::stick},
                                     {"frictionless", Contact::Type::frictionless},
                                     {"Coulomb", Contact::Type::coulomb}});
        if (contact.type == Contact::Type::coulomb || p.get_mode() == Parameters::Mode::document)
          p.add("Friction coefficient", contact.friction,
                "largest force along the surface over that across it, Coulomb", "", Range::positive());
        contacts.push_back(contact);
      }
  }

  template <int dim>
  void
  Scene<dim>::add_exact_solution(Parameters &p)
  {
    const auto section  = p.section("Exact solution", "known solution, for error norms");
    const bool document = p.get_mode() == Parameters::Mode::document;
    exact_displacement.add(p, "Displacement", "displacement of the point that was at x, y, z", "m", false);
    if (p.given("Velocity") || document)
      exact_velocity.add(p, "Velocity", "velocity of the point that was at x, y, z", "m/s", false);
    if (p.given("Pressure") || document)
      exact_pressure.add(p, "Pressure", "mean compressive stress", "Pa", false);
    if (p.given("Von Mises stress") || document)
      exact_von_mises.add(p, "Von Mises stress", "von Mises stress", "Pa", false);
  }

  template <int dim>
  void
  Scene<dim>::require(const std::string &method, const Abilities &can) const
  {
    const auto refuse = [&](const std::string &where, const std::string &what, const std::string &advice) {
      throw UserError(where, what + " cannot be solved with 'Method = " + method + "'; " + advice);
    };
    for (unsigned int m = 0; m < materials.size(); ++m)
      {
        const std::string name = of_material(m);
        if (media[m].is_fluid && !can.fluids)
          refuse(name, "a fluid", "choose 'fem', 'nsph' or 'sph', or a law of solids");
        if (media[m].is_viscous() && !can.viscosity)
          refuse(name, "a viscosity", "remove it, or choose another method");
        if (materials[m]->n_history() > 0 && !can.history)
          refuse(name, "law '" + materials[m]->name() + "'", "choose 'mpm' or 'fem', or another law");
        const bool is_rate_form = materials[m]->is_rate_form();
        if (is_rate_form && !can.rate_laws)
          throw UserError(name, "the law 'hypoelastic' is integrated in time by nsph and sph, 'Method = " + method +
                                  "' does not; write 'Law = neo-Hookean' or 'Law = linear elastic'" +
                                  (method == "fem" ? ", or set 'FEM/Kinematics = small'" : ""));
        if (!is_rate_form && !media[m].is_fluid && !can.total_laws)
          throw UserError(name, "'Method = " + method + "' does not solve the law '" + materials[m]->name() +
                                  "' at finite strains; write 'Law = hypoelastic', with the same elastic constants");
      }
    require_drives(method, can);
    for (const auto &body : bodies)
      if (body.initial_velocity.given() && !can.inertia)
        throw UserError(body.where, "'Initial velocity' of body '" + body.name +
                                      "' has no meaning without inertia: 'Method = " + method + "' would ignore it" +
                                      (method == "fem" ? " ('FEM/Inertia = true' turns it on)" : "") + "; remove it");
    if (std::find(periodic.begin(), periodic.end(), true) != periodic.end() && !can.periodic)
      refuse(where_periodic, "a periodic scene", "choose 'fem', 'nsph' or 'sph', or remove 'Periodic/Directions'");
    if (!contacts.empty() && !can.contact)
      refuse(contacts.front().where, "contact", "remove it: the material then sticks to the body");
    for (const auto &contact : contacts)
      if (contact.type == Contact::Type::coulomb && !can.contact_friction)
        refuse(contact.where, "a contact with Coulomb's friction", "set 'Type = stick' or 'frictionless'");
    if (!migrations.empty() && !can.migration)
      refuse(migrations.front().where, "migration", "choose 'nsph' or 'sph'");
    if (!degradations.empty() && !can.degradation)
      refuse(degradations.front().where, "degradation", "choose 'nsph', or remove section Degradation");
    for (const auto &support : supports)
      {
        if (support.velocity.given() && !can.velocities)
          refuse(support.where, "a support with a velocity", "give its 'Displacement', a function of t");
        if (support.region.kind == Region<dim>::Kind::rim && !can.boundary_loads)
          refuse(support.where, "a support on a rim", "choose 'fem', or hold a 'layer', 'box' or 'ball'");
      }
    for (const auto &load : loads)
      if (load.region.is_boundary() && !can.boundary_loads)
        refuse(load.where, "a load on a side or rim",
               std::string("give it to the material there, ") +
                 (load.region.kind == Region<dim>::Kind::side ?
                    "'Where = layer " + load.region.text.substr(load.region.text.find(' ') + 1) + " THICKNESS'" :
                    "'Where = layer', 'box' or 'ball'") +
                 " with 'Total force', traction times area, or choose 'fem'");
  }

  template <int dim>
  std::vector<std::string>
  Scene<dim>::laws_in_words(const bool small) const
  {
    std::vector<std::string> words, laws;
    for (unsigned int m = 0; m < materials.size(); ++m)
      {
        const auto law = materials[m]->name() + ", " +
                         (small ? materials[m]->small_strain()->meaning() : materials[m]->meaning());
        const auto known = std::find(laws.begin(), laws.end(), law) - laws.begin();
        if (known < std::ptrdiff_t(laws.size()))
          words[known] += ", " + material_names[m];
        else
          {
            laws.push_back(law);
            words.push_back("law of " + material_names[m]);
          }
      }
    for (unsigned int l = 0; l < laws.size(); ++l)
      words[l] += ": " + laws[l];
    return words;
  }

  template <int dim>
  std::optional<unsigned int>
  Scene<dim>::material_at(const dealii::Point<dim> &X) const
  {
    for (auto body = bodies.rbegin(); body != bodies.rend(); ++body)
      if (body->contains(X))
        return body->material_at(X);
    return std::nullopt;
  }

  template <int dim>
  std::string
  Scene<dim>::of_material(const unsigned int m) const
  {
    return material_where[m] + ": material '" + material_names[m] + "'";
  }

  template <int dim>
  std::vector<std::string>
  Scene<dim>::unused_materials() const
  {
    std::vector<bool> used(materials.size(), false);
    for (const auto &body : bodies)
      if (!body.is_image() && !body.rigid)
        used[body.material] = true;
      else
        for (const auto material : body.voxels.material)
          if (material != VoxelMaterials::empty)
            used[material] = true;
    std::vector<std::string> names;
    for (unsigned int m = 0; m < used.size(); ++m)
      if (!used[m])
        names.push_back(material_names[m]);
    return names;
  }

  template <int dim>
  dealii::Tensor<1, dim>
  Scene<dim>::initial_velocity(const dealii::Point<dim> &X) const
  {
    for (auto body = bodies.rbegin(); body != bodies.rend(); ++body)
      if (!body->rigid && body->contains(X)) // what a rigid one touches does not move with it
        return body->initial_velocity.given() ? body->initial_velocity.value(X, 0.) : dealii::Tensor<1, dim>();
    return {};
  }

  template <int dim>
  dealii::BoundingBox<dim>
  Scene<dim>::bounding_box() const
  {
    std::optional<dealii::BoundingBox<dim>> box;
    for (const auto &body : bodies)
      if (!body.rigid && box)
        box->merge_with(body.bounding_box());
      else if (!body.rigid)
        box = body.bounding_box();
    return *box;
  }

  template <int dim>
  bool
  Scene<dim>::covered_by_later_body(const unsigned int b, const dealii::Point<dim> &X) const
  {
    for (unsigned int later = b + 1; later < bodies.size(); ++later)
      if (bodies[later].contains(X))
        return true;
    return false;
  }

  template class Scene<2>;
  template class Scene<3>;
} // namespace Stroma
