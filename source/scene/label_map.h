#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace Stroma
{
  /// Material of each label of an image, from texts such as "0: collagen", "1-300: cell" and "all others: cell".
  class LabelMap
  {
  public:
    /**
     * @param where place of the entry, for messages
     * @param texts parts of the entry 'Materials'
     * @param names of the scene's materials
     * Throws UserError for what is no such text, an unknown material or a label that is given twice.
     */
    LabelMap(const std::string &where, const std::vector<std::string> &texts, const std::vector<std::string> &names);

    static constexpr unsigned int n_labels = 1 << 16;

    /// Index of the label's material, VoxelMaterials::empty, or -1 if it has none.
    int
    at(const unsigned int label) const
    {
      return material[label];
    }

    /// The materials that the map names, without `empty`, in order of index.
    std::vector<unsigned int> named() const;

    /// Labels named one by one, not as a range, that `count` (by label) says are absent; for people.
    std::vector<unsigned int> absent(const std::vector<std::size_t> &count) const;

    /// Of each material by index, and of VoxelMaterials::empty, its place in the order of their lowest labels; those that the
    /// map does not name come last.
    std::array<std::uint8_t, 256> ranks() const;

    /// The texts whose labels have this material, for messages.
    std::string texts_of(unsigned int material) const;

  private:
    std::vector<std::string>  texts;
    std::vector<int>          text_material; ///< of each text
    std::vector<int>          material;      ///< by label
    std::vector<unsigned int> single;        ///< labels named one by one
  };
} // namespace Stroma
