// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/outline_edges.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "aureole/optics/diffraction/boundary_wave.h"
#include "aureole/scene/edge/diffracting_shapes.h"

namespace aureole {

namespace {

using optics::PlanePoint;

/// An edge as a line x = a + t e, with what a segment's detours depend on.
struct Line {
  Line(const MeshEdge& edge, const EdgeSegment& s) : segment(s), a(edge.a) {
    const Double3 along = Double3(edge.b) - a;
    length = aureole::length(along);
    e = along * (1 / length);
    to_a = a - s.from;
  }
  bool is_infinite() const { return std::isinf(segment.length); }
  Double3 at(double t) const { return to_a + e * t; }  ///< from the segment's begin

  /// The factor f of the Fresnel plane: a point at `p` from the segment's begin and `across` it is shown at f times
  /// `across`, which has the length sqrt(4 delta).
  double scale(const Double3& p) const {
    const double z1 = dot(p, segment.d), r = aureole::length(p);
    double sum = 1 / (r + z1);
    if (!is_infinite()) {
      const double z2 = segment.length - z1;
      sum += 1 / (aureole::length(p - segment.d * segment.length) + z2);
    }
    return 2 * std::sqrt(sum);
  }
  double detour(double t) const {
    const Double3 p = at(t), across = p - segment.d * dot(p, segment.d);
    const double f = scale(p);
    return f * f * dot(across, across) / 4;
  }
  /// Unit directions of light to the point `p` and on from it.
  void directions(const Double3& p, Double3& in, Double3& out) const {
    in = normalize(p);
    out = is_infinite() ? segment.d : normalize(segment.d * segment.length - p);
  }
  double obliquity(double t) const {
    const Double3 p = at(t);
    Double3 in, out;
    directions(p, in, out);
    return std::sqrt(std::max(0.0, (1 + dot(in, out)) / 2));
  }

  /// Where the detour is smallest: at Keller's point, by unfolding about the line.
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
  /// The part of the line whose detours are at most that: the line in an ellipsoid or paraboloid of revolution. False
  /// where there is none.
  bool clip(double most, double& begin, double& end) const {
    double g0, g1;  // the distance from the segment's begin is g0 + g1 t on its surface
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
  Double3 a, e, to_a;
  double length;
};

Double3 face_direction(const Double3& normal, const Double3& e) { return cross(normal, e); }

/// Whether `p`, from the segment's begin, lies on the face of an edge: such a face does not shadow it.
bool lies_on_face(const Double3& from_edge, const Double3& normal, const Double3& into_face,
                  double rounding) {
  return std::abs(dot(from_edge, normal)) <= rounding && dot(from_edge, into_face) > 0;
}

/// Adds the boundary wave of a part of an edge, as chords of its curve in the Fresnel plane.
class Chords {
public:
  Chords(const Line& line, double middle, const double* wavelengths, int count, double window, double sign,
         std::complex<double>* field)
      : line_(line),
        middle_(middle),
        wavelengths_(wavelengths),
        count_(count),
        window_(window),
        sign_(sign),
        field_(field) {
    make_basis(line.segment.d, x_, y_);
    shortest_ = *std::min_element(wavelengths, wavelengths + count);
  }
  void add(double begin, double end) { add(begin, shown(begin), end, shown(end), 0); }

private:
  PlanePoint shown(double t) const {
    const Double3 p = line_.at(t);
    const double f = line_.scale(p);
    return {f * dot(p, x_), f * dot(p, y_)};
  }
  void add(double begin, PlanePoint a, double end, PlanePoint b, int depth) {
    constexpr int kMostDepth = 6;
    constexpr double kPhase = 0.02;
    if (depth < kMostDepth) {
      const double half = 0.5 * (begin + end);
      const PlanePoint m = shown(half);
      const double x = b.x - a.x, y = b.y - a.y, size = std::hypot(x, y);
      const double off = size > 0 ? std::abs((m.x - a.x) * y - (m.y - a.y) * x) / size : 0;
      // A detour d has the phase 2 pi d/lambda = pi P^2/(2 lambda).
      if (std::numbers::pi * off * std::hypot(m.x, m.y) > kPhase * shortest_) {
        add(begin, a, half, m, depth + 1);
        add(half, m, end, b, depth + 1);
        return;
      }
    }
    const optics::BoundaryPiece piece(
        a, b,
        {line_.obliquity(begin), line_.obliquity(end), line_.obliquity(std::clamp(middle_, begin, end))});
    piece.add(-sign_, {wavelengths_, std::size_t(count_)}, window_, field_);
  }

