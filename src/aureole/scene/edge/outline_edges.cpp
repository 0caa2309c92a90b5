// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/outline_edges.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <unordered_map>

#include "aureole/core/random.h"
#include "aureole/optics/faddeeva.h"
#include "aureole/scene/edge/diffracting_shapes.h"

namespace aureole {

namespace {

using optics::PlanePoint;

Double3 face_direction(const Double3& normal, const Double3& e) { return cross(normal, e); }

/// Whether a point lies on a face of an edge, which then does not shadow it; `from_edge` is the vector from
/// the edge to the point.
bool lies_on_face(const Double3& from_edge, const Double3& normal, const Double3& into_face,
                  double rounding) {
  return std::abs(dot(from_edge, normal)) <= rounding && dot(from_edge, into_face) > 0;
}

/// Returns the error of a ray in single precision from the segment's begin, at a point of an edge; `p` is
/// that point, relative to the begin.
double rounding_of(const MeshEdge& edge, const EdgeSegment& segment, const Double3& p) {
  const auto largest = [](const Double3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  };
  return 2e-7 * (largest(segment.from) + length(p) +
                 double(std::max(max_component(abs(edge.a)), max_component(abs(edge.b)))));
}

/// Adds the boundary wave of a part of an edge, as chords of its curve in the Fresnel plane.
class Chords {
public:
  Chords(const DetourLine& line, double middle, const double* wavelengths, int count, double window,
         double sign, std::complex<double>* field)
      : line_(line),
        middle_(middle),
        wavelengths_(wavelengths),
        count_(count),
        window_(window),
        sign_(sign),
        field_(field) {
    make_basis(line.segment.d, x_, y_);
    shortest_ = *std::min_element(wavelengths, wavelengths + count);
    foot_ = shown(middle);
    foot2_ = square(foot_);
  }
  void add(double begin, double end) {
    // 1 - c = theta^2/8 is largest at an end.
    constexpr double kLittle = 1e-6;
    turns_little_ = std::min(line_.obliquity(begin), line_.obliquity(end)) > 1 - kLittle;
    add(begin, shown(begin), end, shown(end), 0);
  }

private:
  static double square(const PlanePoint& p) { return p.x * p.x + p.y * p.y; }
  /// Returns the distance of a point from the line through a and b.
  static double off_chord(const PlanePoint& p, const PlanePoint& a, const PlanePoint& b) {
    const double x = b.x - a.x, y = b.y - a.y, size = std::sqrt(x * x + y * y);
    return size > 0 ? std::abs((p.x - a.x) * y - (p.y - a.y) * x) / size : 0;
  }
  PlanePoint shown(double t) const { return line_.in_fresnel_plane(t, x_, y_); }
  optics::PieceObliquity obliquities(double begin, double end) const {
    if (turns_little_) return {};
    return {line_.obliquity(begin), line_.obliquity(end), line_.obliquity(std::clamp(middle_, begin, end))};
  }
  void add(double begin, PlanePoint a, double end, PlanePoint b, int depth) {
    constexpr int kMostDepth = 16;
    constexpr double kPhase = 0.02;
    if (depth < kMostDepth) {
      const double half = 0.5 * (begin + end);
      const PlanePoint m = shown(half);
      const bool has_foot = begin < middle_ && middle_ < end;
      // A detour delta has the phase 2 pi delta/lambda = pi v^2/(2 lambda), v being the length at a unit
      // wavelength. Far from the foot, where the phase changes much along a chord, its wave comes from its ends,
      // and an error of the phase changes that wave by four times its ratio to the change.
      const double near = std::min(square(a), square(b)), far = std::max(square(a), square(b));
      const double change =
          has_foot ? 0
                   : 0.5 * std::numbers::pi * std::max(0.0, std::min(far - near, near - foot2_)) / shortest_;
      constexpr double kOfChange = 0.1;
      const double tolerance = kPhase * (1 + kOfChange * change) * shortest_;
      const auto is_off = [&](const PlanePoint& p) {
        return std::numbers::pi * off_chord(p, a, b) * std::sqrt(square(p)) > tolerance;
      };
      // The wave of a chord that contains the foot also changes with its distance from the axis itself, which is v:
      // near v = 0, by 0.7 times the change of v. The curve may cross its chord at `half`, so that the foot is tested
      // as well.
      constexpr double kOfFoot = 0.005;
      const double off = has_foot ? std::max(off_chord(m, a, b), off_chord(foot_, a, b)) : 0;
      if (is_off(m) || (has_foot && (is_off(foot_) || off * off > kOfFoot * kOfFoot * shortest_))) {
        add(begin, a, half, m, depth + 1);
        add(half, m, end, b, depth + 1);
        return;
      }
    }
    const optics::BoundaryPiece piece(a, b, obliquities(begin, end));
    piece.add(-sign_, {wavelengths_, std::size_t(count_)}, window_, field_);
  }

