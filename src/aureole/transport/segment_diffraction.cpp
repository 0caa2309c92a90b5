// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/segment_diffraction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>

#include "aureole/scene/edge/outline_edges.h"

namespace aureole {

namespace {

/// Whether the way from `from` to shortly before `to` is free but for null surfaces.
bool is_free(const Scene& scene, const Vec3& from, const Vec3& to, bool infinite, const Wavelengths& w) {
  // The end lies on a surface: the test ends before it, by more than the rounding of its coordinates.
  constexpr float kPart = 0.99999f;
  if (scene.has_binary_visibility()) {
    const Ray ray = infinite ? Ray{from, to, kInfinity} : Ray{from, to - from, kPart};
    return !scene.tracer().occluded(ray);
  }
  TestSegment test;
  if (infinite)
    test.set(RayOrigin::in_space(from), to);
  else
    test.set(RayOrigin::in_space(from), normalize(to - from),
             RayOrigin::in_space(from + (to - from) * kPart));
  test.passage = test.clear_passage = 1.f;
  return is_visible(scene, test, w) && max_component(test.passage) >= TestSegment::kOpaque;
}

/// An edge beside the segment.
struct SeenPassage {
  EdgePassage passage;
  double v = 0;  ///< |v| of the longest wavelength
  /// Whether its wave was subtracted from the field as that of a segment on its open side (true) or in its shadow (false);
  /// empty: it was not subtracted.
  std::optional<bool> subtracted{};
};

/// The edges beside a segment that may act together with others, in the order along the segment.
class Passages {
public:
  static constexpr std::size_t kCapacity = 24;
  /// Of more than kCapacity edges those with the smallest |v| are kept.
  void add(const SeenPassage& seen) {
    if (!seen.passage.passes_middle() || seen.v > kLargestV) return;
    if (count_ < kCapacity) {
      seen_[count_++] = seen;
      return;
    }
    const auto farthest =
        std::max_element(seen_.begin(), seen_.end(), [](const auto& a, const auto& b) { return a.v < b.v; });
    if (farthest->v > seen.v) *farthest = seen;
  }
  void sort(const EdgeSegment& segment) {
    const auto depth = [&](const SeenPassage& s) { return dot(s.passage.p, segment.d); };
    std::sort(seen_.begin(), seen_.begin() + count_,
              [&](const auto& a, const auto& b) { return depth(a) < depth(b); });
  }
  std::size_t size() const { return count_; }
  const SeenPassage& operator[](std::size_t i) const { return seen_[i]; }

private:
  static constexpr double kLargestV = 15;  ///< beyond it two edges have less than 1e-3 of the field together
  std::ptrdiff_t count_ = 0;
  std::array<SeenPassage, kCapacity> seen_;
};

/// Rows of edges one behind the other, and their common field.
class EdgeRows {
public:
  /// `sees(side, is_begin)`: whether a point beside an edge is visible from the segment's begin or end.
  template <class Sees, class IsFree>
  EdgeRows(const OutlineEdges& edges, const EdgeSegment& segment, const Passages& passages, const Sees& sees,
           const IsFree& is_free_between)
      : edges_(edges), segment_(segment), passages_(passages) {
    for (std::size_t i = 0; i < passages.size(); ++i) row_of_[i] = i;
    for (std::size_t i = 0; i < passages.size(); ++i)
      for (std::size_t k = i + 1; k < passages.size(); ++k) {
        Link& link = links_[i][k];
        EdgePairField pair;
        if (!edges.find_pair(passages[i].passage, passages[k].passage, segment, pair)) continue;
        link.exists = is_free_between(pair.side1, pair.side2);
        if (!link.exists) continue;
        link.from_begin = sees(pair.side1, true), link.to_end = sees(pair.side2, false);
        // Where rays by way of single edges do not agree with half planes, the edges are no screens for each other.
        if (link.from_begin && link.to_end &&
            pair.agrees(passages[i].subtracted.has_value(), passages[k].subtracted.has_value()))
          join(i, k);
      }
  }
  /// Calls use(row, count) for each row of at least two edges, as indices into the passages: sets of pairs that act together
  /// or, if the segment is blocked and no light reaches its end by way of one or two edges, the shortest way over more.
  template <class Use>
  void for_each(bool is_dark, const Use& use) const {
    std::array<std::size_t, Passages::kCapacity> row;
    for (std::size_t first = 0; first < passages_.size(); ++first) {
      std::size_t count = 0;
      double least = 1e9;
      for (std::size_t i = first; i < passages_.size(); ++i)
        if (row_of_[i] == first) row[count++] = i, least = std::min(least, signed_v(i));
      if (count < 2) continue;
      if (count > 2) {
        // An edge far below the others' is no screen between them: it would end their correlation.
        constexpr double kBelow = 2;
        const auto last = std::remove_if(row.begin(), row.begin() + std::ptrdiff_t(count),
                                         [&](std::size_t i) { return signed_v(i) > least + kBelow; });
        count = std::size_t(last - row.begin());
      }
      if (count >= 2 && is_linked(row.data(), count)) use(row.data(), count), is_dark = false;
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
    const EdgePassage& p = passages_[i].passage;
    const bool is_open = !edges_.find_side(p, segment_, p.in, p.out, true, side) || side.is_open;
    return is_open ? passages_[i].v : -passages_[i].v;
  }
  bool is_linked(const std::size_t* row, std::size_t count) const {
    for (std::size_t i = 0; i + 1 < count; ++i)
      if (!links_[row[i]][row[i + 1]].exists) return false;
    return true;
  }
  /// The shortest way from the segment's begin by way of linked edges to its end; returns their number.
  std::size_t find_shortest(std::size_t* row) const {
    constexpr double kFar = 1e300;
    const std::size_t n = passages_.size();
    std::array<double, Passages::kCapacity> length_to;
    std::array<std::size_t, Passages::kCapacity> before;
    double best = kFar;
    std::size_t last = n;
    for (std::size_t k = 0; k < n; ++k) {
      length_to[k] = kFar, before[k] = n;
      for (std::size_t i = 0; i < k; ++i) {
        if (!links_[i][k].exists) continue;
        double so_far = length_to[i];
        if (links_[i][k].from_begin && length(passages_[i].passage.p) <= so_far)
          so_far = length(passages_[i].passage.p);
        if (so_far == kFar) continue;
        const double to_k = so_far + length(passages_[k].passage.p - passages_[i].passage.p);
        if (to_k < length_to[k]) length_to[k] = to_k, before[k] = i;
        if (!links_[i][k].to_end) continue;
        const Double3& p = passages_[k].passage.p;
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
  const Passages& passages_;
  std::array<std::array<Link, Passages::kCapacity>, Passages::kCapacity> links_{};
  std::array<std::size_t, Passages::kCapacity> row_of_{};
};

/// Returns the factor; `begin` and `end` are the ends off their surfaces, `end` a direction where it is at infinity.
Spectrum factor(const Scene& scene, const EdgeSegment& segment, const Vec3& begin, const Vec3& end,
                bool is_open, const Wavelengths& w) {
  const OutlineEdges& edges = *scene.outline_edges();
  std::array<double, kWavelengths> wavelengths;
  double shortest = kInfinity, longest = 0;
  for (std::size_t i = 0; i < wavelengths.size(); ++i) {
    wavelengths[i] = edges.wavelength(w.nm[int(i)]);
    shortest = std::min(shortest, wavelengths[i]), longest = std::max(longest, wavelengths[i]);
  }
  // All wavelengths of a path have one field where they differ by less than a fraction of its phase.
  constexpr double kAlike = 1e-5;
  const bool are_alike = longest - shortest < kAlike * longest;
  const int count = are_alike ? 1 : int(wavelengths.size());
  std::array<std::complex<double>, kWavelengths> field;
  field.fill(is_open ? 1.0 : 0.0);
  bool any = false;
  const bool infinite = segment.is_infinite();
  Passages passages;
  const auto sees = [&](const EdgeSide& side, bool is_begin) {
    return is_free(scene, side.beside.to_float(), is_begin ? begin : end, !is_begin && infinite, w);
  };
  edges.visit(segment, longest, [&](const EdgePassage& passage) {
    SeenPassage seen{passage};
    EdgeSide side;
    if (edges.find_side(passage, segment, passage.in, passage.out, false, side)) {
      if (sees(side, true) && sees(side, false)) {
        any = true;
        seen.subtracted = side.takes_open(is_open);
        edges.subtract(passage, segment, *seen.subtracted, wavelengths.data(), count, field.data());
      }
    }
    seen.v = edges.parameter(passage, segment) / std::sqrt(longest);
    passages.add(seen);
  });
  if (passages.size() > 1) {
    passages.sort(segment);
    const EdgeRows rows(edges, segment, passages, sees, [&](const EdgeSide& a, const EdgeSide& b) {
      return is_free(scene, a.beside.to_float(), b.beside.to_float(), false, w);
    });
    rows.for_each(!is_open && !any, [&](const std::size_t* row, std::size_t length_of_row) {
      std::array<EdgePairField, Passages::kCapacity> pairs;
      std::array<OutlineEdges::RowEdge, Passages::kCapacity> ends;
      for (std::size_t i = 0; i + 1 < length_of_row; ++i) {
        const SeenPassage &first = passages[row[i]], &second = passages[row[i + 1]];
        if (!edges.find_pair(first.passage, second.passage, segment, pairs[i])) return;
        if (i == 0) ends[0] = {pairs[0].side1.takes_open(is_open), first.subtracted};
        ends[i + 1] = {pairs[i].side2.takes_open(is_open), second.subtracted};
      }
      any = true;
      const EdgePassage &first = passages[row[0]].passage, &last = passages[row[length_of_row - 1]].passage;
      edges.add_row({pairs.data(), length_of_row - 1}, {ends.data(), length_of_row},
                    obliquity_of_turn(first.in, last.out), wavelengths.data(), count, field.data());
    });
  }
  if (!any) return is_open ? 1.f : 0.f;
  Spectrum result;
  for (std::size_t i = 0; i < field.size(); ++i) result[int(i)] = float(std::norm(field[are_alike ? 0 : i]));
  return result;
}

}  // namespace

Spectrum segment_diffraction(const Scene& scene, const Vec3& origin, const Vec3& d, float length,
                             bool is_open, const Wavelengths& w) {
  const EdgeSegment segment{Double3(origin), normalize(Double3(d)), double(length)};
  const bool infinite = segment.is_infinite();
  return factor(scene, segment, origin + d * (1e-5f * (infinite ? 1 : length)),
                infinite ? d : origin + d * length, is_open, w);
}

bool passes_edges(const Scene& scene, const Vec3& origin, const Vec3& d, const Wavelengths& w) {
  // |v| up to 20: less than 1e-3 of the light turns farther into a shadow.
  constexpr double kMost = 20;
  const OutlineEdges& edges = *scene.outline_edges();
  const EdgeSegment ray{Double3(origin), normalize(Double3(d)), double(kInfinity)};
  return edges.passes_within(kMost, ray, edges.wavelength(max_component(w.nm)));
}

bool diffract_connection(const Scene& scene, TestSegment& c, bool is_open, const Wavelengths& w) {
  EdgeSegment segment{Double3(c.origin), normalize(Double3(c.d)), kInfinity};
  if (!c.infinite) {
    const Double3 along = Double3(c.target) - segment.from;
    segment.length = length(along);
    segment.d = along * (1 / segment.length);
  }
  // A march through null surfaces has moved the origin of the ray.
  const float part = 1e-5f * (c.infinite ? 1 : float(segment.length));
  const Vec3 begin = scene.has_binary_visibility() ? c.ray.o : c.origin + c.d * part;
  const Spectrum passed = is_open ? c.passage : Spectrum(0.f);
  const bool is_blocked = max_component(passed - c.clear_passage * TestSegment::kOpaque) < 0;
  const Spectrum u2 = factor(scene, segment, begin, c.infinite ? c.d : c.target, !is_blocked, w);
  if (!is_blocked) {
    c.passage *= u2;
    return true;
  }
  // A connection that has crossed too many surfaces carries no light.
  if ((!is_open && is_black(u2)) || c.crossings_left < 0) return false;
  c.passage = passed + c.clear_passage * u2 * (sum(c.own + c.other) / sum(c.own));
  return true;
}

}  // namespace aureole
