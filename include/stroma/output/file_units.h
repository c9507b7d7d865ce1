#pragma once

#include <map>
#include <string>

namespace Stroma
{
  class Parameters;
}

namespace Stroma::Output
{
  /// A unit of the numbers in a file.
  struct FileUnit
  {
    std::string name;   ///< as names of fields have it: "um_per_s"
    double      factor; ///< what numbers in SI are multiplied by
  };

  /// Units of the numbers in field files: SI, or those of the scene's section Units.
  class FileUnits
  {
  public:
    FileUnits() = default; ///< SI
    explicit FileUnits(const Parameters &p);

    bool
    is_si() const
    {
      return symbols.empty();
    }

    /// @param si unit of SI as names of fields have it: "m", "m_per_s", "kg_per_m3", "" for a number without one
    FileUnit of(const std::string &si) const;

    /// Of a field in the file: "displacement_um" of "displacement" and "m".
    std::string name(const std::string &field, const std::string &si) const;

  private:
    std::map<std::string, FileUnit> symbols; ///< for "m", "s", ...; those that are not there stay
  };
} // namespace Stroma::Output