  const DetourLine& line_;
  double middle_;
  const double* wavelengths_;
  int count_;
  double window_, sign_, shortest_;
  PlanePoint foot_;  ///< of the whole line in the Fresnel plane
  double foot2_;     ///< its squared distance from the origin
  bool turns_little_ = false;
  std::complex<double>* field_;
  Double3 x_, y_;
};

/// Moves each vertex to the first one within `distance`, so that surfaces that nearly touch share vertices.
class Welder {
public:
  explicit Welder(float distance) : distance_(distance) {}
  Vec3 welded(const Vec3& p) {
    const auto cell = [&](float x) { return std::int64_t(std::floor(double(x) / double(distance_))); };
    const std::int64_t x = cell(p.x), y = cell(p.y), z = cell(p.z);
    for (std::int64_t i = -1; i <= 1; ++i)
      for (std::int64_t j = -1; j <= 1; ++j)
        for (std::int64_t k = -1; k <= 1; ++k)
          if (const auto found = first_.find(key(x + i, y + j, z + k)); found != first_.end())
            if (length_squared(found->second - p) <= distance_ * distance_) return found->second;
    return first_.try_emplace(key(x, y, z), p).first->second;
  }

private:
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    return combine_bits(combine_bits(std::uint64_t(x), std::uint64_t(y)), std::uint64_t(z));
  }
  float distance_;
  std::unordered_map<std::uint64_t, Vec3> first_;  ///< first vertex of each cell
};

/// Returns the positions of each set, with vertices welded within `distance`.
std::vector<std::vector<Vec3>> welded_positions(std::span<const TriangleSet> sets, float distance) {
  Welder welder(distance);
  std::vector<std::vector<Vec3>> welded;
  for (const TriangleSet& set : sets) {
    auto& positions = welded.emplace_back();
    for (const Vec3& p : set.positions) positions.push_back(welder.welded(p));
  }
  return welded;
}

/// Turns around the borders of sheets so that their normals lie in one half of space: faces that are wound in opposite
/// senses then have borders that continue each other. A border has its face on the same side in both directions.
void orient_borders(std::vector<MeshEdge>& edges) {
  for (MeshEdge& edge : edges) {
    if (!edge.is_boundary || dot(edge.n0, Vec3{1, 0.7f, 0.3f}) >= 0) continue;
    std::swap(edge.a, edge.b);
    edge.n0 = -edge.n0;
  }
}

/// Removes folds inside faces that lie in one plane within `distance`, such as the diagonals of a thin wall whose corners
/// are rounded: light along the wall would be diffracted by the diagonal as well as by the wall's edges. Folds of
/// finely divided round surfaces stay, since all faces that are joined by such folds must lie in the plane.
void remove_flat_folds(std::vector<MeshEdge>& edges, std::span<const TriangleSet> sets, double distance) {
  constexpr float kLeastCosine = 0.995f;
  const auto corner = [&](MeshFace face, std::size_t i) {
    const TriangleSet& set = sets[face.set];
    return Double3(set.positions[set.triangles[face.triangle][i]]);
  };
  const auto lies_in = [&](MeshFace face, const Double3& p, const Double3& normal) {
    for (std::size_t i = 0; i < 3; ++i)
      if (std::abs(dot(corner(face, i) - p, normal)) > distance) return false;
    return true;
  };
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;
  std::vector<MeshFace> faces;
  std::vector<std::uint32_t> group;  // of each face: a face nearer to the root of its group
  const auto number = [&](MeshFace face) {
    const auto [found, is_new] =
        numbers.try_emplace(std::uint64_t(face.set) << 32 | face.triangle, std::uint32_t(faces.size()));
    if (is_new) faces.push_back(face), group.push_back(found->second);
    return found->second;
  };
  const auto root = [&](std::uint32_t i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  std::vector<std::pair<std::size_t, std::uint32_t>> folds;  // edges, and one face of each
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const MeshEdge& edge = edges[i];
    const Double3 a(edge.a);
    if (edge.is_boundary || dot(edge.n0, edge.n1) < kLeastCosine ||
        !lies_in(edge.face1, a, Double3(edge.n0)) || !lies_in(edge.face0, a, Double3(edge.n1)))
      continue;
    const std::uint32_t first = number(edge.face0), second = number(edge.face1);
    group[root(first)] = root(second);
    folds.emplace_back(i, first);
  }
  if (folds.empty()) return;
  // The plane of a group is that of its largest face.
  std::vector<Double3> normals(faces.size()), points(faces.size());
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    const Double3 a = corner(faces[i], 0), n = cross(corner(faces[i], 1) - a, corner(faces[i], 2) - a);
    const std::uint32_t to = root(i);
    if (length(n) > length(normals[to])) normals[to] = n, points[to] = a;
  }
  std::vector<bool> is_flat(faces.size(), true);
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    const std::uint32_t to = root(i);
    is_flat[to] = is_flat[to] && lies_in(faces[i], points[to], normalize(normals[to]));
  }
  std::vector<bool> is_removed(edges.size());
  for (const auto& [edge, face] : folds) is_removed[edge] = is_flat[root(face)];
  std::size_t count = 0;
  for (std::size_t i = 0; i < edges.size(); ++i)
    if (!is_removed[i]) edges[count++] = edges[i];
  edges.resize(count);
}

