// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/segment_diffraction.h"

#include <array>
#include <complex>

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
  const bool infinite = std::isinf(segment.length);
  edges.visit(segment, longest, [&](const EdgePassage& passage) {
    const Vec3 beside = passage.beside.to_float();
    if (!is_free(scene, beside, begin, false, w) || !is_free(scene, beside, end, infinite, w)) return;
    any = true;
    const bool passes_open = passage.is_at_border ? is_open : passage.is_open;
    edges.subtract(passage, segment, passes_open, wavelengths.data(), count, field.data());
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
  const bool infinite = std::isinf(length);
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
