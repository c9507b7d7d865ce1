#pragma once

#include <string>
#include <vector>

namespace Stroma::Mpm
{
  /// Where a field lives among a point's numbers; found once, then used without any look-up.
  struct FieldHandle
  {
    static constexpr unsigned int absent = static_cast<unsigned int>(-1);

    unsigned int first      = absent;
    unsigned int components = 0;

    bool
    stored() const
    {
      return first != absent;
    }
  };

  /**
   * The numbers that a material point carries in this scene, and no others. Parts declare their fields before the
   * points are made.
   */
  class Layout
  {
  public:
    struct Field
    {
      std::string  name;
      std::string  unit;
      unsigned int components;
    };

    FieldHandle declare(const std::string &name, const std::string &unit, unsigned int components);

    /// Numbers a point.
    unsigned int
    size() const
    {
      return total;
    }
    const std::vector<Field> &
    fields() const
    {
      return declared;
    }

  private:
    std::vector<Field> declared;
    unsigned int       total = 0;
  };
} // namespace Stroma::Mpm
