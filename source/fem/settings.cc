#include <stroma/fem/settings.h>
#include <stroma/scene/rheology.h>

#include <algorithm>

namespace Stroma::Fem
{
  template <int dim>
  void
  Settings<dim>::add(Parameters &p, const Scene<dim> &scene)
  {
    const bool documenting = p.get_mode() == Parameters::Mode::document;
    const bool solid       = !scene.is_fluid();
    cells.assign(dim, 1);
    p.add("Cells", cells,
          "cells along x, y" + std::string(dim == 3 ? ", z" : "") +
            " over the bodies' bounding box (before refinement); along radius and angle of a ring, along " +
            "the first and second edge of a quadrilateral, across a ball",
          Range::at_least(1), dim);
    where_cells = p.where("Cells");
    p.add("Degree", degree,
          solid ? "polynomial degree of the displacement" : "polynomial degree of the velocity; pressure one less",
          Range::closed(solid ? 1 : 2, 4));
    p.add("Quadrature points", quadrature_points, "Gauss points along each axis of a cell; 0: degree + 1",
          Range::closed(0, 10));
    p.add("Inertia", inertia, "motion with inertia; needs the materials' density");
    p.add_choice<MaterialPlace>("Material at", material_place,
                                "cell: the mesh must fit the bodies; quadrature point: it need not",
                                {{"cell", MaterialPlace::cell}, {"quadrature point", MaterialPlace::quadrature_point}});
    if (solid)
      {
        order = inertia ? Solvers::Order::second : is_viscous(scene) ? Solvers::Order::first : Solvers::Order::statics;
        scheme.add(p, order);
        p.add_choice<Kinematics>("Kinematics", kinematics, "finite deformation, or small strains (linear)",
                                 {{"finite", Kinematics::finite}, {"small", Kinematics::small}});
        p.add_choice<Dilatation>("Dilatation", dilatation,
                                 "change of volume at each point, or projected onto a lower degree (F-bar, no locking)",
                                 {{"full", Dilatation::full}, {"projected", Dilatation::projected}});
        if (scene.plane == Materials::PlaneModel::stress && dilatation == Dilatation::projected)
          throw UserError(p.where("Dilatation"), "plane stress does not lock; use 'Dilatation = full'");
        for (const auto &medium : scene.media)
          if (scene.plane == Materials::PlaneModel::stress && medium.is_viscous())
            throw UserError(p.where_section(), "viscosity needs 'Plane = strain'");
        p.add("Error cycles", error_cycles, "refinements by Kelly's error estimate before the run (of its first step)");
        if (error_cycles > 0 || documenting)
          p.add("Error fraction", error_fraction, "part of the cells refined in each cycle", "", Range::open(0., 1.));
        if (!scene.contacts.empty() || documenting)
          contact.add(p);
      }
    const auto section = p.section("Refinement", "one subsection a region whose cells are split");
    for (const auto &name : p.names("refinement"))
      {
        const auto         subsection = p.section(name);
        RefinedRegion<dim> region;
        region.where = p.where_section();
        region.region.add(p, {scene.material_names, scene.body_names});
        p.add("Levels", region.levels, "times that its cells are split; 0: not at all", Range::closed(0, 12));
        refined.push_back(region);
      }
  }

  template class Settings<2>;
  template class Settings<3>;
} // namespace Stroma::Fem
