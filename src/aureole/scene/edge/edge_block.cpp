// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/edge_block.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "aureole/optics/diffraction/uniform_theory.h"
#include "aureole/optics/faddeeva.h"

namespace aureole {

namespace {

/// Angle from a face up to which light counts as running along it: edges of thin blocks far from the origin have
/// rounded coordinates.
constexpr double kAlongFace = 0.02;

/// Returns the height of a segment above a point `p` relative to its begin, along `normal`.
double height_above(const EdgeSegment& segment, const Double3& p, const Double3& normal) {
  return dot(segment.d * dot(p, segment.d) - p, normal);
}

/// Returns the half planes that two edges are for a segment. `opens_below`: whether the open side of each is the
/// one opposite to `normal`.
HalfPlanes half_planes(const EdgeSegment& segment, const std::array<const MeshEdge*, 2>& edges,
                       const std::array<Double3, 2>& points, const Double3& normal,
                       const std::array<bool, 2>& opens_below) {
  HalfPlanes result;
  for (std::size_t i = 0; i < 2; ++i) {
    const DetourLine line(*edges[i], segment);
    result.v[i] = line.parameter(line.middle());
    result.turn[i] = line.obliquity(line.middle());
    const double height = height_above(segment, points[i] - segment.from, normal);
    result.is_open[i] = (height > 0) != opens_below[i];
  }
  return result;
}

}  // namespace

std::complex<double> HalfPlanes::waves(double wavelength) const {
  const double scale = 1 / std::sqrt(wavelength);
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const double past = w[1 - i];
    const std::complex<double> wave = (past >= 0 ? turn[i] : turns) *
                                      optics::wave_past_edge(v[i] * scale, past * scale) *
                                      optics::knife_edge_field(-v[i] * scale);
    sum += is_open[i] ? -wave : wave;
  }
  return sum;
}

