#pragma once

#include <stroma/scene/scene.h>

#include <Eigen/Core>

#include <map>

namespace Stroma
{
  /**
   * What holds the rigid motions of pieces of material: supports, joints at corners and edges between pieces, rigid
   * inclusions. A piece moves as u(X) = t + w x (X - centre); each held or joined component is an equation for t and w of
   * one piece or two.
   */
  template <int dim>
  class RigidMotions
  {
  public:
    static constexpr unsigned int n_modes = dim == 2 ? 3 : 6;
    using Modes                           = Eigen::Matrix<double, n_modes, 1>; ///< t, then w times the scene's size

    /// @param n_pieces numbered the same on all ranks
    RigidMotions(const Scene<dim> &scene, unsigned int n_pieces);

    /// Component @p c of the material of a piece at @p X is held.
    void hold(unsigned int piece, const dealii::Point<dim> &X, unsigned int c);
    /// The piece cannot turn about an axis across a period of the scene.
    void hold_turns_across_periods(unsigned int piece);
    /// The piece cannot turn at all.
    void hold_turns(unsigned int piece);
    /// Component @p c at @p X is the same for both pieces.
    void join(unsigned int first, unsigned int second, const dealii::Point<dim> &X, unsigned int c);

    /// Brings what all ranks know together. Collective; call it before the rest.
    void gather();

    /// Throws UserError if all material, were it one piece, would be free to move.
    void check_whole() const;

    /// Pieces that hang together and have motions that nothing holds.
    struct FreeGroup
    {
      std::vector<unsigned int> pieces;
      bool                      is_held = false; ///< somewhere, but not enough
      /// Free motions, one a column: n_modes numbers of each of the pieces, in their order.
      Eigen::MatrixXd motions;
    };
    /// The same on all ranks.
    std::vector<FreeGroup> free_groups() const;

    /// What a motion does to component @p c at @p X.
    Modes row(const dealii::Point<dim> &X, unsigned int c) const;

  private:
    /// Equations as an orthonormal basis of their coefficients, so that many equal ones do not hide a single other.
    class Equations
    {
    public:
      /// Takes one more; whether it says anything new.
      bool add(Modes row);
      bool
      is_complete() const
      {
        return basis.size() == n_modes;
      }

      std::vector<Modes> basis;
    };
    using Pair = std::pair<unsigned int, unsigned int>; ///< two pieces, or the ground and a piece
    static constexpr unsigned int ground = 0;

    std::vector<unsigned int> rigid_clusters(std::map<Pair, Equations> &between) const;
    FreeGroup free_group(const std::vector<unsigned int> &clusters, const std::map<Pair, Equations> &between,
                         const std::vector<std::vector<unsigned int>> &members) const;

    const Scene<dim>         &scene;
    unsigned int              n_pieces;
    dealii::Point<dim>        centre;
    double                    length = 0; ///< [m]
    std::map<Pair, Equations> equations;  ///< first < second; piece i has number i + 1, the ground number 0
  };
} // namespace Stroma
