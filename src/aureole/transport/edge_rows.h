// SPDX-License-Identifier: Apache-2.0
// Rows of edges that a segment passes one after the other, and which diffract its light together.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "aureole/scene/edge/outline_edges.h"

namespace aureole {

/// A part of an edge that may act together with others.
struct RowPart {
  EdgePassage passage;
  double v = 0;          ///< |v| of the longest wavelength
  std::size_t part = 0;  ///< its index among all parts
  double weight = 1;     ///< share of its wave that acts in rows and not by itself
  /// Whether its wave was subtracted from the field as that of a segment on its open side (true) or in its shadow (false);
  /// empty: it was not subtracted.
  std::optional<bool> subtracted{};
};

/// Parts of edges that may act together, in the order along the segment.
class RowParts {
public:
  static constexpr std::size_t kCapacity = 24;
  /// Of more than kCapacity edges those with the smallest |v| are kept.
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
  static constexpr double kLargestV = 15;  ///< beyond it two edges have less than 1e-3 of the field together
  std::size_t count_ = 0;
  std::array<RowPart, kCapacity> parts_;
};

/// Rows of edges one behind the other, and their common field.
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
        // Where rays by way of single edges do not agree with half planes, the edges are no screens for each other.
        if (link.from_begin && link.to_end &&
            pair.agrees(parts[i].subtracted.has_value(), parts[k].subtracted.has_value()))
          join(i, k);
      }
  }
  /// Calls use(row, count) for each row of at least three edges, as indices into the parts: sets of pairs that act together or,
  /// if the segment is blocked and no light reaches its end by way of one edge, the shortest path over several.
  template <class Use>
  void for_each(bool is_dark, const Use& use) const {
    std::array<std::size_t, RowParts::kCapacity> row;
    for (std::size_t first = 0; first < parts_.size(); ++first) {
      std::size_t count = 0;
      double least = 1e9;
      for (std::size_t i = first; i < parts_.size(); ++i)
        if (row_of_[i] == first) row[count++] = i, least = std::min(least, signed_v(i));
      if (count < 3) continue;
      // An edge far below the others' is no screen between them: it would end their correlation.
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
  /// |v|, negative where the segment was taken to pass in the edge's shadow.
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
  /// The shortest way from the segment's begin by way of linked edges to its end; returns their number.
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