/// Joins edges that continue each other straight between equal faces, so that the subdivision of a mesh has
/// no effect. `sheet` is the number of the plane of each set of triangles; vertices may lie `distance` off a
/// line.
std::vector<MeshEdge> joined(const std::vector<MeshEdge>& edges, std::span<const std::uint32_t> sheet,
                             std::uint32_t no_sheet, float distance) {
  struct Ends {
    std::uint32_t edge[2] = {};
    int count = 0;
  };
  const auto key = [](const Vec3& p) {
    // Adding 0 turns -0 into 0.
    return combine_bits(
        combine_bits(std::bit_cast<std::uint32_t>(p.x + 0.f), std::bit_cast<std::uint32_t>(p.y + 0.f)),
        std::bit_cast<std::uint32_t>(p.z + 0.f));
  };
  std::unordered_map<std::uint64_t, Ends> at;
  for (std::uint32_t i = 0; i < edges.size(); ++i)
    for (const Vec3& p : {edges[i].a, edges[i].b}) {
      Ends& ends = at[key(p)];
      if (ends.count < 2) ends.edge[ends.count] = i;
      ++ends.count;
    }
  const auto is_sheet_of_both = [&](const MeshEdge& a, const MeshEdge& b) {
    return a.face0.set == b.face0.set ||
           (sheet[a.face0.set] != no_sheet && sheet[a.face0.set] == sheet[b.face0.set]);
  };
  // Returns the edge that continues another one from its end, or nothing.
  const auto next_of = [&](std::uint32_t i) -> std::optional<std::uint32_t> {
    const Ends& ends = at[key(edges[i].b)];
    if (ends.count != 2) return {};
    const std::uint32_t k = ends.edge[ends.edge[0] == i ? 1 : 0];
    const MeshEdge &a = edges[i], &b = edges[k];
    if (k == i || !(b.a == a.b) || a.is_boundary != b.is_boundary || a.is_concave != b.is_concave) return {};
    constexpr double kBend = 1e-3;  // radians
    const Double3 u = normalize(Double3(a.b) - Double3(a.a)), v = normalize(Double3(b.b) - Double3(b.a));
    const auto equal = [](const Vec3& x, const Vec3& y) { return length_squared(x - y) < 1e-6f; };
    if (!(length(cross(u, v)) < kBend) || !(dot(u, v) > 0) || !equal(a.n0, b.n0) || !equal(a.n1, b.n1) ||
        !is_sheet_of_both(a, b))
      return {};
    return k;
  };
  std::vector<std::optional<std::uint32_t>> next(edges.size());
  std::vector<bool> has_before(edges.size());
  for (std::uint32_t i = 0; i < edges.size(); ++i)
    if ((next[i] = next_of(i))) has_before[*next[i]] = true;
  std::vector<MeshEdge> result;
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    if (has_before[i]) continue;
    result.push_back(edges[i]);
    std::vector<Vec3> passed;
    for (auto k = next[i]; k; k = next[*k]) {
      const Vec3 last = result.back().b, end = edges[*k].b;
      passed.push_back(last);
      const double rounding =
          double(distance) + 4e-7 * double(std::max(max_component(abs(last)), max_component(abs(end))));
      const Double3 from(result.back().a), along = normalize(Double3(end) - from);
      // If there are many vertices, some of them are tested.
      constexpr std::size_t kTests = 32;
      const std::size_t step = 1 + passed.size() / kTests;
      bool is_straight = true;
      for (std::size_t n = passed.size(); n-- > 0 && is_straight; n -= std::min(n, step - 1))
        is_straight = length(cross(Double3(passed[n]) - from, along)) <= rounding;
      if (is_straight) {
        result.back().b = end;
      } else {
        result.push_back(edges[*k]);
        passed.clear();
      }
    }
  }
  return result;
}

