#pragma once

#include <stroma/fem/mesh.h>
#include <stroma/scene/loads.h>

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/fe_values.h>

#include <memory>

namespace Stroma::Fem
{
  /// An unknown on which a load acts alone: of the nearest node or of a rigid body.
  template <int dim>
  struct SingleUnknown
  {
    dealii::types::global_dof_index dof;
    unsigned int                    component;
    dealii::Point<dim>              X; ///< of the node; centre of the rigid body [m]
  };

  /// Displacements or velocities on which loads act.
  template <int dim>
  struct LoadedSpace
  {
    const dealii::DoFHandler<dim>           &dofs;
    const dealii::FESystem<dim>             &fe;
    const dealii::AffineConstraints<double> &ties;
    const dealii::IndexSet                  &owned;
  };

  /// The scene's dead loads as forces on the unknowns. Where the edge of a load's region cuts a cell, its part is integrated:
  /// exactly for boxes and layers on a lattice, else by many points.
  template <int dim>
  class Loads
  {
  public:
    /// Measures the regions of loads. @param single of each load, the owned unknowns on which it acts alone, if it does; none
    /// if no load does. Throws UserError for a load that selects nothing. Collective.
    Loads(const Scene<dim> &scene, const Settings<dim> &settings, const Mesh<dim> &mesh, const LoadedSpace<dim> &space,
          const std::vector<std::vector<SingleUnknown<dim>>> &single = {});

    /// External forces at time @p t [N], in two dimensions for the scene's thickness. Collective.
    void assemble(double t, Vector &force);

  private:
    using Cell  = typename dealii::DoFHandler<dim>::active_cell_iterator;
    using Visit = std::function<void(const Cell &, const dealii::FEValuesBase<dim> &,
                                     const std::vector<unsigned int> &points, const std::vector<double> &sizes)>;

    /// Calls visit(cell, values, points of the load, size of each) for every owned cell or face with a part of the load.
    void                    for_each_part(const Load<dim> &load, const Visit &visit);
    void                    visit_faces(const Load<dim> &load, const Cell &cell, const Visit &visit);
    bool                    is_single(const Load<dim> &load) const;
    bool                    is_cut(const Load<dim> &load, const Cell &cell) const;
    dealii::Quadrature<dim> cut_quadrature(const Load<dim> &load, const Cell &cell) const;
    void                    assemble_load(unsigned int l, double t, Vector &force);

    const Scene<dim>                            &scene;
    const Settings<dim>                         &settings;
    const Mesh<dim>                             &mesh;
    LoadedSpace<dim>                             space;
    std::vector<std::vector<SingleUnknown<dim>>> single; ///< of each load
    dealii::BoundingBox<dim>                     bodies;
    dealii::FEValues<dim>                        whole; ///< of cells that nothing cuts
    dealii::FEFaceValues<dim>                    face;
    LoadDensities<dim>                           densities;
    double                                       assembled_time;
    Vector                                       assembled; ///< at assembled_time
    bool                                         steady = true;
  };
} // namespace Stroma::Fem