EdgeBlock::EdgeBlock(const OutlineEdges& edges, const EdgePassage& first, const EdgePassage& second,
                     const EdgeSegment& segment, bool is_open) {
  const Double3 between = second.p - first.p;
  const double distance = length(between);
  if (!(distance > 0)) return;
  const Double3 along = between * (1 / distance);
  const bool is_infinite = segment.is_infinite();
  const auto to_end = [&](const Double3& p) {
    return is_infinite ? double(kInfinity) : length(segment.d * segment.length - p);
  };
  const double s1 = length(first.p), s2 = to_end(second.p);
  if (!edges.find_wedge(*first.edge, {first.in, along, s1, distance, kAlongFace}, wedges_[0]) ||
      !edges.find_wedge(*second.edge, {along, second.out, distance, s2, kAlongFace}, wedges_[1]))
    return;
  const auto is_along = [](double phi, double n) {
    return phi < kAlongFace || phi > n * std::numbers::pi - kAlongFace;
  };
  kind_ = Kind::apart;
  if (!is_along(wedges_[0].phi, wedges_[0].n) || !is_along(wedges_[1].phi_i, wedges_[1].n)) return;
  const bool is_reversed[] = {!(wedges_[0].phi < kAlongFace), !(wedges_[1].phi_i < kAlongFace)};
  const auto oriented = [&](const EdgeWedge& wedge, int i) {
    return is_reversed[i] ? wedge.reversed() : wedge;
  };
  for (int i = 0; i < 2; ++i) wedges_[std::size_t(i)] = oriented(wedges_[std::size_t(i)], i);
  const Double3 normal = wedges_[0].normal_o;
  // Light between two bodies may run along a face of each, which are two faces.
  constexpr double kEqual = 1e-3;
  if (length(normal - wedges_[1].normal_o) > kEqual) return;

  const double height_begin = -dot(first.p, normal);
  const double height_end =
      is_infinite ? dot(segment.d, normal) : dot(segment.d * segment.length - first.p, normal);
  // An end in the plane of the face, or just behind it, is moved away from the plane, unless the segment would become
  // occluded by that: near the plane, the waves of direct light and of the image cancel, and the coefficients over those of half planes
  // diverge.
  constexpr double kBehind = 5e-3;  // largest angle from the plane
  const double reach_end = is_infinite ? 1 : s2;
  const auto shift = [&](double height, double reach, double other, double other_reach) {
    const double angle = is_open ? std::clamp(other / (1.45 * other_reach), 0.0, kBehind) : kBehind;
    return height <= 0 && height > -angle * reach ? -1.01 * angle * reach - height : 0.0;
  };
  const double shift_begin = shift(height_begin, s1, height_end, reach_end),
               shift_end = shift(height_end, reach_end, height_begin, s1);
  if (shift_begin != 0 || shift_end != 0) {
    EdgeSegment moved = segment;
    moved.from = segment.from + normal * shift_begin;
    Double3 line = segment.d + normal * shift_end;
    if (!is_infinite) {
      line = segment.d * segment.length + normal * (shift_end - shift_begin);
      moved.length = length(line);
    }
    moved.d = normalize(line);
    EdgePassage from = first, to = second;
    from.p = first.p - normal * shift_begin, to.p = second.p - normal * shift_begin;
    from.in = normalize(from.p), to.out = is_infinite ? moved.d : normalize(line - to.p);
    *this = EdgeBlock(edges, from, to, moved, is_open);
    return;
  }
  if (height_begin > 0 && height_end > 0) {
    kind_ = Kind::none;
    return;
  }
  kind_ = Kind::face;
  // Wedges of single edges for light whose end is visible from the edge beyond the other one.
  if (height_end > 0) {
    EdgeWedge alone;
    if (edges.find_wedge(*first.edge, {first.in, first.out, s1, to_end(first.p), kAlongFace}, alone))
      wedges_[0] = oriented(alone, 0);
  } else {
    wedges_[0].phi = 0;
  }
  if (height_begin > 0) {
    EdgeWedge alone;
    if (edges.find_wedge(*second.edge, {second.in, second.out, length(second.p), s2, kAlongFace}, alone))
      wedges_[1] = oriented(alone, 1);
  } else {
    wedges_[1].phi_i = 0;
  }
  const auto joint_distance = [&](const EdgeWedge& wedge, const Double3& p) {
    const double in = length(p), out = to_end(p);
    return wedge.sin_beta * wedge.sin_beta * (is_infinite ? in : in * out / (in + out));
  };
  wedges_[0].distance = joint_distance(wedges_[0], first.p);
  wedges_[1].distance = joint_distance(wedges_[1], second.p);

  const std::array<const MeshEdge*, 2> both{first.edge, second.edge};
  const std::array<Double3, 2> points{segment.from + first.p, segment.from + second.p};
  direct_ = half_planes(segment, both, points, normal, {false, false});
  if (is_open) {
    direct_.is_open = {true, true};
  } else if (direct_.is_open[0] && direct_.is_open[1]) {
    // The segment is occluded: it passes within rounding errors of the nearer edge.
    direct_.is_open[direct_.v[0] < direct_.v[1] ? 0 : 1] = false;
  }
  const EdgeSegment to_second{segment.from, second.in, length(second.p)};
  const EdgeSegment from_first{points[0], first.out, to_end(first.p)};
  const DetourLine before(*first.edge, to_second), behind(*second.edge, from_first);
  direct_.w = {std::copysign(before.parameter(before.middle()), height_begin),
               std::copysign(behind.parameter(behind.middle()), height_end)};
  direct_.turns = obliquity_of_turn(first.in, along) * obliquity_of_turn(along, second.out);

  // The image of the end behind the plane of the face; the edge nearer to it is open on the other side.
  const bool is_begin = !(height_begin > 0);
  EdgeSegment mirrored = segment;
  if (is_begin) mirrored.from = segment.from - normal * (2 * height_begin);
  if (is_infinite) {
    if (!is_begin) mirrored.d = segment.d - normal * (2 * height_end);
    extra_ = 2 * height_begin * height_end;
  } else {
    Double3 end = segment.from + segment.d * segment.length;
    if (!is_begin) end = end - normal * (2 * height_end);
    const Double3 line = end - mirrored.from;
    mirrored.length = length(line);
    if (!(mirrored.length > 0)) return;
    mirrored.d = line * (1 / mirrored.length);
    extra_ = 4 * height_begin * height_end / (mirrored.length + segment.length);
    amplitude_ = segment.length / mirrored.length;
  }
  image_ = half_planes(mirrored, both, points, normal, {is_begin, !is_begin});
  image_.w = direct_.w, image_.turns = direct_.turns;
}

std::complex<double> EdgeBlock::over_half_planes(double wavelength, std::complex<double> face) const {
  const double k = 2 * std::numbers::pi / wavelength;
  std::complex<double> result = 1;
  for (const EdgeWedge& wedge : wedges_)
    result *=
        optics::Wedge(wedge.n).over_half_plane_and_image(k * wedge.distance, wedge.phi, wedge.phi_i, face);
  const std::complex<double> direct = direct_.waves(wavelength);
  const std::complex<double> image = image_.waves(wavelength) * std::polar(amplitude_, k * extra_);
  // Waves of an edge beyond the window are too weak to be divided by.
  constexpr double kLeast = 1e-12;
  if (std::abs(direct) < kLeast) return result;
  const std::complex<double> both = result * (direct + face * image);
  // The waves of a mirror's face are at most twice those at the boundary of a shadow, 1/2 of the light.
  return both / direct / std::max(1.0, std::abs(both));
}

}  // namespace aureole