  const Line& line_;
  double middle_;
  const double* wavelengths_;
  int count_;
  double window_, sign_, shortest_;
  std::complex<double>* field_;
  Double3 x_, y_;
};

}  // namespace

OutlineEdges::OutlineEdges(const SceneParts& parts) : nm_(1e-9 / parts.context->length_unit_m) {
  const DiffractingShapes shapes(parts);
  edges_ = find_mesh_edges(shapes.sets);
  lift_ = shapes.lift;
  notes_ = shapes.remarks;
  std::vector<Bounds3> boxes;
  for (const MeshEdge& edge : edges_) {
    Bounds3& box = boxes.emplace_back();
    box.extend(edge.a), box.extend(edge.b);
    box_.extend(edge.a), box_.extend(edge.b);
  }
  tree_ = BeamTree(boxes);
  constexpr std::size_t kMany = 4096;
  if (edges_.size() > kMany) {
    window_ = 15;
    notes_.push_back(
        "diffraction: the scene has " + std::to_string(edges_.size()) +
        " edges, so that an edge counts up to the Fresnel parameter 15 only, where it sends 36 dB less "
        "than the unobstructed light");
  }
  if (edges_.empty())
    notes_.push_back("no shape of the scene has edges that diffract: no light is diffracted");
  if (std::any_of(shapes.scale.begin(), shapes.scale.end(), [](float s) { return s != 1; }))
    notes_.push_back(
        "\"scale\" of \"freespacediffraction\" has no effect with the diffraction model \"segments\"");
}

bool has_same_outlines(const SceneParts& a, const SceneParts& b) {
  return std::equal(a.surfaces.begin(), a.surfaces.end(), b.surfaces.begin(), b.surfaces.end(),
                    [](const Primitive& x, const Primitive& y) {
                      return x.shape == y.shape && x.bsdf == y.bsdf && x.instance == y.instance &&
                             x.emitter == y.emitter;
                    });
}

Beam OutlineEdges::beam_of(const EdgeSegment& s, double detour) const {
  double length = s.length;
  double radius2 = detour * detour;
  if (std::isinf(length)) {
    // To the far side of all edges, where the paraboloid is widest.
    length =
        aureole::length(Double3(box_.center()) - s.from) + 0.5 * double(aureole::length(box_.diagonal()));
    radius2 += 2 * length * detour;
  } else {
    radius2 = (radius2 + 2 * length * detour) / 4;
  }
  return {s.from.to_float(), s.d.to_float(), float(std::sqrt(radius2)), float(-detour / 2),
          float(length + detour / 2)};
}

bool OutlineEdges::find_passage(const MeshEdge& edge, const EdgeSegment& segment, double detour,
                                EdgePassage& out) const {
  const Line line(edge, segment);
  out.edge = &edge;
  if (!line.clip(detour, out.begin, out.end)) return false;
  out.middle = line.middle();
  // A corner is judged a little way from its end, which the next edge shares.
  const double margin = 0.01 * (out.end - out.begin);
  const double t = std::clamp(out.middle, out.begin + margin, out.end - margin);
  const Double3 p = line.at(t);
  Double3 in, on;
  line.directions(p, in, on);
  const Double3 through = in + on;
  if (!edge.is_outline(through.to_float())) return false;

  const Double3 n0(edge.n0), n1(edge.n1);
  const Double3 face0 = face_direction(n0, line.e), face1 = face_direction(line.e, n1);
  const double size = std::max(length(p), max_component(abs(edge.a)) + double(max_component(abs(edge.b))));
  const double rounding = 2e-6 * size;
  const Double3 begin = -p;  // the segment's ends, from the edge
  const auto shadows = [&](const Double3& normal, const Double3& face) {
    if (lies_on_face(begin, normal, face, rounding)) return false;
    return line.is_infinite() || !lies_on_face(begin + segment.d * segment.length, normal, face, rounding);
  };
  if (!shadows(n0, face0) || (!edge.is_boundary && !shadows(n1, face1))) return false;

  // The plane of the edge and of the light's mean direction parts the open side from that of the faces.
  Double3 normal = cross(line.e, through);
  const double normal_length = length(normal);
  if (!(normal_length > 1e-9)) return false;
  normal = normal * (1 / normal_length);
  const double side0 = dot(face0, normal), side1 = edge.is_boundary ? 0 : dot(face1, normal);
  const double of_faces = std::abs(side0) >= std::abs(side1) ? side0 : side1;
  if (of_faces > 0) normal = -normal;  // towards the open side
  const double height = dot(begin, normal);
  out.is_open = height > 0;
  out.is_at_border = std::abs(height) <= rounding;
  out.beside = segment.from + p + normal * (2 * rounding + 1.01 * double(lift_[edge.face0.set]));
  return true;
}

void OutlineEdges::subtract(const EdgePassage& passage, const EdgeSegment& segment, bool is_open,
                            const double* wavelengths, int count, std::complex<double>* field) const {
  const Line line(*passage.edge, segment);
  Chords(line, passage.middle, wavelengths, count, window_, is_open ? 1 : -1, field)
      .add(passage.begin, passage.end);
}

}  // namespace aureole
