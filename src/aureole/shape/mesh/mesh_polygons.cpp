// SPDX-License-Identifier: Apache-2.0
// A triangulation by n - 2 triangles is right if none of them is turned around: their winding numbers add up
// to the polygon's, which is 1 inside and 0 outside. A fan of such triangles needs no other test, and ears
// may be clipped in any order.
#include "aureole/shape/mesh/mesh_polygons.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "aureole/shape/geometry/double3.h"

namespace aureole {
namespace {

struct Point {
  double x, y;
  bool operator==(const Point&) const = default;
};

/// Returns twice the signed area of a triangle, positive if it is counter-clockwise.
double doubled_area(Point a, Point b, Point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Clips the ears of one polygon, whose area is positive.
class EarClipper {
public:
  using Triangle = std::array<std::size_t, 3>;
  explicit EarClipper(std::span<const Point> points);

  /// Returns n - 2 triangles, empty if the search would take more than kMaxTests point tests.
  std::vector<Triangle> clip();

private:
  static constexpr std::size_t kMaxTests = 2'000'000'000;
  /// Conditions under which a corner is clipped, from the strictest on. Those from `collinear` on are
  /// reached only in polygons that touch or intersect themselves.
  enum Level { clear, touched, collinear, convex, any, kLevels };

  double area_at(std::size_t i) const { return doubled_area(p_[previous_[i]], p_[i], p_[next_[i]]); }
  bool clippable(std::size_t i, Level level);
  bool is_clear(std::size_t i, bool border_counts);
  std::size_t find(Level level);
  void classify(std::size_t i);
  void remove(std::size_t i);

  std::span<const Point> p_;
  std::vector<std::size_t> previous_, next_;
  std::vector<char> alive_, ear_, reflex_;
  std::vector<std::size_t> by_x_;  ///< all corners that were ever reflex, by ascending x
  std::size_t start_ = 0, left_, tests_ = 0;
};

EarClipper::EarClipper(std::span<const Point> points) : p_(points), left_(points.size()) {
  const std::size_t n = p_.size();
  previous_.resize(n), next_.resize(n);
  for (std::size_t i = 0; i < n; ++i) previous_[i] = (i + n - 1) % n, next_[i] = (i + 1) % n;
  alive_.assign(n, 1), ear_.assign(n, 0), reflex_.assign(n, 0);
  // Corners that are reflex. Clipping makes no corner reflex that was convex, except in polygons that
  // intersect themselves.
  for (std::size_t i = 0; i < n; ++i)
    if (!(area_at(i) > 0)) by_x_.push_back(i), reflex_[i] = 1;
  std::sort(by_x_.begin(), by_x_.end(), [&](std::size_t a, std::size_t b) { return p_[a].x < p_[b].x; });
  for (std::size_t i = 0; i < n; ++i) ear_[i] = clippable(i, clear);
}

/// Whether no reflex corner lies in the triangle at `i`. Corners at the positions of its corners do not
/// count, as they occur where a polygon is joined to a hole.
bool EarClipper::is_clear(std::size_t i, bool border_counts) {
  const Point a = p_[previous_[i]], b = p_[i], c = p_[next_[i]];
  const double low = std::min({a.x, b.x, c.x}), high = std::max({a.x, b.x, c.x});
  auto at =
      std::lower_bound(by_x_.begin(), by_x_.end(), low, [&](std::size_t k, double x) { return p_[k].x < x; });
  for (; at != by_x_.end() && p_[*at].x <= high; ++at, ++tests_) {
    const Point q = p_[*at];
    if (!alive_[*at] || !reflex_[*at] || q == a || q == b || q == c) continue;
    const double least = std::min({doubled_area(a, b, q), doubled_area(b, c, q), doubled_area(c, a, q)});
    if (border_counts ? least >= 0 : least > 0) return false;
  }
  return true;
}

bool EarClipper::clippable(std::size_t i, Level level) {
  if (level == any || p_[i] == p_[next_[i]]) return true;
  const double area = area_at(i);
  if (level == collinear) return area == 0;
  return area > 0 && (level == convex || is_clear(i, level == clear));
}

/// Returns an alive corner that fulfils a condition, from `start_` on, or the number of corners.
std::size_t EarClipper::find(Level level) {
  std::size_t i = start_;
  for (std::size_t k = 0; k < left_; ++k, i = next_[i])
    if (clippable(i, level)) return i;
  return p_.size();
}

void EarClipper::classify(std::size_t i) {
  reflex_[i] = !(area_at(i) > 0);
  ear_[i] = clippable(i, clear);
}

void EarClipper::remove(std::size_t i) {
  const std::size_t before = previous_[i], after = next_[i];
  next_[before] = after, previous_[after] = before;
  alive_[i] = 0, --left_;
  classify(before), classify(after);
  // continues elsewhere, since clipping ears one after the other would make a fan of slivers
  start_ = next_[after];
}

std::vector<EarClipper::Triangle> EarClipper::clip() {
  std::vector<Triangle> triangles;
  triangles.reserve(p_.size() - 2);
  while (left_ > 3) {
    std::size_t ear = p_.size(), i = start_;
    for (std::size_t k = 0; k < left_ && ear == p_.size(); ++k, ++tests_, i = next_[i])
      if (ear_[i]) ear = i;
    for (int level = clear; level < kLevels && ear == p_.size(); ++level) ear = find(Level(level));
    if (tests_ > kMaxTests) return {};
    triangles.push_back({previous_[ear], ear, next_[ear]});
    remove(ear);
  }
  triangles.push_back({previous_[start_], start_, next_[start_]});
  return triangles;
}

/// Returns the corners of a fan, by any of its lists of indices.
void corners_of(const std::vector<TriangleIndices>& fan, const FannedPolygon& polygon,
                std::vector<std::uint32_t>& corners) {
  corners.assign({fan[polygon.first][0], fan[polygon.first][1]});
  for (std::size_t k = 2; k < polygon.corners; ++k) corners.push_back(fan[polygon.first + k - 2][2]);
}

/// Projects a polygon on the coordinate plane in which its area is largest and positive. Returns false if it
/// has no area.
bool project(std::span<const std::uint32_t> corners, const std::vector<Vec3>& positions,
             std::vector<Point>& points) {
  // Normal by Newell's method: the sum of the triangles of a fan, here about a corner, which keeps it exact
  // far from the origin.
  const Double3 origin(positions[corners[0]]);
  Double3 normal(0, 0, 0);
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    normal =
        normal + cross(Double3(positions[corners[k]]) - origin, Double3(positions[corners[k + 1]]) - origin);
  const double n[3] = {normal.x, normal.y, normal.z};
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(n[k]) > std::abs(n[axis])) axis = k;
  if (!(std::abs(n[axis]) > 0) || !std::isfinite(n[axis])) return false;
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (n[axis] < 0) std::swap(u, v);
  points.clear();
  for (const std::uint32_t c : corners) points.push_back({double(positions[c][u]), double(positions[c][v])});
  return true;
}

/// Whether the fan covers the polygon once. Thin triangles do not count as covering: an ear that is cut
/// elsewhere keeps the corner that lies on an edge.
bool fan_is_right(std::span<const Point> p) {
  for (std::size_t k = 1; k + 1 < p.size(); ++k) {
    const double size = std::max({std::abs(p[k].x - p[0].x), std::abs(p[k].y - p[0].y),
                                  std::abs(p[k + 1].x - p[k].x), std::abs(p[k + 1].y - p[k].y)});
    if (!(doubled_area(p[0], p[k], p[k + 1]) > 1e-6 * size * size)) return false;
  }
  return true;
}

}  // namespace

std::vector<std::string> triangulate_polygons(MeshData& data, std::span<const FannedPolygon> polygons,
                                              const MeshFile& file) {
  std::vector<std::uint32_t> corners;
  std::vector<Point> points;
  std::size_t crossing = 0;
  for (const FannedPolygon& polygon : polygons) {
    corners_of(data.triangles, polygon, corners);
    if (!project(corners, data.positions, points)) {
      ++crossing;
      continue;
    }
    if (fan_is_right(points)) continue;
    const auto triangles = EarClipper(points).clip();
    if (triangles.empty())
      throw file.error("a face of " + std::to_string(corners.size()) +
                       " corners takes too long to be triangulated");
    bool turned = false;
    for (const auto& t : triangles) turned |= doubled_area(points[t[0]], points[t[1]], points[t[2]]) < 0;
    crossing += turned;
    for (auto* list : {&data.triangles, &data.uv_triangles, &data.normal_triangles}) {
      if (list->empty()) continue;
      corners_of(*list, polygon, corners);
      for (std::size_t k = 0; k < triangles.size(); ++k)
        (*list)[polygon.first + k] = {corners[triangles[k][0]], corners[triangles[k][1]],
                                      corners[triangles[k][2]]};
    }
  }
  if (crossing == 0) return {};
  return {std::to_string(crossing) +
          (crossing == 1 ? " polygon intersects itself or has" : " polygons intersect themselves or have") +
          " no area; which part of it is covered is arbitrary"};
}

}  // namespace aureole