/// Returns for each set of triangles the number of its plane, equal for sets in one plane, or `none` for sets
/// that are not flat.
std::vector<std::uint32_t> flat_sheets(std::span<const TriangleSet> sets, float distance,
                                       std::uint32_t none) {
  struct Plane {
    Double3 p, normal;
    double rounding;
  };
  std::vector<Plane> planes;
  // Planes by direction and distance from the origin, both rounded. The factor in `cell` keeps round numbers
  // away from the borders of cells.
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> planes_near;
  const auto cell = [](double x, double size) {
    return std::uint64_t(std::int64_t(std::round(x / (1.0371 * size))));
  };
  // Meshes may have vertices that no triangle uses.
  const auto all_of_vertices = [](const TriangleSet& set, const auto& test) {
    return std::all_of(set.triangles.begin(), set.triangles.end(), [&](const TriangleIndices& t) {
      return test(set.positions[t[0]]) && test(set.positions[t[1]]) && test(set.positions[t[2]]);
    });
  };
  const auto reach = [&](const TriangleSet& set) {
    double largest = 1e-30;
    all_of_vertices(set, [&](const Vec3& p) {
      largest = std::max(largest, double(max_component(abs(p))));
      return true;
    });
    return largest;
  };
  double of_scene = 0;
  for (const TriangleSet& set : sets) of_scene = std::max(of_scene, reach(set));
  std::vector<std::uint32_t> sheets;
  for (const TriangleSet& set : sets) {
    Double3 normal{};
    for (const TriangleIndices& t : set.triangles) {
      const Double3 a(set.positions[t[0]]);
      const Double3 n = cross(Double3(set.positions[t[1]]) - a, Double3(set.positions[t[2]]) - a);
      if (length(n) > length(normal)) normal = n;
    }
    const double rounding = 2e-7 * reach(set) + double(distance);
    const auto lies_in = [&](const Plane& plane) {
      return all_of_vertices(set, [&](const Vec3& p) {
        return std::abs(dot(Double3(p) - plane.p, plane.normal)) <= std::max(rounding, plane.rounding);
      });
    };
    std::uint32_t sheet = none;
    if (length(normal) > 0) {
      const Plane own{Double3(set.positions[set.triangles[0][0]]), normalize(normal), rounding};
      if (lies_in(own)) {
        const Double3& n = own.normal;
        const double sign = n.x + 0.7 * n.y + 0.3 * n.z < 0 ? -1 : 1;
        const std::uint64_t direction = combine_bits(
            combine_bits(cell(sign * n.x, 0.01), cell(sign * n.y, 0.01)), cell(sign * n.z, 0.01));
        auto& alike = planes_near[combine_bits(direction, cell(sign * dot(own.p, n), 1e-3 * of_scene))];
        const auto found =
            std::find_if(alike.begin(), alike.end(), [&](std::uint32_t i) { return lies_in(planes[i]); });
        sheet = found != alike.end() ? *found : std::uint32_t(planes.size());
        if (found == alike.end()) alike.push_back(sheet), planes.push_back(own);
      }
    }
    sheets.push_back(sheet);
  }
  return sheets;
}

}  // namespace

OutlineEdges::OutlineEdges(const SceneParts& parts) : nm_(1e-9 / parts.context->length_unit_m) {
  const DiffractingShapes shapes(parts, DiffractingShapes::SeenThrough::left_out,
                                 DiffractingShapes::Balls::listed);
  welded_ = float(parts.context->grid.min_nm * nm_ / 40);
  const auto positions = welded_positions(shapes.sets, welded_);
  std::vector<TriangleSet> sets;
  for (std::size_t i = 0; i < positions.size(); ++i) sets.push_back({positions[i], shapes.sets[i].triangles});
  lift_ = shapes.lift;
  reflects_ = shapes.reflects;
  sheet_ = flat_sheets(sets, welded_, kNoSheet);
  std::vector<MeshEdge> edges = find_mesh_edges(sets);
  orient_borders(edges);
  // Edges closer than a twentieth of the wavelength count as one edge elsewhere, too.
  remove_flat_folds(edges, sets, 2 * double(welded_));
  edges_ = joined(edges, sheet_, kNoSheet, welded_);
  notes_ = shapes.remarks;
  for (const MeshEdge& edge : edges_) box_.extend(edge.a), box_.extend(edge.b);
  lines_ = EdgeLines(edges_);
  std::vector<Bounds3> boxes;
  balls_ = shapes.balls;
  for (const auto& ball : balls_) {
    lift_.push_back(float(ball.lift));
    // Each ball is a sheet of its own, numbered after the sets of triangles.
    sheet_.push_back(std::uint32_t(sheet_.size() + sets.size()));
    const Vec3 center = ball.center.to_float(), r = Vec3{1, 1, 1} * float(1.03 * ball.radius);
    Bounds3& box = boxes.emplace_back();
    box.extend(center - r), box.extend(center + r);
    box_.extend(box.lower), box_.extend(box.upper);
  }
  if (!balls_.empty()) ball_tree_ = BeamTree(boxes);
  std::size_t count = edges_.size();
  for (const auto& ball : balls_) count += std::size_t(ball.pieces);
  // Far in the shadow of few edges light is diffracted that is 66 dB weaker than without obstacles. The time of a
  // segment grows faster than the number of edges in the window.
  constexpr double kFew = 256, kCrowd = 4096, kLeast = 15, kLeastInCrowd = 8;
  const double few = kFew / double(std::max<std::size_t>(count, 1));
  window_ = std::clamp(2 * few * window_, kLeast, window_);
  window_behind_ = std::clamp(few * kLargestWindow, window_, kLargestWindow);
  window_open_ = std::min(window_open_, window_);
  if (double(count) > kCrowd) {
    window_open_ = window_ = window_behind_ = kLeastInCrowd;
    notes_.push_back(
        "diffraction: the scene has " + std::to_string(count) +
        " edges, so that an edge counts up to the Fresnel parameter 8 only, where it sends 31 dB less "
        "than the unobstructed light");
  }
  if (edges_.empty() && balls_.empty()) notes_.push_back(kNoDiffractingEdges);
  for (const auto& [name, is_stated] :
       {std::pair("scale",
                  std::any_of(shapes.scale.begin(), shapes.scale.end(), [](float s) { return s != 1; })),
        std::pair("sigma", shapes.has_width())})
    if (is_stated)
      notes_.push_back(
          "\"" + std::string(name) +
          "\" of \"freespacediffraction\" has no effect with the diffraction model \"segments\": "
          "diffraction_model=\"beams\" applies it");
}

