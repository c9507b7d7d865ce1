#pragma once

#include <stroma/particles/neighbours_cells.h>
#include <stroma/particles/neighbours_exchange.h>
#include <stroma/particles/particle_set.h>

namespace Stroma::Particles
{
  /**
   * Who is near whom, on any number of ranks. Space is divided into equal cells not narrower than the reach (support
   * and skin); each rank owns a run of cells along a space-filling order, such that all have about as many particles.
   * Ghosts are the particles of other ranks in the cells around a rank's own ones, and the images across periodic
   * faces.
   *
   * Pairs within the reach are kept in compressed rows, one for each free particle (and, if asked, each fixed one), and
   * stay valid until some particle has moved by half the skin. The order of a row depends on the ids alone, never on
   * the ranks, so that sums over a row are the same to the last digit on any number of them.
   *
   * Cells are found by arithmetic and their owners in a table of one number a cell: deal.II's ParticleHandler would
   * need a mesh of as many cells, loses particles on vertices and makes no ghosts across periodic faces.
   */
  template <int dim>
  class Neighbours
  {
  public:
    struct Settings
    {
      double                   support = 0.; ///< of the kernel [m]
      double                   skin    = 0.; ///< [m]
      std::array<bool, dim>    periodic{};
      dealii::BoundingBox<dim> domain;                ///< its extent along a periodic direction is the period [m]
      bool                     rows_of_fixed = false; ///< whether fixed particles have a row as well
      std::string              where_periodic{};      ///< of the periods in the file
    };

    /// Throws UserError if a period is shorter than twice the reach (a particle would meet an image of a neighbour
    /// twice).
    Neighbours(const Settings &settings, MPI_Comm comm);

    /// Folds places into the periods, sends the owned particles to the ranks that own their cells, makes ghosts and pairs.
    /// Ghosts that were there before are dropped. @p particles.x of owned ones counts. Particles may be anywhere: the
    /// cells are laid around them. They are sorted where @p in_order asks for it, where some have changed their rank, and
    /// now and then; otherwise they and their equations stay in the order that they have. Collective.
    void rebuild(ParticleSet<dim> &particles, bool in_order = false);

    /// What rebuild() left, for the @p particles of a checkpoint, of which any may be on any rank: with places of the search
    /// that left it. On the same ranks and in the same order as then all stays; @p n_in_order is that of then. Collective.
    void restore(ParticleSet<dim> &particles, unsigned int n_in_order);

    unsigned int
    n_in_order() const
    {
      return n_rebuilds_in_order;
    } ///< rebuilds without a new order, since the last one

    /// Whether a particle has moved by more than half the skin since rebuild(). Collective.
    bool outdated(const ParticleSet<dim> &particles) const;

    /// Gives the ghosts the values of the particles that they are copies of. The field has an entry for each particle,
    /// or none at all: then it is left alone. Collective; free of cost where there are no ghosts.
    template <typename T>
    void
    update_ghosts(std::vector<T> &field) const
    {
      ghosts.copy(field);
    }

    /// The same for places: images are shifted by their periods. Collective.
    void update_ghost_places(std::vector<dealii::Point<dim>> &x) const;

    /// The image of @p x across the periodic faces that is nearest to @p near: rebuild() folds places, so who computes
    /// a place from that at the start must look for the image near the particle's last place.
    dealii::Point<dim> image_near(dealii::Point<dim> x, const dealii::Point<dim> &near) const;

    /// Whether the scene repeats along axis @p d, and its extent.
    bool
    is_periodic(const unsigned int d) const
    {
      return settings.periodic[d];
    }
    const dealii::BoundingBox<dim> &
    domain() const
    {
      return settings.domain;
    }

    unsigned int
    n_free() const
    {
      return n_free_particles;
    } ///< of this rank, since rebuild()
    MPI_Comm
    communicator() const
    {
      return comm;
    }

    unsigned int
    n_rows() const
    {
      return static_cast<unsigned int>(row_start.size()) - 1;
    }
    /// Indices of the neighbours of the particle of row i: neighbour[row_start[i]] up to neighbour[row_start[i + 1]].
    /// Free particles come first in each row, then fixed ones; each part by ascending id (and image).
    std::vector<unsigned int> row_start = {0}, neighbour;

    /// Global index of each free particle, consecutive on a rank: what equations are numbered by; ghosts included.
    /// Fixed ones have no_equation.
    std::vector<std::uint64_t> equation;
    std::uint64_t              first_equation = 0, n_equations = 0; ///< of this rank; of all

    static constexpr std::uint64_t no_equation = static_cast<std::uint64_t>(-1);

    unsigned int n_rebuilds = 0;
    unsigned int n_orders   = 0; ///< times that particles and equations were put into a new order

  private:
    double
    reach() const
    {
      return settings.support + settings.skin;
    }
    bool any_periodic() const;

    void search(ParticleSet<dim> &particles, bool in_order);
    void find_used_fields(ParticleSet<dim> &particles);
    bool migrate(ParticleSet<dim> &particles);
    void sort(ParticleSet<dim> &particles);
    void make_ghosts(ParticleSet<dim> &particles);
    void number_equations(const ParticleSet<dim> &particles);
    void make_pairs(const ParticleSet<dim> &particles);

    /// Calls visit(field) for each field that some rank has.
    template <typename Visit>
    void
    visit_used(ParticleSet<dim> &particles, const Visit &visit) const
    {
      unsigned int f = 0;
      particles.visit_fields([&](const char *, auto &field) {
        if (used_fields[f++])
          visit(field);
      });
    }

    Settings                  settings;
    MPI_Comm                  comm;
    unsigned int              rank, n_ranks;
    Cells<dim>                cells;
    std::vector<unsigned int> used_fields; ///< 1 or 0 for each field of ParticleSet

    unsigned int              n_free_particles = 0;
    std::vector<unsigned int> kept;                    ///< indices of what this rank owns after migrate(), in any order
    unsigned int              n_rebuilds_in_order = 0; ///< without a new order, since the last

    Exchange                            ghosts;
    std::vector<dealii::Tensor<1, dim>> shifts; ///< of each image code [m]: base 3, x first, 0: down, 1: none, 2: up
    std::vector<std::uint8_t>           image;  ///< code of each ghost; empty if nothing is periodic
  };
} // namespace Stroma::Particles
