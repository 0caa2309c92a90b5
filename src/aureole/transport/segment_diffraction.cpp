// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/segment_diffraction.h"

#include <array>
#include <complex>
#include <optional>

#include "aureole/scene/edge/outline_edges.h"

namespace aureole {

namespace {

/// Whether the way from `from` to shortly before `to` is free but for null surfaces.
bool is_free(const Scene& scene, const Vec3& from, const Vec3& to, bool infinite, const Wavelengths& w) {
  // The end lies on a surface: the test ends before it, by more than the rounding of its coordinates.
  constexpr float kPart = 0.9999f;
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
  test.passage = 1.f;
  return is_visible(scene, test, w) && !is_black(test.passage);
}

/// An edge beside the segment.
struct SeenPassage {
  EdgePassage passage;
  /// Whether the segment was taken to pass on its open side when its wave was subtracted from the field; empty: it was not.
  std::optional<bool> subtracted{};
};

/// The edges beside a segment, of which pairs may act together.
class Passages {
public:
  void add(const SeenPassage& seen) {
    if (count_ < kMost) seen_[count_++] = seen;
  }
  /// Calls use(first, second) for all pairs, in the order along the segment. Pairs among kMost and more edges are left out,
  /// as in a disc's rim, whose edges do not lie behind one another.
  template <class Use>
  void for_pairs(const EdgeSegment& segment, const Use& use) const {
    if (count_ == kMost) return;
    const auto depth = [&](const SeenPassage& s) { return dot(s.passage.p, segment.d); };
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t k = i + 1; k < count_; ++k) {
        const bool in_order = depth(seen_[i]) <= depth(seen_[k]);
        use(seen_[in_order ? i : k], seen_[in_order ? k : i]);
      }
  }

private:
  static constexpr std::size_t kMost = 32;
  std::size_t count_ = 0;
  std::array<SeenPassage, kMost> seen_;
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
        seen.subtracted = side.is_at_border ? is_open : side.is_open;
        edges.subtract(passage, segment, *seen.subtracted, wavelengths.data(), count, field.data());
      }
    }
    passages.add(seen);
  });
  passages.for_pairs(segment, [&](const SeenPassage& first, const SeenPassage& second) {
    EdgePairField pair;
    if (!edges.find_pair(first.passage, second.passage, segment, pair)) return;
    // Where rays do not agree with half planes, the edges do not act together, or others do, too.
    if (!pair.agrees(first.subtracted.has_value(), second.subtracted.has_value())) return;
    if (!sees(pair.side1, true) || !sees(pair.side2, false) ||
        !is_free(scene, pair.side1.beside.to_float(), pair.side2.beside.to_float(), false, w))
      return;
    any = true;
    edges.add_pair(pair, is_open, first.subtracted, second.subtracted, wavelengths.data(), count,
                   field.data());
  });
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
  return factor(scene, segment, origin + d * (1e-4f * (infinite ? 1 : length)),
                infinite ? d : origin + d * length, is_open, w);
}

bool diffract_connection(const Scene& scene, TestSegment& c, bool is_open, const Spectrum& passage_if_blocked,
                         const Wavelengths& w) {
  EdgeSegment segment{Double3(c.origin), normalize(Double3(c.d)), kInfinity};
  if (!c.infinite) {
    const Double3 along = Double3(c.target) - segment.from;
    segment.length = length(along);
    segment.d = along * (1 / segment.length);
  }
  // A march through null surfaces has moved the origin of the ray.
  const float part = 1e-4f * (c.infinite ? 1 : float(segment.length));
  const Vec3 begin = scene.has_binary_visibility() ? c.ray.o : c.origin + c.d * part;
  const Spectrum u2 = factor(scene, segment, begin, c.infinite ? c.d : c.target, is_open, w);
  if (is_open) {
    c.passage *= u2;
    return true;
  }
  if (is_black(u2)) return false;
  c.passage = passage_if_blocked * u2 * (sum(c.own + c.other) / sum(c.own));
  return true;
}

}  // namespace aureole
