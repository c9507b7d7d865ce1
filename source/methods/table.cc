#include <stroma/methods/table.h>

// STROMA_METHODS is `ENTRY(mpm) ENTRY(fem)` and so on, from CMake's list of that name.
namespace Stroma
{
#define ENTRY(name)                                                                                                    \
  template <int dim>                                                                                                   \
  MethodEntry<dim> name##_entry();
  STROMA_METHODS
#undef ENTRY

  template <int dim>
  const std::vector<MethodEntry<dim>> &
  methods()
  {
#define ENTRY(name) name##_entry<dim>(),
    static const std::vector<MethodEntry<dim>> table = {STROMA_METHODS};
#undef ENTRY
    return table;
  }

  template const std::vector<MethodEntry<2>> &methods();
  template const std::vector<MethodEntry<3>> &methods();
} // namespace Stroma
