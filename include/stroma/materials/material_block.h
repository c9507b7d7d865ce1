#pragma once

#include <stroma/materials/material.h>

#include <vector>

namespace Stroma::Materials
{
  /// What a block can be asked for besides the stress; combined by |.
  enum Wanted : unsigned int
  {
    stress_only = 0,
    energy      = 1, ///< psi
    tangent     = 2, ///< Jc
    stretch     = 4, ///< F33
    next_step   = 8  ///< history at the end of the step
  };

  /// What a MaterialBlock takes.
  inline std::vector<const Material *>
  pointers_to(const std::vector<std::unique_ptr<Material>> &owned)
  {
    std::vector<const Material *> laws;
    for (const auto &law : owned)
      laws.push_back(law.get());
    return laws;
  }

  /**
   * Points of a cell side by side in runs of one material, with all that laws take and give: one call a run. Whoever has
   * points gathers their F and history, asks, and at the end of a step stores the new history.
   */
  class MaterialBlock
  {
  public:
    /// Points of one material, [begin, end) in the arrays.
    struct Run
    {
      unsigned int material, begin, end;
    };

    /// @param laws of the scene's materials, which must outlive the block
    explicit MaterialBlock(std::vector<const Material *> laws);

    /// Makes room for @p n points.
    void resize(unsigned int n);

    /// Numbers that each point must store: as many as the law with the longest memory has.
    unsigned int
    n_history() const
    {
      return history_size;
    }

    /// Whether the tangents of all laws are symmetric.
    bool has_symmetric_tangents() const;

    const std::vector<const Material *> &
    all_laws() const
    {
      return laws;
    }

    const Material &
    law(const unsigned int material) const
    {
      return *laws[material];
    }

    /// Reads the history of all points; @p stored(p) where point p keeps its n_history() numbers.
    template <typename Stored>
    void gather_history(const Stored &stored);

    /// Writes the history found by evaluate(next_step) likewise.
    template <typename Stored>
    void store_history(const Stored &stored) const;

    /// tau, and what is @p wanted of psi, Jc, F33 and the new history (of Wanted, combined by |), from runs, F, the history and
    /// dt. Returns the worst status of the points; local.
    StepStatus evaluate(unsigned int wanted);

    unsigned int                      size = 0; ///< number of points; the arrays may be longer
    std::vector<Run>                  runs;
    std::vector<dealii::Tensor<2, 3>> F;
    double                            dt = 0.; ///< since the history was stored [s]

    std::vector<dealii::SymmetricTensor<2, 3>> tau; ///< [Pa]
    std::vector<dealii::SymmetricTensor<4, 3>> Jc;  ///< [Pa]
    std::vector<double>                        psi; ///< [J/m^3]
    std::vector<double>                        F33;

  private:
    template <typename Visit>
    void for_history(const Visit &visit) const;

    const std::vector<const Material *> laws;
    unsigned int                        history_size = 0;
    std::vector<double>                 history, new_history; ///< a run's begins at begin * n_history()
  };

  /// Calls visit(point, place in the history, how many numbers) for points whose law has a history.
  template <typename Visit>
  void
  MaterialBlock::for_history(const Visit &visit) const
  {
    if (history_size == 0)
      return;
    for (const Run &run : runs)
      if (const unsigned int n = laws[run.material]->n_history(); n > 0)
        for (unsigned int p = run.begin; p < run.end; ++p)
          visit(p, run.begin * history_size + (p - run.begin) * n, n);
  }

  template <typename Stored>
  void
  MaterialBlock::gather_history(const Stored &stored)
  {
    for_history([&](const unsigned int p, const std::size_t place, const unsigned int n) {
      std::copy_n(stored(p), n, history.data() + place);
    });
  }

  template <typename Stored>
  void
  MaterialBlock::store_history(const Stored &stored) const
  {
    for_history([&](const unsigned int p, const std::size_t place, const unsigned int n) {
      std::copy_n(new_history.data() + place, n, stored(p));
    });
  }
} // namespace Stroma::Materials