bool has_same_outlines(const SceneParts& a, const SceneParts& b) {
  return std::equal(a.surfaces.begin(), a.surfaces.end(), b.surfaces.begin(), b.surfaces.end(),
                    [](const Primitive& x, const Primitive& y) {
                      return x.shape == y.shape && x.bsdf == y.bsdf && x.instance == y.instance &&
                             x.emitter == y.emitter;
                    });
}

Beam OutlineEdges::beam_of(const EdgeSegment& s, double detour) const {
  const double length = s.is_infinite() ? farthest(s) : s.length;
  return {s.from.to_float(), s.d.to_float(), float(std::sqrt(squared_radius(s, detour))), float(-detour / 2),
          float(length + detour / 2)};
}

double OutlineEdges::smallest_parameter(double most, const EdgeSegment& segment, double wavelength,
                                        const std::function<bool(const Double3&)>& is_lit) const {
  most = std::min(most, window_open_ * 4 / 3);
  const EdgeWindow window{most * 3 / 4, most * 3 / 4, wavelength, wavelength};
  const double detour = window.detour(window.largest), scale = 1 / std::sqrt(wavelength);
  double smallest = double(kInfinity);
  if (!balls_.empty())
    ball_tree_.visit(beam_of(segment, detour), [&](std::uint32_t i) {
      smallest = std::min(smallest, scale * std::sqrt(squared_rim_parameter(i, segment)));
    });
  // The edges with the smallest v, in ascending order.
  constexpr std::size_t kTests = 8;
  struct Candidate {
    double v;
    EdgePassage passage;
  };
  std::array<Candidate, kTests + 1> next;
  std::size_t count = 0;
  EdgePassage passage;
  double reach = squared_radius(segment, detour);
  lines_.visit(
      segment.from, segment.d, reach, [&] { return beam_of(segment, detour); },
      [&](std::uint32_t i) {
        const DetourLine line(edges_[i], segment);
        const double v = scale * line.parameter(std::clamp(line.middle(), 0.0, line.length));
        if (!(v < std::min(smallest, most)) || (count == next.size() && !(v < next.back().v)) ||
            !find_passage(edges_[i], segment, window, passage))
          return;
        std::size_t at = std::min(count, next.size() - 1);
        for (; at > 0 && v < next[at - 1].v; --at) next[at] = next[at - 1];
        next[at] = {v, passage};
        count = std::min(count + 1, next.size());
        if (count < next.size()) return;
        // Only edges with a smaller v matter from now on.
        const double v2 = next.back().v * next.back().v;
        reach = squared_radius(segment, wavelength * v2 / 4);
      });
  for (std::size_t k = 0; k < count; ++k) {
    const Candidate& c = next[k];
    EdgeSide side;
    const bool is_tested =
        k < kTests && find_side(c.passage, segment, c.passage.in, c.passage.out, true, side);
    if (is_tested && !is_lit(side.beside)) continue;
    smallest = std::min(smallest, c.v);
    break;
  }
  return smallest <= most ? smallest : double(kInfinity);
}

