#include <stroma/mpm/layout.h>

namespace Stroma::Mpm
{
  FieldHandle
  Layout::declare(const std::string &name, const std::string &unit, const unsigned int components)
  {
    const FieldHandle handle{total, components};
    declared.push_back({name, unit, components});
    total += components;
    return handle;
  }
} // namespace Stroma::Mpm
