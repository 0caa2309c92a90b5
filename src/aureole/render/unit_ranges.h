// SPDX-License-Identifier: Apache-2.0
// `UnitRanges`: which units of a job are done.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace aureole {

/// A set of numbers of units, kept as ranges. Units are done nearly in order, so that a job of 2^31 samples per
/// pixel has a few ranges and not a flag for each of its thousand million units.
class UnitRanges {
public:
  /// The numbers from `begin` to `end` - 1.
  struct Range {
    std::int64_t begin, end;
    bool operator==(const Range&) const = default;
  };

  void insert(std::int64_t unit) { insert({unit, unit + 1}); }
  void insert(const Range& range);

  /// Returns the end of the range that contains `unit`, or `unit` if none does.
  std::int64_t end_of(std::int64_t unit) const;
  bool contains(std::int64_t unit) const { return end_of(unit) > unit; }
  bool contains(const Range& range) const {
    return range.begin >= range.end || end_of(range.begin) >= range.end;
  }

  std::int64_t count() const { return count_; }
  /// Number of units of `range` in the set.
  std::int64_t count(const Range& range) const;

  /// Returns the first unit of `range` in the set, if there is one.
  std::optional<std::int64_t> first_in(const Range& range) const;

  /// The ranges in increasing order; between two of them lies at least one number that is not in the set.
  std::vector<Range> ranges() const;

  bool operator==(const UnitRanges&) const = default;

private:
  std::map<std::int64_t, std::int64_t> ends_;  ///< end of each range by its begin
  std::int64_t count_ = 0;
};

}  // namespace aureole
