// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/arrangement/block_average.h"

#include <cmath>

namespace aureole::optics {

double BlockAverage::Level::error() const {
  return blocks < 2 ? 0 : std::sqrt(squares / (double(blocks) * double(blocks - 1)));
}

void BlockAverage::add(double value) {
  for (size_t k = 0;; ++k) {
    if (k == levels_.size()) levels_.emplace_back();
    Level& level = levels_[k];
    const double change = value - level.mean;
    level.mean += change / double(++level.blocks);
    level.squares += change * (value - level.mean);
    level.has_pending = !level.has_pending;
    if (level.has_pending) {
      level.pending = value;
      return;
    }
    value = 0.5 * (level.pending + value);
  }
}

void BlockAverage::merge(const BlockAverage& other) {
  // An incomplete block is not passed to the next level, as in `add` at the end of a series.
  if (levels_.size() < other.levels_.size()) levels_.resize(other.levels_.size());
  for (size_t k = 0; k < other.levels_.size(); ++k) {
    Level& a = levels_[k];
    const Level& b = other.levels_[k];
    const double n = double(a.blocks + b.blocks), change = b.mean - a.mean;
    if (n == 0) continue;
    a.squares += b.squares + change * change * double(a.blocks) * double(b.blocks) / n;
    a.mean += change * double(b.blocks) / n;
    a.blocks += b.blocks;
    a.has_pending = false;
  }
}

int BlockAverage::plateau() const {
  // least number of blocks, with which the standard error is known to better than 20 %
  constexpr std::int64_t kMinBlocks = 16;
  int k = 0;
  while (k + 1 < int(levels_.size()) && levels_[size_t(k) + 1].blocks >= kMinBlocks) {
    const Level& next = levels_[size_t(k) + 1];
    const double noise = 1 / std::sqrt(2.0 * double(next.blocks - 1));
    if (next.error() <= levels_[k].error() * (1 + noise)) break;
    ++k;
  }
  return k;
}

double BlockAverage::error() const { return levels_.empty() ? 0 : levels_[plateau()].error(); }

double BlockAverage::correlation_time() const {
  if (levels_.empty() || levels_[0].squares == 0) return 1;
  const double ratio = error() / levels_[0].error();
  return ratio * ratio;
}

}  // namespace aureole::optics
