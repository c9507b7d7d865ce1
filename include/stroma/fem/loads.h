#pragma once

#include <stroma/fem/unknowns.h>

#include <deal.II/fe/fe_values.h>

namespace Stroma::Fem
{
  /// The scene's dead loads as forces on the unknowns. Cells that the edge of a load's region cuts are integrated finely.
  template <int dim>
  class Loads
  {
  public:
    /// Measures the regions of loads. Throws UserError for a load that selects nothing. Collective.
    Loads(const Scene<dim> &scene, const Settings<dim> &settings, const Mesh<dim> &mesh, const Unknowns<dim> &unknowns);

    /// External forces at time @p t [N], in two dimensions for the scene's thickness. Collective.
    void assemble(double t, Vector &force);

  private:
    using Cell = typename dealii::DoFHandler<dim>::active_cell_iterator;

    /// Calls visit(cell, values, points of the load, size of each) for every owned cell or face with a part of the load.
    template <typename Visit>
    void for_each_part(const Load<dim> &load, const Visit &visit);
    bool is_cut(const Load<dim> &load, const Cell &cell) const;
    void find_nearest(unsigned int l);
    void assemble_load(unsigned int l, double t, Vector &force);

    const Scene<dim>                     &scene;
    const Unknowns<dim>                  &unknowns;
    dealii::BoundingBox<dim>              bodies;
    dealii::FEValues<dim>                 coarse, fine;
    dealii::FEFaceValues<dim>             face;
    std::vector<double>                   sizes;   ///< volume or area of each load's region [m^3, m^2]
    std::vector<std::vector<std::pair<dealii::types::global_dof_index, unsigned int>>> single; ///< unknown, component
    double                                assembled_time;
    Vector                                assembled; ///< at assembled_time
    bool                                  steady = true;
  };
} // namespace Stroma::Fem
