// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/unit_ranges.h"

#include <algorithm>

namespace aureole {

void UnitRanges::insert(const Range& range) {
  if (range.begin >= range.end) return;
  std::int64_t begin = range.begin, end = range.end;
  auto at = ends_.upper_bound(begin);
  // the previous range contains `begin` or ends there
  if (at != ends_.begin() && std::prev(at)->second >= begin) --at;
  while (at != ends_.end() && at->first <= end) {
    begin = std::min(begin, at->first), end = std::max(end, at->second);
    count_ -= at->second - at->first;
    at = ends_.erase(at);
  }
  ends_.emplace_hint(at, begin, end);
  count_ += end - begin;
}

std::int64_t UnitRanges::end_of(std::int64_t unit) const {
  const auto after = ends_.upper_bound(unit);
  return after == ends_.begin() ? unit : std::max(unit, std::prev(after)->second);
}

std::int64_t UnitRanges::count(const Range& range) const {
  std::int64_t sum = 0;
  auto at = ends_.upper_bound(range.begin);
  if (at != ends_.begin()) --at;
  for (; at != ends_.end() && at->first < range.end; ++at)
    sum += std::max<std::int64_t>(0, std::min(at->second, range.end) - std::max(at->first, range.begin));
  return sum;
}

std::optional<std::int64_t> UnitRanges::first_in(const Range& range) const {
  if (range.begin >= range.end) return {};
  if (contains(range.begin)) return range.begin;
  const auto after = ends_.upper_bound(range.begin);
  if (after == ends_.end() || after->first >= range.end) return {};
  return after->first;
}

std::vector<UnitRanges::Range> UnitRanges::ranges() const {
  std::vector<Range> all;
  for (const auto& [begin, end] : ends_) all.push_back({begin, end});
  return all;
}

}  // namespace aureole
