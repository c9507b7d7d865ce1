#include <stroma/materials/material_block.h>

#include <algorithm>

namespace Stroma::Materials
{
  namespace
  {
    /// [begin, begin + n) of @p numbers, or nothing.
    template <typename T>
    dealii::ArrayView<T>
    part(std::vector<T> &numbers, const bool wanted, const std::size_t begin, const std::size_t n)
    {
      return wanted ? dealii::ArrayView<T>(numbers.data() + begin, n) : dealii::ArrayView<T>();
    }

    template <typename T>
    void
    grow(std::vector<T> &numbers, const bool wanted, const std::size_t n)
    {
      if (wanted && numbers.size() < n)
        numbers.resize(n);
    }
  } // namespace

  MaterialBlock::MaterialBlock(std::vector<const Material *> all)
    : laws(std::move(all))
  {
    for (const auto *law : laws)
      history_size = std::max(history_size, law->n_history());
  }

  bool
  MaterialBlock::has_symmetric_tangents() const
  {
    return std::all_of(laws.begin(), laws.end(), [](const auto *law) { return law->has_symmetric_tangent(); });
  }

  void
  MaterialBlock::resize(const unsigned int n)
  {
    size = n;
    grow(F, true, n);
    grow(tau, true, n);
    grow(history, true, std::size_t(n) * history_size);
  }

  StepStatus
  MaterialBlock::evaluate(const unsigned int wanted)
  {
    grow(psi, wanted & energy, size);
    grow(Jc, wanted & tangent, size);
    grow(F33, wanted & stretch, size);
    grow(new_history, wanted & next_step, std::size_t(size) * history_size);
    StepStatus status = StepStatus::ok;
    for (const Run &run : runs)
      {
        const unsigned int n = run.end - run.begin, b = run.begin;
        const Material    &law = *laws[run.material];
        const unsigned int m   = law.n_history();
        MaterialInput      input{part(F, true, b, n), part(history, m > 0, b * history_size, n * m), dt};
        MaterialOutput output{part(tau, true, b, n), part(Jc, wanted & tangent, b, n), part(psi, wanted & energy, b, n),
                              part(F33, wanted & stretch, b, n),
                              part(new_history, m > 0 && (wanted & next_step), b * history_size, n * m)};
        status = worse(status, law.evaluate(input, output));
      }
    return status;
  }
} // namespace Stroma::Materials
