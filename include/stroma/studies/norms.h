#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace Stroma::Studies
{
  inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

  /// A norm of A - B and of B, in the field's unit (L2 and H1: times the root of the volume's).
  struct Norm
  {
    double difference = 0., reference = 0.;

    /// difference / reference; not a number if both are 0 or unknown, infinite if only B is 0.
    double
    relative() const
    {
      return difference / reference;
    }

    /// Makes this, a sum of squares or a largest value so far, that of more places with norm @p other.
    void add_squares(const Norm &other);
    void take_larger(const Norm &other);
  };

  /// Values of one field of A and B at the same places, all components of a place side by side.
  struct FieldPair
  {
    std::string         field;
    unsigned int        components = 0;
    std::vector<double> a, b;

    /// How often a component counts in a square: 2 for the shear stresses, which stand for two entries.
    double factor(unsigned int component) const;

    /// |A|, |B| and |A - B| at place @p i, Euclidean; for numbers without the sign.
    double size_of_a(std::size_t i) const;
    double size_of_b(std::size_t i) const;
    double size_of_difference(std::size_t i) const;
  };

  /// sqrt(sum_i w_i |A_i - B_i|^2) over the places @p places, and the same of B. Applied to the displacement gradient it
  /// is the H1 semi norm of the displacement.
  /// @param weight undeformed volume that each place stands for [m^3]
  Norm l2_norm(const FieldPair &field, const std::vector<double> &weight, const std::vector<std::size_t> &places);

  /// max_i |A_i - B_i|, and max_i |B_i|.
  Norm max_norm(const FieldPair &field, const std::vector<std::size_t> &places);

  /// Observed order log(e1 / e2) / |log(v2 / v1)| between two values given from coarse to fine; not a number if a value or
  /// an error is not positive, or v1 = v2.
  double observed_order(double value_1, double error_1, double value_2, double error_2);

  /// Middle value (the mean of the two middle ones of an even number) and largest minus smallest. Not a number if empty.
  double median(std::vector<double> values);
  double spread(const std::vector<double> &values);
} // namespace Stroma::Studies
