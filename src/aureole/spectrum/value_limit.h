// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>

namespace aureole {

/// The largest value of a spectrum that a scene may state. Sums and products of larger floats become
/// infinite.
inline constexpr double kLargestSpectrumValue = 1e37;

/// Rounding noise of programs that write scenes: the largest distance by which a value may miss a limit,
/// relative to the largest value.
inline constexpr double kLimitNoise = 1e-6;

/// Moves values to the ends of an interval that they miss by rounding noise, and counts them. Other values
/// stay as they are.
class NoiseClamp {
public:
  /// Clamps to [lower, upper]. `largest` is the largest value of the data, or 1.
  NoiseClamp(double lower, double upper, double largest = 1)
      : lower_(lower), upper_(upper), tolerance_(std::max(kLimitNoise * largest, 1e-30)) {}

  template <class Value>
  Value operator()(Value v) {
    const double exact = double(v);
    const bool below = exact < lower_ && exact >= lower_ - tolerance_,
               above = exact > upper_ && exact <= upper_ + tolerance_;
    if (!below && !above) return v;
    if (count_++ == 0) first_ = exact;
    return Value(below ? lower_ : upper_);
  }
  bool any() const { return count_ > 0; }
  /// Returns a note such as "1.0000001 counts as 1" or "12 values ...".
  std::string note() const {
    const double limit = first_ < lower_ ? lower_ : upper_;
    if (count_ == 1) return fmt::format("{:.8g} counts as {:g}, which it misses by rounding", first_, limit);
    return fmt::format("{} values that miss a limit by rounding are moved to it; the first is {:.8g}", count_,
                       first_);
  }

private:
  double lower_, upper_, tolerance_, first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace aureole
