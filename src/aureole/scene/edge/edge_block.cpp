// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/edge_block.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "aureole/optics/diffraction/uniform_theory.h"
#include "aureole/optics/faddeeva.h"

namespace aureole {

namespace {

constexpr double kAlongFace = OutlineEdges::kAlongFace;

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

std::array<std::complex<double>, 2> HalfPlanes::waves(double wavelength) const {
  const double scale = 1 / std::sqrt(wavelength);
  std::array<std::complex<double>, 2> result;
  for (std::size_t i = 0; i < 2; ++i) {
    const double past = w[1 - i];
    const std::complex<double> wave = (past >= 0 ? turn[i] : turns) *
                                      optics::wave_past_edge(v[i] * scale, past * scale) *
                                      optics::knife_edge_field(-v[i] * scale);
    result[i] = is_open[i] ? -wave : wave;
  }
  return result;
}

EdgeBlock::EdgeBlock(const OutlineEdges& edges, const EdgePassage& first, const EdgePassage& second,
                     const EdgeSegment& segment, bool is_open, bool is_in_plane) {
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
  // An end in the plane of the face counts as just above or just behind it: parameters of both edges vanish there, and
  // only their ratio matters.
  constexpr double kInPlane = 1e-6;  // angle from the plane
  const double reach_end = is_infinite ? 1 : s2;
  const auto shift = [&](double height, double reach) {
    const double least = kInPlane * reach;
    return is_in_plane || std::abs(height) < least ? (is_open ? 2 : -2) * least - height : 0.0;
  };
  const double shift_begin = shift(height_begin, s1), shift_end = shift(height_end, reach_end);
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
    from.in = normalize(from.p), to.in = normalize(to.p);
    from.out = is_infinite ? moved.d : normalize(line - from.p);
    to.out = is_infinite ? moved.d : normalize(line - to.p);
    *this = EdgeBlock(edges, from, to, moved, is_open, false);
    return;
  }
  kind_ = Kind::face;
  is_above_ = height_begin > 0 && height_end > 0;
  // Angle about an edge from the common face to a direction away from the edge. `inwards` lies in the face and
  // points to the other edge.
  const auto angle = [&](const Double3& d, const Double3& inwards) {
    return std::atan2(dot(d, normal), dot(d, inwards));
  };
  const auto inwards = [&](const MeshEdge& edge, double sign) {
    const Double3 e = normalize(Double3(edge.b) - Double3(edge.a));
    return normalize(along - e * dot(along, e) - normal * dot(along, normal)) * sign;
  };
  const Double3 inwards1 = inwards(*first.edge, 1), inwards2 = inwards(*second.edge, -1);
  alone_[0].angle_near = wedges_[0].phi_i, alone_[0].angle_far = angle(first.out, inwards1);
  alone_[1].angle_near = wedges_[1].phi, alone_[1].angle_far = angle(-second.in, inwards2);
  alone_[0].turn = obliquity_of_turn(along, second.out), alone_[1].turn = obliquity_of_turn(first.in, along);
  const double rest[] = {s2, s1};
  for (std::size_t i = 0; i < 2; ++i) {
    const double inverse = 1 / distance + (rest[i] < double(kInfinity) ? 1 / rest[i] : 0);
    alone_[i].slope = 1 / (distance * wedges_[i].sin_beta * std::sqrt(2 * inverse));
  }
  // Far from the plane of the face, the product of both wedges' factors is exact at larger angles. It diverges for hard
  // waves in the plane, where those of segment and image cancel.
  if (!is_above_) {
    constexpr double kNear = 0.1, kFar = 0.25;  // angles from the plane
    const double nearest = std::min(std::abs(height_begin) / s1, std::abs(height_end) / reach_end);
    product_ = optics::smooth_step((std::asin(std::min(1.0, nearest)) - kNear) / (kFar - kNear));
  }
  wedges_[0].phi = std::max(0.0, alone_[0].angle_far), wedges_[1].phi_i = std::max(0.0, alone_[1].angle_far);
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
  } else if (direct_.is_open[0] && direct_.is_open[1] && !is_above_) {
    // The segment is occluded: it passes within rounding errors of the nearer edge.
    direct_.is_open[direct_.v[0] < direct_.v[1] ? 0 : 1] = false;
  }
  const EdgeSegment to_second{segment.from, second.in, length(second.p)};
  const EdgeSegment from_first{points[0], first.out, to_end(first.p)};
  const DetourLine before(*first.edge, to_second), behind(*second.edge, from_first);
  direct_.w = {std::copysign(before.parameter(before.middle()), height_begin),
               std::copysign(behind.parameter(behind.middle()), height_end)};
  direct_.turns = obliquity_of_turn(first.in, along) * obliquity_of_turn(along, second.out);