double OutlineEdges::squared_rim_parameter(std::uint32_t i, const EdgeSegment& segment) const {
  const auto& ball = balls_[i];
  const Double3 p = ball.center - segment.from;
  const double depth = dot(p, segment.d), off = length(p - segment.d * depth);
  if (!(depth > 0) || !(depth < segment.length)) return double(kInfinity);
  // If an end of the segment is a point of its surface, the ball is no obstacle.
  const double near = ball.radius * (1 + 1e-4);
  if (length(p) < near || (!segment.is_infinite() && length(p - segment.d * segment.length) < near))
    return double(kInfinity);
  const double sum = 1 / depth + (segment.is_infinite() ? 0 : 1 / (segment.length - depth));
  const double least = off - ball.radius;
  return 2 * least * least * sum;
}

bool OutlineEdges::has_rim_within(std::uint32_t i, const EdgeSegment& segment, double detour) const {
  // Twice the detour, since the parameter is paraxial.
  return squared_rim_parameter(i, segment) < 4 * (2 * detour);
}

void OutlineEdges::add_rim(std::uint32_t i, const EdgeSegment& segment, double detour,
                           std::deque<MeshEdge>& rims) const {
  if (!has_rim_within(i, segment, detour)) return;
  const auto& ball = balls_[i];
  Double3 x, y;
  make_basis(segment.d, x, y);
  const double step = 2 * std::numbers::pi / ball.pieces, r = ball.radius / std::cos(0.5 * step);
  MeshEdge edge{};
  edge.n0 = segment.d.to_float();
  edge.face0.set = edge.face1.set = std::uint32_t(lift_.size() - balls_.size() + i);
  edge.is_boundary = true;
  const auto corner = [&](int k) {
    return (ball.center + x * (r * std::cos(k * step)) + y * (r * std::sin(k * step))).to_float();
  };
  for (int k = 0; k < ball.pieces; ++k) {
    edge.a = corner(k);
    edge.b = corner((k + 1) % ball.pieces);
    if (!(edge.a == edge.b)) rims.push_back(edge);
  }
}

bool OutlineEdges::find_passage(const MeshEdge& edge, const EdgeSegment& segment, const EdgeWindow& window,
                                EdgePassage& out) const {
  const DetourLine line(edge, segment);
  out.edge = &edge;
  if (!line.clip(window.detour(window.largest), out.begin, out.end)) return false;
  out.middle = line.middle();
  out.window = window.of_edge(line.parameter(std::clamp(out.middle, out.begin, out.end)));
  if (out.window < window.largest && !line.clip(window.detour(out.window), out.begin, out.end)) return false;
  out = part(out, segment, out.begin, out.end, false, false);
  // The border of a sheet does not diffract light that begins or ends on that sheet; the tolerance allows for
  // the offsets of rays from surfaces.
  if (!edge.is_boundary) return true;
  const Double3 normal(edge.n0), into_face = face_direction(normal, line.e);
  const double rounding = 8 * rounding_of(edge, segment, out.p);
  if (lies_on_face(-out.p, normal, into_face, rounding)) return false;
  return line.is_infinite() || !lies_on_face(segment.d * segment.length - out.p, normal, into_face, rounding);
}

EdgePassage OutlineEdges::part(const EdgePassage& passage, const EdgeSegment& segment, double begin,
                               double end, bool begins_at_cut, bool ends_at_cut) const {
  const DetourLine line(*passage.edge, segment);
  EdgePassage part = passage;
  part.begin = begin, part.end = end;
  // Visibility is tested a small distance from the end of a part, since the next edge begins there; the
  // distance exceeds the error of a visibility test. Where two outlines cross, the distance is larger, since
  // the light by way of either outline ends near the crossing and not at it.
  const double off = offset(*passage.edge, rounding_of(*passage.edge, segment, line.at(begin)));
  const double least = 3 * off / std::max(1e-6, length(cross(line.e, segment.d)));
  const auto margin = [&](bool is_cut) {
    return std::clamp(least, (is_cut ? 0.25 : 0.01) * (end - begin), 0.5 * (end - begin));
  };
  part.p = line.at(std::max(begin + margin(begins_at_cut), std::min(part.middle, end - margin(ends_at_cut))));
  line.directions(part.p, part.in, part.out);
  return part;
}

