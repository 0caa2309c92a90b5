// SPDX-License-Identifier: Apache-2.0
// `RangeMaximum`: the largest of the numbers from one index to another, by a table of the maxima of 2^k numbers (Bender &
// Farach-Colton 2000, "The LCA problem revisited", section 3).
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <vector>

namespace aureole {

class RangeMaximum {
public:
  RangeMaximum() = default;
  explicit RangeMaximum(std::vector<float> numbers) {
    levels_.push_back(std::move(numbers));
    for (std::size_t width = 2; width <= levels_[0].size(); width *= 2) {
      const std::vector<float>& last = levels_.back();
      std::vector<float> next(levels_[0].size() - width + 1);
      for (std::size_t i = 0; i < next.size(); ++i) next[i] = std::max(last[i], last[i + width / 2]);
      levels_.push_back(std::move(next));
    }
  }

  /// The largest number with an index in [first, end), which must not be empty.
  float of(std::size_t first, std::size_t end) const {
    const std::size_t level = std::size_t(std::bit_width(end - first)) - 1;
    return std::max(levels_[level][first], levels_[level][end - (std::size_t(1) << level)]);
  }

private:
  /// level k holds, for each index, the maximum of the 2^k numbers from there on
  std::vector<std::vector<float>> levels_;
};

}  // namespace aureole
