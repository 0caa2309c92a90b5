// SPDX-License-Identifier: Apache-2.0
// Rows of edges: successive edges along a segment that diffract its light together.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "aureole/scene/edge/outline_edges.h"

namespace aureole {

/// A part of an edge that may diffract light together with others.
struct RowPart {
  EdgePassage passage;
  double v = 0;          ///< magnitude of Fresnel's parameter v at the longest wavelength
  std::size_t part = 0;  ///< index of the part among all parts
  double weight = 1;     ///< fraction of the part's wave that acts in rows instead of by itself
  /// Side on which the segment passed when the part's wave was subtracted from the field: the open side
  /// (true) or the shadow (false); empty: it was not subtracted.
  std::optional<bool> subtracted{};
};

/// Parts of edges that may diffract light together, in their order along the segment.
class RowParts {
public:
  static constexpr std::size_t kCapacity = 24;
  /// Adds a part. At most kCapacity parts are kept, those with the smallest |v|.
  void add(const RowPart& part) {
    if (part.v > kLargestV) return;
    if (count_ < kCapacity) {
      parts_[count_++] = part;
      return;
    }
    const auto farthest = std::max_element(parts_.begin(), parts_.end(),
                                           [](const auto& a, const auto& b) { return a.v < b.v; });
    if (farthest->v > part.v) *farthest = part;
  }
  void sort(const EdgeSegment& segment) {
    const auto depth = [&](const RowPart& s) { return dot(s.passage.p, segment.d); };
    std::sort(parts_.begin(), parts_.begin() + std::ptrdiff_t(count_),
              [&](const auto& a, const auto& b) { return depth(a) < depth(b); });
  }
  std::size_t size() const { return count_; }
  const RowPart& operator[](std::size_t i) const { return parts_[i]; }

private:
  /// largest |v|: beyond it, two edges together contribute less than 1e-3 of the field
  static constexpr double kLargestV = 15;
  std::size_t count_ = 0;
  std::array<RowPart, kCapacity> parts_;
};

/// Rows of successive edges, and their common field.
class EdgeRows {
public:
  /// `sees(side, is_begin)`: whether a point beside an edge is visible from the segment's begin or end.
  template <class Sees, class IsFree>
  EdgeRows(const OutlineEdges& edges, const EdgeSegment& segment, const RowParts& parts, const Sees& sees,
           const IsFree& is_free_between)
      : edges_(edges), segment_(segment), parts_(parts) {
    for (std::size_t i = 0; i < parts.size(); ++i) row_of_[i] = i;
    for (std::size_t i = 0; i < parts.size(); ++i)
      for (std::size_t k = i + 1; k < parts.size(); ++k) {
        Link& link = links_[i][k];
        EdgePairField pair;
        if (!edges.find_pair(parts[i].passage, parts[k].passage, segment, pair)) continue;
        link.exists = is_free_between(pair.side1, pair.side2);
        if (!link.exists) continue;
        link.from_begin = sees(pair.side1, true), link.to_end = sees(pair.side2, false);
        // Edges whose rays do not agree with half planes are no screens for each other.
        if (link.from_begin && link.to_end &&
            pair.agrees(parts[i].subtracted.has_value(), parts[k].subtracted.has_value()))
          join(i, k);
      }
  }
  /// Calls use(row, count) for each row of at least three edges, as indices into the parts. Rows are sets of
  /// pairs that act together. If the segment is occluded and no light reaches its end around one edge, the
  /// shortest path around several edges is a row as well.
  template <class Use>
  void for_each(bool is_dark, const Use& use) const {
    std::array<std::size_t, RowParts::kCapacity> row;
    for (std::size_t first = 0; first < parts_.size(); ++first) {
      std::size_t count = 0;
      double least = 1e9;
      for (std::size_t i = first; i < parts_.size(); ++i)
        if (row_of_[i] == first) row[count++] = i, least = std::min(least, signed_v(i));
      if (count < 3) continue;
      // Difference of v beyond which a lower edge is no screen between the others: including it would end
      // their correlation.
      constexpr double kBelow = 2;
      const auto last = std::remove_if(row.begin(), row.begin() + std::ptrdiff_t(count),
                                       [&](std::size_t i) { return signed_v(i) > least + kBelow; });
      count = std::size_t(last - row.begin());
      if (count >= 3 && is_linked(row.data(), count)) use(row.data(), count), is_dark = false;
    }
    if (is_dark)
      if (const std::size_t count = find_shortest(row.data()); count >= 3) use(row.data(), count);
  }

private:
  struct Link {
    bool exists = false, from_begin = false, to_end = false;
  };
  void join(std::size_t i, std::size_t k) {
    const std::size_t from = std::max(row_of_[i], row_of_[k]), to = std::min(row_of_[i], row_of_[k]);
    for (std::size_t& row : row_of_)
      if (row == from) row = to;
  }
  /// Returns |v|, with a negative sign where the segment passes in the edge's shadow.
  double signed_v(std::size_t i) const {
    EdgeSide side;
    const EdgePassage& p = parts_[i].passage;
    const bool is_open = !edges_.find_side(p, segment_, p.in, p.out, true, side) || side.is_open;
    return is_open ? parts_[i].v : -parts_[i].v;
  }
  bool is_linked(const std::size_t* row, std::size_t count) const {
    for (std::size_t i = 0; i + 1 < count; ++i)
      if (!links_[row[i]][row[i + 1]].exists) return false;
    return true;
  }
  /// Finds the shortest path from the segment's begin to its end by way of linked edges; returns the number
  /// of edges.
  std::size_t find_shortest(std::size_t* row) const {
    constexpr double kFar = 1e300;
    const std::size_t n = parts_.size();
    std::array<double, RowParts::kCapacity> length_to;
    std::array<std::size_t, RowParts::kCapacity> before;
    double best = kFar;
    std::size_t last = n;
    for (std::size_t k = 0; k < n; ++k) {
      length_to[k] = kFar, before[k] = n;
      for (std::size_t i = 0; i < k; ++i) {
        if (!links_[i][k].exists) continue;
        double so_far = length_to[i];
        if (links_[i][k].from_begin && length(parts_[i].passage.p) <= so_far)
          so_far = length(parts_[i].passage.p);
        if (so_far == kFar) continue;
        const double to_k = so_far + length(parts_[k].passage.p - parts_[i].passage.p);
        if (to_k < length_to[k]) length_to[k] = to_k, before[k] = i;
        if (!links_[i][k].to_end) continue;
        const Double3& p = parts_[k].passage.p;
        const double rest =
            segment_.is_infinite() ? -dot(p, segment_.d) : length(segment_.d * segment_.length - p);
        if (to_k + rest < best) best = to_k + rest, last = k;
      }
    }
    std::size_t count = 0;
    for (std::size_t k = last; k < n; k = before[k]) row[count++] = k;
    std::reverse(row, row + count);
    return count;
  }

  const OutlineEdges& edges_;
  const EdgeSegment& segment_;
  const RowParts& parts_;
  std::array<std::array<Link, RowParts::kCapacity>, RowParts::kCapacity> links_{};
  std::array<std::size_t, RowParts::kCapacity> row_of_{};
};

}  // namespace aureole