bool OutlineEdges::find_side(const EdgePassage& passage, const EdgeSegment& segment, const Double3& in,
                             const Double3& out, bool grazes, EdgeSide& side) const {
  const MeshEdge& edge = *passage.edge;
  const Double3 through = in + out;
  const bool is_outline = edge.is_outline(through.to_float());
  if (!is_outline && !grazes) return false;
  const Double3 e = normalize(Double3(edge.b) - Double3(edge.a));
  // The plane through the edge and the light's mean direction separates the open side from the side of the
  // faces.
  Double3 normal = cross(e, through);
  const double size = length(normal);
  if (!(size > 1e-9)) return false;
  normal = normal * (1 / size);
  const double side0 = dot(face_direction(Double3(edge.n0), e), normal);
  const double side1 = edge.is_boundary ? 0 : dot(face_direction(e, Double3(edge.n1)), normal);
  const double falling = std::max(std::abs(side0), std::abs(side1));
  if (!is_outline && !(falling > 0.5 && std::min(std::abs(side0), std::abs(side1)) < 0.2)) return false;
  if ((std::abs(side0) >= std::abs(side1) ? side0 : side1) > 0) normal = -normal;
  const double rounding = rounding_of(edge, segment, passage.p);
  side.normal = normal, side.leg = edge.leg;
  side.offset = offset(edge, rounding);
  side.rounding = rounding;
  side.beside = segment.from + passage.p + normal * side.offset;
  const double height = dot(segment.d * dot(passage.p, segment.d) - passage.p, normal);
  side.is_open = height > 0;
  side.is_at_border = std::abs(height) <= rounding;
  return true;
}

bool OutlineEdges::have_common_face(const EdgePassage& a, const EdgePassage& b) {
  const Double3 between = b.p - a.p;
  const double most = kAlongFace * length(between);
  constexpr double kEqual = 1e-3;
  for (const Vec3& n : {a.edge->n0, a.edge->n1})
    for (const Vec3& other : {b.edge->n0, b.edge->n1})
      if (length(Double3(n) - Double3(other)) < kEqual && std::abs(dot(between, Double3(n))) < most)
        return true;
  return false;
}

bool OutlineEdges::find_wedge(const MeshEdge& edge, const LightByEdge& light, EdgeWedge& out) const {
  constexpr double kLeastFold = std::numbers::pi / 6;
  if (edge.face0.set >= reflects_.size() || lift_[edge.face0.set] > 0) return false;
  const Double3 e = normalize(Double3(edge.b) - Double3(edge.a));
  // A fold towards the side of its normals is concave there; light passes on the other side, where it is
  // convex.
  const double side = edge.is_concave && !edge.is_boundary ? -1 : 1;
  const Double3 n0(edge.n0), into_face = face_direction(n0, e);
  const double fold =
      edge.is_boundary ? std::numbers::pi : std::acos(std::clamp(dot(n0, Double3(edge.n1)), -1.0, 1.0));
  if (fold < kLeastFold) return false;
  const double end = std::numbers::pi + fold;
  out.n = end / std::numbers::pi;
  out.normal_o = n0 * side;
  out.normal_n = edge.is_boundary ? -out.normal_o : Double3(edge.n1) * side;
  // Sets the angle about the edge, from the o-face, of a direction that points away from the edge.
  const auto angle = [&](const Double3& d, double& phi) {
    phi = std::atan2(dot(d, out.normal_o), dot(d, into_face));
    // Angles inside the wedge are assigned to the nearer face.
    if (phi < -(2 * std::numbers::pi - end) / 2) phi += 2 * std::numbers::pi;
    if (phi < -light.tolerance || phi > end + light.tolerance) return false;
    phi = std::clamp(phi, 0.0, end);
    return true;
  };
  if (!angle(-light.in, out.phi_i) || !angle(light.out, out.phi)) return false;
  // At the point with the smallest detour, light arrives and leaves at one angle to the edge. Beyond the ends of an edge the
  // two differ; their mean is the same in reverse.
  const double sin2 = length(cross(light.in, e)) * length(cross(light.out, e));
  const bool is_infinite = light.s_out >= double(kInfinity);
  out.distance = (is_infinite ? light.s_in : light.s_in * light.s_out / (light.s_in + light.s_out)) * sin2;
  out.sin_beta = std::sqrt(sin2);
  out.reflection_o = reflects_[edge.face0.set];
  out.reflection_n = edge.is_boundary ? out.reflection_o : reflects_[edge.face1.set];
  return out.distance > 0;
}

void OutlineEdges::subtract(const EdgePassage& passage, const EdgeSegment& segment, bool takes_open,
                            const double* wavelengths, int count, std::complex<double>* field) const {
  const DetourLine line(*passage.edge, segment);
  Chords(line, passage.middle, wavelengths, count, passage.window, takes_open ? 1 : -1, field)
      .add(passage.begin, passage.end);
}

