#include "label_map.h"

#include <stroma/base/errors.h>
#include <stroma/base/text.h>
#include <stroma/scene/voxel_materials.h>

#include <algorithm>
#include <cctype>
#include <numeric>

namespace Stroma
{
  namespace
  {
    /// A label written with digits only, -1 for anything else.
    int
    label_of(const std::string &text)
    {
      const bool digits = !text.empty() && text.size() < 7 &&
                          std::all_of(text.begin(), text.end(), [](const unsigned char c) { return std::isdigit(c); });
      const int label = digits ? std::stoi(text) : -1;
      return label < static_cast<int>(LabelMap::n_labels) ? label : -1;
    }
  } // namespace

  LabelMap::LabelMap(const std::string &where, const std::vector<std::string> &texts,
                     const std::vector<std::string> &names)
    : texts(texts)
    , material(n_labels, -1)
  {
    int others = -1;
    for (const auto &text : texts)
      {
        const auto parts = split(text, ':');
        const auto found = parts.size() == 2 ? std::find(names.begin(), names.end(), parts[1]) : names.end();
        const bool empty = parts.size() == 2 && parts[1] == "empty";
        const int  index = empty ? VoxelMaterials::empty : static_cast<int>(found - names.begin());
        const auto range = parts.empty() ? std::vector<std::string>() : split(parts[0], '-');
        const bool rest  = !parts.empty() && parts[0] == "all others";
        const int  first = range.empty() ? -1 : label_of(range.front()),
                  last   = range.empty() ? -1 : label_of(range.back());
        if ((found == names.end() && !empty) || (!rest && (range.size() > 2 || first < 0 || last < first)))
          throw UserError(where,
                          "'Materials' has '" + text + "'; each part must be 'label: material', 'first-last: " +
                            "material' or 'all others: material', with labels of 0 to 65535 and a material of: " +
                            join(names, ", ") + ", empty");
        text_material.push_back(index);
        if (rest && others >= 0)
          throw UserError(where, "'Materials' has 'all others' twice; give it once");
        if (rest)
          others = index;
        for (int label = first; !rest && label <= last; ++label)
          {
            if (material[label] >= 0)
              throw UserError(where, "'Materials' gives label " + std::to_string(label) + " twice; give it once");
            material[label] = index;
          }
        if (!rest && range.size() == 1)
          single.push_back(first);
      }
    std::replace(material.begin(), material.end(), -1, others);
  }

  std::vector<unsigned int>
  LabelMap::named() const
  {
    std::vector<unsigned int> indices;
    for (const int index : text_material)
      if (index != VoxelMaterials::empty)
        indices.push_back(index);
    std::sort(indices.begin(), indices.end());
    indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
    return indices;
  }

  std::vector<unsigned int>
  LabelMap::absent(const std::vector<std::size_t> &count) const
  {
    std::vector<unsigned int> labels;
    for (const unsigned int label : single)
      if (count[label] == 0)
        labels.push_back(label);
    return labels;
  }

  std::array<std::uint8_t, 256>
  LabelMap::ranks() const
  {
    std::array<unsigned int, 256> lowest;
    lowest.fill(n_labels);
    for (unsigned int label = n_labels; label-- > 0;)
      if (material[label] >= 0)
        lowest[material[label]] = label;
    std::array<std::uint8_t, 256> order, rank;
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](const auto a, const auto b) { return lowest[a] < lowest[b]; });
    for (unsigned int i = 0; i < order.size(); ++i)
      rank[order[i]] = i;
    return rank;
  }

  std::string
  LabelMap::texts_of(const unsigned int index) const
  {
    std::vector<std::string> found;
    for (unsigned int i = 0; i < texts.size(); ++i)
      if (text_material[i] == static_cast<int>(index) && found.size() < 5)
        found.push_back("'" + texts[i] + "'");
    return join(found, ", ");
  }
} // namespace Stroma
