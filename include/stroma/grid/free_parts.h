#pragma once

#include <stroma/grid/connected_parts.h>
#include <stroma/grid/rigid_motions.h>

#include <functional>

namespace Stroma
{
  /**
   * Which parts of the discretised bodies nothing holds: islands of voxels, a second body without support, what hangs on a
   * corner or an edge. Where no load acts on them they do no harm (they stay where they are) and are only said; under a
   * load they have no equilibrium and are refused.
   */
  template <int dim>
  class FreeParts
  {
  public:
    /// @param n_inclusions rigid inclusions, numbered as pieces after those of @p parts
    FreeParts(const Scene<dim> &scene, const ConnectedParts<dim> &parts, unsigned int n_inclusions = 0);

    /// An owned cell with material. Local, as all that RigidMotions takes.
    void add_cell(const typename ConnectedParts<dim>::Cell &cell, unsigned int material);

    /// To be told of all that holds, before find().
    RigidMotions<dim> motions;

    /// Throws UserError if all material, were it one piece, would be free to move. Collective.
    void find();

    /// Throws UserError if loads drive a free motion. @p forces_at calls its second argument for (piece, place, force) of
    /// this rank at a time [s]; it is asked only where something is free. Collective.
    using AddForce =
      std::function<void(unsigned int piece, const dealii::Point<dim> &X, const dealii::Tensor<1, dim> &force)>;
    void check_loads(double end_time, const std::function<void(double t, const AddForce &)> &forces_at) const;

    /// A warning of the parts that are free, how many and how large; empty if there are none.
    std::string words() const;
    unsigned int
    count() const
    {
      return groups.size();
    }

  private:
    struct Piece
    {
      double             volume = 0; ///< [m^3], of its cells
      dealii::Point<dim> lower, upper;
      double             first_material, last_material;
    };
    using Group = typename RigidMotions<dim>::FreeGroup;
    using Modes = typename RigidMotions<dim>::Modes;

    bool        is_driven(const Group &group, const std::vector<Modes> &forces, const std::vector<double> &sizes) const;
    void        refuse(const std::vector<const Group *> &driven) const;
    double      volume_of(const Group &group) const;
    std::string describe(const std::vector<const Group *> &some) const;

    const Scene<dim>          &scene;
    const ConnectedParts<dim> &parts;
    std::vector<Piece>         pieces;
    std::vector<Group>         groups;
    double                     total_volume = 0;
  };
} // namespace Stroma
