#include <stroma/methods/table.h>

// STROMA_METHODS is `ENTRY(mpm) ENTRY(fem)` and so on, from CMake's list of that name; STROMA_METHODS_LEFT_OUT the same of the
// others, `LEFT_OUT(sph)`.
namespace Stroma
{
#define ENTRY(name)                                                                                                    \
  template <int dim>                                                                                                   \
  MethodEntry<dim> name##_entry();
  STROMA_METHODS
#undef ENTRY

  namespace
  {
    template <int dim>
    std::vector<MethodEntry<dim>> &
    table()
    {
#define ENTRY(name) name##_entry<dim>(),
      static std::vector<MethodEntry<dim>> entries = {STROMA_METHODS};
#undef ENTRY
      return entries;
    }
  } // namespace

  template <int dim>
  const std::vector<MethodEntry<dim>> &
  methods()
  {
    return table<dim>();
  }

  template <int dim>
  void
  add_method(const MethodEntry<dim> &entry)
  {
    table<dim>().push_back(entry);
  }

  const std::vector<std::string> &
  methods_left_out()
  {
#define LEFT_OUT(name) #name,
    static const std::vector<std::string> names = {STROMA_METHODS_LEFT_OUT};
#undef LEFT_OUT
    return names;
  }

  template const std::vector<MethodEntry<2>> &methods();
  template const std::vector<MethodEntry<3>> &methods();
  template void                               add_method(const MethodEntry<2> &);
  template void                               add_method(const MethodEntry<3> &);
} // namespace Stroma
