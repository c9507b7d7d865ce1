#pragma once

#include <stroma/mpm/active_cells.h>
#include <stroma/mpm/points.h>

#include <optional>

namespace Stroma::Mpm
{
  /// Springs that hold driven material points at their prescribed places: each of stiffness
  /// penalty M V / h^2, with M the modulus of longitudinal waves, V the point's volume and h the smallest side of a cell.
  /// Where a side is driven they hold not the outermost points but the places A of the side beside them, which move along;
  /// the halves of a single point hold its place A:
  ///   x = x_p + F_p^r (A - X_p),   of node a the weight S_a(x), by the functions of the point's cell also where x lies outside of it.
  template <int dim>
  class DrivenPoints : public Solvers::Term
  {
  public:
    DrivenPoints(const Scene<dim> &scene, const Settings<dim> &settings, const BackgroundGrid<dim> &grid,
                 const Points<dim> &points, ActiveCells<dim> &cells);

    /// Finds the driven points in the present cells.
    void rebuild();

    void
    add_pattern(Solvers::Pattern &, const Solvers::Constraints &) const override
    {} // that of the cells
    StepStatus add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage) override;
    StepStatus add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage,
                           const Solvers::Constraints &constraints) override;
    bool
    acts_in_cells_only() const override
    {
      return !points.support.stored();
    }
    double round_off() const override;

    /// Force by which each support holds the body, [support][component], from the last add_force() [N]. This rank's part.
    const std::vector<dealii::Tensor<1, dim>> &
    reactions() const
    {
      return reaction;
    }

    /// Largest distance of a point from its target at the last add_force() [m]. Collective.
    double largest_gap() const;

  private:
    /// The place that springs hold beside their points: its coordinate along one axis, or its coordinates.
    struct Held
    {
      std::array<bool, dim> along{};
      dealii::Point<dim>    place; ///< undeformed [m]
    };

    /// A point and one of the supports that drive it.
    struct Spring
    {
      unsigned int                      support;
      double                            stiffness; ///< [N/m]
      typename ActiveCells<dim>::Shapes shapes;    ///< at the place that is held
      dealii::Point<dim>                X;         ///< undeformed place [m]
      dealii::Tensor<1, dim>            before;    ///< displacement at the last rebase [m]
    };

    void                find_held_places();
    std::optional<Held> centre_of(unsigned int s) const;
    Spring              at(const Held &held, Spring spring, const ActiveCell<dim> &active,
                           const typename Points<dim>::Accessor &point) const;
    template <typename Act>
    void                   for_springs(const ActiveCell<dim> &active, const Act &act) const;
    dealii::Tensor<1, dim> gap(const Spring &spring, const ActiveCell<dim> &active, const Solvers::Motion &motion,
                               const Solvers::Stage &stage) const;

    const Scene<dim>                    &scene;
    const Points<dim>                   &points;
    ActiveCells<dim>                    &cells;
    dealii::Tensor<1, dim>               cell_size; ///< [m]
    double                               h;         ///< smallest side of a cell [m]
    double                               penalty;   ///< over modulus times volume over h^2
    std::vector<std::optional<Held>>     held;    ///< of the supports on sides, and on single points that may be halved
    std::vector<const ActiveCell<dim> *> holders; ///< cells with driven points
    std::vector<dealii::Tensor<1, dim>>  reaction;
    double                               largest = 0., squares = 0.;
  };
} // namespace Stroma::Mpm
