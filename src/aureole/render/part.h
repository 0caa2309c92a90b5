// SPDX-License-Identifier: Apache-2.0
// Parts of a picture that several machines render: the form in which a part travels, and the sum of the parts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "aureole/render/state.h"

namespace aureole {

/// Returns the content of a state file as one frame of Zstandard (RFC 8878) that states its size. Pixels without samples are
/// zeros, so that a part costs little more than its own tiles.
std::vector<char> packed_part(const RenderState& state);

/// The sum of the parts of one picture. Sums of films are exact, so that it does not depend on the order of the parts.
class PartSum {
public:
  /// Begins with a state of the picture, as `planned_state` makes it.
  explicit PartSum(RenderState state);

  const RenderState& state() const { return state_; }

  /// Replaces the state by that of a state file, with the samples of the plan. Throws Error, located at `where`, for a
  /// damaged file, another picture, or samples that do not fit.
  void resume(std::span<const char> state_file, const SourceLocation& where);

  /// Reads a part of this picture. Memory is bounded by the size of the picture's own state. Throws Error for a part that is
  /// damaged or larger, belongs to another picture, or has other samples.
  RenderState unpacked(std::span<const char> packed) const;

  /// Reads a part that has exactly the units `units`. Throws Error as `unpacked` does, and for other units.
  RenderState checked(std::span<const char> packed, const UnitRanges::Range& units) const;

  /// Adds a part. Throws Error as `checked` does, for units that were added before, and for other densities of adaptive
  /// samples; the sum is then as it was.
  void add(std::span<const char> packed, const UnitRanges::Range& units);

  /// The picture without samples; densities of adaptive samples are kept.
  RenderState start() const;

private:
  RenderState state_;
  std::size_t largest_ = 0;  ///< bytes of a state of this picture
};

/// Whether two states of a picture have the same units, sums, densities and counts of invalid samples. The time that they
/// took is left out.
bool same_samples(const RenderState& a, const RenderState& b);

}  // namespace aureole
