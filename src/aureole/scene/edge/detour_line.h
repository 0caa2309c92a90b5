// SPDX-License-Identifier: Apache-2.0
// `DetourLine`: the straight line of an edge beside a segment of a path, and the detours of light by way of
// its points.
#pragma once

#include <algorithm>
#include <cmath>

#include "aureole/optics/diffraction/boundary_wave.h"
#include "aureole/scene/edge/mesh_edges.h"
#include "aureole/shape/geometry/double3.h"

namespace aureole {

/// A straight segment whose ends are vertices of a path, in either order.
struct EdgeSegment {
  Double3 from;
  Double3 d;      ///< unit length
  double length;  ///< kInfinity if one end is at infinity

  bool is_infinite() const { return length >= double(kInfinity); }
};

/// Returns the obliquity factor cos(theta/2) of light that turns from one unit direction to another.
inline double obliquity_of_turn(const Double3& in, const Double3& out) {
  return std::sqrt(std::max(0.0, (1 + dot(in, out)) / 2));
}

/// The line x = a + t e of an edge, and the detours of light by way of its points. The segment must outlive
/// this object.
struct DetourLine {
  DetourLine(const MeshEdge& edge, const EdgeSegment& s) : segment(s) {
    const Double3 a(edge.a);
    const Double3 along = Double3(edge.b) - a;
    length = aureole::length(along);
    e = along * (1 / length);
    to_a = a - s.from;
  }
  /// Makes the line of an edge beside another segment.
  DetourLine(const DetourLine& line, const EdgeSegment& s)
      : segment(s), e(line.e), to_a(line.to_a + (line.segment.from - s.from)), length(line.length) {}
  bool is_infinite() const { return segment.is_infinite(); }
  Double3 at(double t) const { return to_a + e * t; }  ///< relative to the segment's begin

  /// Returns the scale f of the Fresnel plane at `p`, a point relative to the segment's begin: the component
  /// of p perpendicular to the segment, times f, has the length sqrt(4 delta).
  double scale(const Double3& p) const {
    const double z1 = dot(p, segment.d), r = aureole::length(p);
    double sum = 1 / std::max(r + z1, 1e-30);
    if (!is_infinite()) {
      const double z2 = segment.length - z1;
      sum += 1 / (aureole::length(p - segment.d * segment.length) + z2);
    }
    return 2 * std::sqrt(sum);
  }
  /// Returns the point at `t` in the Fresnel plane of a unit wavelength; x and y are unit vectors
  /// perpendicular to the segment.
  optics::PlanePoint in_fresnel_plane(double t, const Double3& x, const Double3& y) const {
    const Double3 p = at(t);
    const double f = scale(p);
    return {f * dot(p, x), f * dot(p, y)};
  }
  /// Returns Fresnel's parameter |v| of the point at `t`, at a unit wavelength.
  double parameter(double t) const {
    const Double3 p = at(t);
    return scale(p) * aureole::length(p - segment.d * dot(p, segment.d));
  }
  /// Sets the unit directions of light that arrives at the point `p` and that leaves it.
  void directions(const Double3& p, Double3& in, Double3& out) const {
    in = normalize(p);
    out = is_infinite() ? segment.d : normalize(segment.d * segment.length - p);
  }
  double obliquity(double t) const {
    const Double3 p = at(t);
    Double3 in, out;
    directions(p, in, out);
    return obliquity_of_turn(in, out);
  }

  /// Returns the t of the smallest detour, Keller's point, by unfolding the two half-planes about the line.
  double middle() const {
    const double t_a = -dot(to_a, e), d_a = aureole::length(at(t_a));
    if (is_infinite()) {
      const double along = dot(segment.d, e);
      return t_a + d_a * along / std::sqrt(std::max(1e-30, 1 - along * along));
    }
    const double t_b = t_a + segment.length * dot(segment.d, e);
    const double d_b = aureole::length(at(t_b) - segment.d * segment.length);
    return d_a + d_b > 0 ? (t_a * d_b + t_b * d_a) / (d_a + d_b) : t_a;
  }
  /// Sets the part of the edge whose detours are at most `most`, which lies in an ellipsoid or paraboloid of
  /// revolution. Returns false if there is none.
  bool clip(double most, double& begin, double& end) const {
    double g0, g1;  // on its surface the distance from the segment's begin is g0 + g1 t
    if (is_infinite()) {
      g0 = most + dot(to_a, segment.d), g1 = dot(e, segment.d);
    } else {
      const double l = segment.length, sum = l + most;
      g0 = sum / 2 + (2 * l * dot(to_a, segment.d) - l * l) / (2 * sum), g1 = l / sum * dot(e, segment.d);
    }
    const double p = 1 - g1 * g1, q = dot(to_a, e) - g0 * g1, c = dot(to_a, to_a) - g0 * g0;
    const double root = q * q - p * c;
    if (!(p > 1e-12) || !(root > 0)) return false;
    begin = std::max(0.0, (-q - std::sqrt(root)) / p);
    end = std::min(length, (-q + std::sqrt(root)) / p);
    return begin < end;
  }

  const EdgeSegment& segment;
  Double3 e, to_a;
  double length;
};

}  // namespace aureole
