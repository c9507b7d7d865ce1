#include <stroma/studies/pairing.h>

#include <algorithm>

namespace Stroma::Studies
{
  namespace
  {
    /// Component blocks of each field out of values side by side.
    std::vector<double>
    part_of(const std::vector<double> &values, const unsigned int stride, const unsigned int first,
            const unsigned int n)
    {
      std::vector<double> part;
      part.reserve(values.size() / stride * n);
      for (std::size_t i = 0; i < values.size(); i += stride)
        part.insert(part.end(), values.begin() + i + first, values.begin() + i + first + n);
      return part;
    }
  } // namespace

  Pairing::Pairing(FieldSource &a, const std::vector<std::string> &fields, PlaceSet of_a, PlaceSet of_b)
    : places(std::move(of_b))
    , values_a(std::move(of_a.samples.values))
    , found_a(std::move(of_a.samples.found))
  {
    for (const auto &name : fields)
      known.push_back({name, n_components(a, {name})});
    for (const auto &field : known)
      stride += field.components;
    for (std::size_t i = 0; i < places.samples.X.size(); ++i)
      {
        const bool in_a = found_a.empty() || found_a[i], in_b = places.samples.found.empty() || places.samples.found[i];
        uncovered_by_a += !in_a;
        uncovered_by_b += !in_b;
        if (in_a && in_b)
          covered.push_back(i);
        blank(values_a, i, in_a);
        blank(places.samples.values, i, in_b);
      }
  }

  bool
  Pairing::has(const std::string &name) const
  {
    return std::any_of(known.begin(), known.end(), [&](const auto &field) { return field.name == name; });
  }

  FieldPair
  Pairing::pair(const std::string &name) const
  {
    unsigned int first = 0;
    for (const auto &field : known)
      {
        if (field.name == name)
          return {name, field.components, part_of(values_a, stride, first, field.components),
                  part_of(places.samples.values, stride, first, field.components)};
        first += field.components;
      }
    throw dealii::ExcInternalError();
  }

  void
  Pairing::blank(std::vector<double> &values, const std::size_t i, const bool found) const
  {
    if (!found)
      std::fill_n(values.begin() + i * stride, stride, unknown);
  }
} // namespace Stroma::Studies
