#include <stroma/studies/norms.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Stroma::Studies
{
  namespace
  {
    template <typename Value>
    double
    size(const FieldPair &field, const std::size_t i, const Value &value)
    {
      double sum = 0.;
      for (unsigned int c = 0; c < field.components; ++c)
        sum += field.factor(c) * std::pow(value(i * field.components + c), 2);
      return std::sqrt(sum);
    }
  } // namespace

  void
  Norm::add_squares(const Norm &other)
  {
    difference += other.difference * other.difference;
    reference += other.reference * other.reference;
  }

  void
  Norm::take_larger(const Norm &other)
  {
    difference = std::max(difference, other.difference);
    reference  = std::max(reference, other.reference);
  }

  double
  FieldPair::factor(const unsigned int component) const
  {
    return field == "cauchy_stress_Pa" && component >= 3 ? 2. : 1.;
  }

  double
  FieldPair::size_of_a(const std::size_t i) const
  {
    return size(*this, i, [&](const std::size_t n) { return a[n]; });
  }

  double
  FieldPair::size_of_b(const std::size_t i) const
  {
    return size(*this, i, [&](const std::size_t n) { return b[n]; });
  }

  double
  FieldPair::size_of_difference(const std::size_t i) const
  {
    return size(*this, i, [&](const std::size_t n) { return a[n] - b[n]; });
  }

  Norm
  l2_norm(const FieldPair &field, const std::vector<double> &weight, const std::vector<std::size_t> &places)
  {
    Norm squares;
    for (const std::size_t i : places)
      {
        squares.difference += weight[i] * std::pow(field.size_of_difference(i), 2);
        squares.reference += weight[i] * std::pow(field.size_of_b(i), 2);
      }
    return {std::sqrt(squares.difference), std::sqrt(squares.reference)};
  }

  Norm
  max_norm(const FieldPair &field, const std::vector<std::size_t> &places)
  {
    Norm norm;
    for (const std::size_t i : places)
      {
        norm.difference = std::max(norm.difference, field.size_of_difference(i));
        norm.reference  = std::max(norm.reference, field.size_of_b(i));
      }
    return norm;
  }

  double
  observed_order(const double value_1, const double error_1, const double value_2, const double error_2)
  {
    const bool usable = value_1 > 0. && value_2 > 0. && value_1 != value_2 && error_1 > 0. && error_2 > 0.;
    return usable ? std::log(error_1 / error_2) / std::abs(std::log(value_2 / value_1)) : unknown;
  }

  double
  median(std::vector<double> values)
  {
    if (values.empty())
      return unknown;
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : .5 * (values[half - 1] + values[half]);
  }

  double
  spread(const std::vector<double> &values)
  {
    if (values.empty())
      return unknown;
    const auto ends = std::minmax_element(values.begin(), values.end());
    return *ends.second - *ends.first;
  }
} // namespace Stroma::Studies
