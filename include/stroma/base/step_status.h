#pragma once

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace Stroma
{
  /**
   * How a physical step went. Only step control reacts to it, by cutting the step. Ordered by severity so that the
   * largest value over points, blocks and ranks is the one that counts.
   */
  enum class StepStatus
  {
    ok             = 0,
    diverged       = 1,  ///< Newton did not converge in the allowed iterations
    linear_failed  = 2,  ///< the linear solver did not reach its tolerance
    inverted_point = 3,  ///< det F <= 0 at a point
    moved_too_far  = 4,  ///< a particle would move, or be deformed, too far in one step
    crushed        = 5,  ///< a particle would be pressed to a small part of its volume
    not_finite     = 6,  ///< a NaN or infinity turned up
    left_grid      = 7,  ///< a point would leave the background grid
    not_closed     = 8,  ///< particles are so disordered that their area vectors do not close
    detached       = 9,  ///< material without inertia came loose from all that holds it
    support_lost   = 10, ///< after a reset of the grid a support holds nothing
    torn           = 11, ///< after a reset of the grid the body hangs together in more parts than at the start
    drifted_apart  = 12, ///< places of particles no longer fit their volumes
    not_borne      = 13, ///< a rigid body that loads drive touches nothing that bears them
    came_apart     = 14, ///< rows of particles of a solid gathered in pairs
    misfit         = 15  ///< after resets of the grid gradients and places of material points no longer fit each other
  };

  /// Whether a shorter step may succeed where this happened.
  inline bool
  may_be_cut(const StepStatus status)
  {
    return status < StepStatus::left_grid || status == StepStatus::not_closed;
  }

  /// The status in words, for messages.
  inline const char *
  to_string(const StepStatus status)
  {
    switch (status)
      {
        case StepStatus::ok:
          return "ok";
        case StepStatus::diverged:
          return "Newton did not converge";
        case StepStatus::linear_failed:
          return "the linear solver did not converge";
        case StepStatus::not_closed:
          return "particles are so disordered that no balance of uniform stresses could be found (area vectors did not close)";
        case StepStatus::detached:
          return "particles came loose from all that holds the material, and without inertia nothing tells how they move";
        case StepStatus::inverted_point:
          return "a point was turned inside out (det F <= 0)";
        case StepStatus::moved_too_far:
          return "a particle would move by more than a fifth of the spacing, or be strained by more than a fifth, in one step";
        case StepStatus::crushed:
          return "a particle would be pressed to less than a tenth of its volume";
        case StepStatus::not_finite:
          return "a value was not finite";
        case StepStatus::left_grid:
          return "a point would leave the background grid; enlarge it ('MPM/Margin above', 'Margin below')";
        case StepStatus::support_lost:
          return "the material moved away from a side of the grid, whose support holds no node any more; use "
                 "'MPM/Grid reset = never', or a 'layer' in its 'Where'";
        case StepStatus::torn:
          return "the body was torn between its material points: the grid has empty cells between its parts; use more "
                 "'MPM/Points per cell' (or 'Points per voxel'), or 'MPM/Grid reset = never'";
        case StepStatus::drifted_apart:
          return "the particles' places and volumes have drifted apart: in the mean they stand closer than their volumes allow, and "
                 "volume would be lost without a word; take a smaller 'Spacing', or end the run earlier";
        case StepStatus::came_apart:
          return "a solid is stretched by more than its particles can follow (1.6 to 2 times): rows of them have gathered in pairs, with gaps "
                 "between; use 'Method = mpm' or 'fem', or end the run earlier";
        case StepStatus::misfit:
          return "after resets of the grid the deformation gradients of the material points no longer fit their places, and forces would be "
                 "wrong; use 'MPM/Grid reset = when distorted' or 'never', larger steps, or more 'MPM/Points per cell'";
        case StepStatus::not_borne:
          return "a rigid body that loads drive touches nothing that bears them";
      }
    return "unknown";
  }

  inline StepStatus
  worse(const StepStatus a, const StepStatus b)
  {
    return std::max(a, b);
  }

  /// The worst status of all ranks; collective.
  inline StepStatus
  reduce(const StepStatus status, const MPI_Comm comm)
  {
    return static_cast<StepStatus>(dealii::Utilities::MPI::max(static_cast<int>(status), comm));
  }
} // namespace Stroma