bool OutlineEdges::find_pair(const EdgePassage& first, const EdgePassage& second, const EdgeSegment& segment,
                             EdgePairField& out) const {
  if (!first.passes_middle() || !second.passes_middle() || are_of_one_sheet(*first.edge, *second.edge))
    return false;
  const MeshEdge &edge1 = *first.edge, &edge2 = *second.edge;
  const double rounding = rounding_of(edge1, segment, first.p);
  // Edges with one common end make a corner, which the waves of their ends contain; edges with two are one
  // edge.
  const auto meet = [&](const Vec3& a, const Vec3& b) { return double(length(a - b)) <= rounding; };
  const int common =
      meet(edge1.a, edge2.a) + meet(edge1.a, edge2.b) + meet(edge1.b, edge2.a) + meet(edge1.b, edge2.b);
  if (common == 1) return false;
  const Double3 between = second.p - first.p;
  const double distance = length(between);
  const Double3 along = distance > 0 ? between * (1 / distance) : segment.d;
  if (!find_side(first, segment, first.in, along, true, out.side1) ||
      !find_side(second, segment, along, second.out, true, out.side2))
    return false;
  const auto across = [&](const Double3& v) { return normalize(v - segment.d * dot(v, segment.d)); };
  const double cosine = dot(across(out.side1.normal), across(out.side2.normal));
  if (!(cosine > kSideBySide)) return false;

  const DetourLine line1(edge1, segment), line2(edge2, segment);
  out.v1 = (out.side1.is_open ? 1 : -1) * line1.parameter(first.middle);
  out.v2 = (out.side2.is_open ? 1 : -1) * line2.parameter(second.middle);
  const double z1 = dot(first.p, segment.d), z2 = dot(second.p, segment.d);
  const double behind1 = segment.length - z1;
  out.cosine = cosine;
  out.r1 = z1, out.between = z2 - z1, out.r2 = segment.length - z2;
  if (!(out.r1 > 0) || !(out.r2 > 0) || out.between < 0) return false;
  out.obliquity1 = line1.obliquity(first.middle), out.obliquity2 = line2.obliquity(second.middle);
  out.turn1 = obliquity_of_turn(first.in, along), out.turn2 = obliquity_of_turn(along, second.out);
  // `from1`: the ray from the first edge straight to the end, at the depth of the second edge. `height2` is
  // computed in the same way for the ray from the begin to the second edge.
  const Double3 from1 = line1.is_infinite()
                            ? first.p + segment.d * (z2 - z1)
                            : first.p + (segment.d * segment.length - first.p) * ((z2 - z1) / behind1);
  out.height1 = dot(from1 - second.p, out.side2.normal);
  out.height2 = dot(second.p * (z1 / z2) - first.p, out.side1.normal);
  const EdgeSegment to2{segment.from, second.in, length(second.p)};
  const EdgeSegment from_1{
      segment.from + first.p, first.out,
      line1.is_infinite() ? segment.length : length(segment.d * segment.length - first.p)};
  const DetourLine before(edge1, to2), behind(edge2, from_1);
  out.w1 = std::copysign(before.parameter(before.middle()), out.height2);
  out.w2 = std::copysign(behind.parameter(behind.middle()), out.height1);
  return true;
}

void OutlineEdges::add_row(std::span<const EdgePairField> pairs, std::span<const RowEdge> row, double factor,
                           const double* wavelengths, int count, std::complex<double>* field) const {
  const bool is_open = std::all_of(row.begin(), row.end(), [](const RowEdge& e) { return e.is_open; });
  double obliquity = 1;
  for (const EdgePairField& pair : pairs)
    obliquity *= pair.obliquity() / (&pair == &pairs.front() ? 1 : pair.obliquity1);
  for (int i = 0; i < count; ++i) {
    const double scale = 1 / std::sqrt(wavelengths[i]);
    double largest = 0;
    for (const EdgePairField& pair : pairs)
      largest = std::max({largest, std::abs(pair.v1 * scale), std::abs(pair.v2 * scale)});
    const double weight = optics::window_weight(largest, window_behind_);
    if (weight == 0) continue;
    std::complex<double> common = 1;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const EdgePairField& pair = pairs[k];
      common *= optics::two_edges_field(pair.v1 * scale, pair.v2 * scale, pair.correlation(wavelengths[i]));
      if (k > 0) common /= optics::knife_edge_field(pair.v1 * scale);
    }
    std::complex<double> more = obliquity * (common - (is_open ? 1.0 : 0.0));
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (!row[k].subtracted) continue;
      const EdgePairField& pair = pairs[std::min(k, pairs.size() - 1)];
      const bool is_first = k < pairs.size();
      const double v = (is_first ? pair.v1 : pair.v2) * scale,
                   c = is_first ? pair.obliquity1 : pair.obliquity2;
      more += (*row[k].subtracted ? c : -c) * optics::knife_edge_field(-std::abs(v));
    }
    field[i] += factor * weight * more;
  }
}

}  // namespace aureole