  // The segment from the image of its begin. The image of the first half plane has its open side below the plane.
  EdgeSegment mirrored = segment;
  mirrored.from = segment.from - normal * (2 * height_begin);
  if (is_infinite) {
    extra_ = 2 * height_begin * height_end;
  } else {
    const Double3 line = segment.from + segment.d * segment.length - mirrored.from;
    mirrored.length = length(line);
    if (!(mirrored.length > 0)) {
      kind_ = Kind::none;
      return;
    }
    mirrored.d = line * (1 / mirrored.length);
    extra_ = 4 * height_begin * height_end / (mirrored.length + segment.length);
    amplitude_ = segment.length / mirrored.length;
  }
  image_ = half_planes(mirrored, both, points, normal, {true, false});
  image_.w = direct_.w, image_.turns = direct_.turns;
}

std::complex<double> EdgeBlock::beyond(int edge, double wavelength, std::complex<double> image,
                                       std::complex<double> face) const {
  const auto i = std::size_t(edge);
  const EdgeAlone& alone = alone_[i];
  const double k_distance = 2 * std::numbers::pi / wavelength * wedges_[i].distance;
  const double scale = 1 / std::sqrt(wavelength);
  const double difference = alone.angle_near - alone.angle_far;
  const std::complex<double> half_plane = (difference > std::numbers::pi ? 1 : -1) * direct_.turn[i] *
                                          optics::knife_edge_field(-direct_.v[i] * scale);
  const std::complex<double> spreading = half_plane / optics::half_plane_terms(k_distance, difference);
  // The wave is even or odd about the plane of the face, or a sum of both: its angular dependence a + b phi passes the
  // other half plane as a Fresnel integral and, times b, as the integral of (angle times wave) above its edge.
  const optics::Wedge wedge(wedges_[i].n);
  const auto terms = [&](double angle_far) {
    return wedge.terms_beside_image(k_distance, angle_far, alone.angle_near, {image, face});
  };
  constexpr double kSmall = 1e-4;
  const std::complex<double> even = terms(0);
  const double slope_angle = std::max(kSmall, alone.angle_far);
  const std::complex<double> odd = (terms(slope_angle) - even) / slope_angle;
  const double w = direct_.w[1 - i] * scale;
  const std::complex<double> field = optics::knife_edge_field(w) * (w < 0 ? alone.turn : 1.0);
  const std::complex<double> angle =
      alone.angle_far * field + std::complex<double>(1, 1) / (2 * std::numbers::pi * scale) * alone.slope *
                                    std::polar(w < 0 ? alone.turn : 1.0, std::numbers::pi / 2 * w * w);
  return spreading * (even * field + odd * angle);
}

std::complex<double> EdgeBlock::over_half_planes(int part, double wavelength,
                                                 std::complex<double> face) const {
  const double k = 2 * std::numbers::pi / wavelength;
  const auto direct = direct_.waves(wavelength), image = image_.waves(wavelength);
  const double power = std::norm(direct[0]) + std::norm(direct[1]);
  // Waves of an edge beyond the window are too weak to be divided by.
  constexpr double kLeast = 1e-24;
  if (!(power > kLeast)) return 1;
  const std::complex<double> phase = std::polar(amplitude_, k * extra_);
  std::complex<double> reflected = image[0] + image[1];
  if (image_.is_open[0] && image_.is_open[1]) reflected += 1;
  // Light that a large face reflects to an end well above it is a path of its own, whose power is added: that part of
  // the image has no phase against direct light, and counts there.
  double weight = 1;
  if (is_above_) {
    constexpr double kTogether = 0.125, kApart = 0.5;  // detours of reflected light in wavelengths
    weight -= optics::smooth_step((extra_ / wavelength - kTogether) / (kApart - kTogether)) *
              std::min(1.0, std::norm(reflected));
  }
  std::complex<double> added = 0;
  if (product_ < 1) {
    added = (1 - product_) * (face * weight * phase * reflected + beyond(0, wavelength, face * weight, face) +
                              beyond(1, wavelength, face * weight, face));
  }
  if (product_ > 0) {
    std::complex<double> wedges = 1;
    for (const EdgeWedge& wedge : wedges_)
      wedges *=
          optics::Wedge(wedge.n).over_half_plane_and_image(k * wedge.distance, wedge.phi, wedge.phi_i, face);
    const std::complex<double> both = direct[0] + direct[1];
    added += product_ * (wedges * (both + face * phase * reflected) - both);
  }
  // The factors change the sum of both waves by `added`. In shadows they are equal, so that waves that cancel do so
  // even if they are not quite those of endless half planes. The waves of ends above the plane may cancel by
  // themselves: there the factors are the smallest ones, the less equal the less in phase the waves are.
  const std::complex<double> sum = direct[0] + direct[1];
  const double in_phase = std::norm(sum) / (2 * power);
  constexpr double kCancelled = 1e-3;
  if (!is_above_ && in_phase > kCancelled) return 1.0 + added / sum;
  return 1.0 + added / power * (0.5 * std::conj(sum) + (1 - in_phase) * std::conj(direct[std::size_t(part)]));
}

}  // namespace aureole
