// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/aperture/polygon_region.h"

#include <algorithm>
#include <clipper.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

namespace aureole::optics {

namespace {

__extension__ using Wide = __int128;

/// A point on a grid of 2^52 cells across the region, as fine as double precision. Orientation tests on it
/// are exact.
struct GridPoint {
  std::int64_t x, y;
  bool operator==(const GridPoint&) const = default;
};

struct Grid {
  PlanePoint center;
  double cell = 1;

  Grid(PlanePoint lower, PlanePoint upper)
      : center{0.5 * (lower.x + upper.x), 0.5 * (lower.y + upper.y)},
        cell(std::max(upper.x - lower.x, upper.y - lower.y) * 0x1p-52) {}
  GridPoint operator()(PlanePoint p) const {
    return {std::llrint((p.x - center.x) / cell), std::llrint((p.y - center.y) / cell)};
  }
  PlanePoint operator()(const ClipperLib::IntPoint& p) const {
    return {center.x + double(p.X) * cell, center.y + double(p.Y) * cell};
  }
};

struct Edge {
  GridPoint a, b;
  std::size_t ring, index;
  std::int64_t min_x, max_x, min_y, max_y;

  Edge(GridPoint from, GridPoint to, std::size_t in, std::size_t i)
      : a(from),
        b(to),
        ring(in),
        index(i),
        min_x(std::min(a.x, b.x)),
        max_x(std::max(a.x, b.x)),
        min_y(std::min(a.y, b.y)),
        max_y(std::max(a.y, b.y)) {}
};

/// Returns the sign of the area of a triangle.
int turn(GridPoint a, GridPoint b, GridPoint c) {
  const Wide v = Wide(b.x - a.x) * (c.y - a.y) - Wide(b.y - a.y) * (c.x - a.x);
  return v > 0 ? 1 : v < 0 ? -1 : 0;
}

/// Whether two edges touch, given that their bounding boxes overlap.
bool touch(const Edge& e, const Edge& f) {
  return turn(e.a, e.b, f.a) * turn(e.a, e.b, f.b) <= 0 && turn(f.a, f.b, e.a) * turn(f.a, f.b, e.b) <= 0;
}

/// Whether the second edge starts at the end of the first one and does not run back along it.
bool is_plain_corner(const Edge& e, const Edge& f) {
  if (!(e.b == f.a) || e.a == f.b) return false;
  const Wide along = Wide(e.b.x - e.a.x) * (f.b.x - f.a.x) + Wide(e.b.y - e.a.y) * (f.b.y - f.a.y);
  return turn(e.a, e.b, f.b) != 0 || along > 0;
}

std::string text(PlanePoint p) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << "(" << p.x << ", " << p.y << ")";
  return out.str();
}

std::string name_of(const std::vector<Ring>& rings, const Edge& e) {
  const Ring& ring = rings[e.ring];
  return "edge " + std::to_string(e.index + 1) + " from " + text(ring[e.index]) + " to " +
         text(ring[(e.index + 1) % ring.size()]);
}

/// Returns the height y at which the lines through two edges cross; for parallel lines, the height of an
/// endpoint.
double crossing_height(PlanePoint a, PlanePoint b, PlanePoint c, PlanePoint d) {
  const double area = (b.x - a.x) * (d.y - c.y) - (b.y - a.y) * (d.x - c.x);
  const double t = ((c.x - a.x) * (d.y - c.y) - (c.y - a.y) * (d.x - c.x)) / area;
  return t >= 0 && t <= 1 ? a.y + t * (b.y - a.y) : a.y;
}

/// Returns the heights y of contacts between edges of different rings, at most `most` + 1 of them. Throws
/// std::domain_error if a ring touches itself.
std::vector<double> find_contacts(const std::vector<Ring>& rings, const Grid& grid, std::size_t most) {
  std::vector<Edge> edges;
  for (std::size_t r = 0; r < rings.size(); ++r)
    for (std::size_t i = 0; i < rings[r].size(); ++i)
      edges.emplace_back(grid(rings[r][i]), grid(rings[r][(i + 1) % rings[r].size()]), r, i);
  std::sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) { return e.min_x < f.min_x; });
  std::vector<double> contacts;
  const auto end = [&](const Edge& e, std::size_t k) {
    return rings[e.ring][(e.index + k) % rings[e.ring].size()];
  };
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Edge& e = edges[i];
    for (std::size_t j = i + 1; j < edges.size() && edges[j].min_x <= e.max_x; ++j) {
      const Edge& f = edges[j];
      if (f.min_y > e.max_y || f.max_y < e.min_y || !touch(e, f)) continue;
      if (e.ring != f.ring) {
        contacts.push_back(crossing_height(end(e, 0), end(e, 1), end(f, 0), end(f, 1)));
        if (contacts.size() > most) return contacts;
        continue;
      }
      const std::size_t n = rings[e.ring].size();
      const bool e_first = (e.index + 1) % n == f.index, f_first = (f.index + 1) % n == e.index;
      if ((e_first && is_plain_corner(e, f)) || (f_first && is_plain_corner(f, e))) continue;
      const bool swap = f.index < e.index;
      throw std::domain_error("ring " + std::to_string(e.ring + 1) + " touches or crosses itself: " +
                              name_of(rings, swap ? f : e) + " meets " + name_of(rings, swap ? e : f));
    }
  }
  return contacts;
}

void bound(const std::vector<Ring>& rings, PlanePoint& lower, PlanePoint& upper) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  lower = {kInfinity, kInfinity};
  upper = {-kInfinity, -kInfinity};
  for (const Ring& ring : rings)
    for (const PlanePoint& p : ring) {
      lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
      upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
    }
}

/// Orients rings without contacts: outer ones counter-clockwise, holes clockwise. It is as exact as
/// `find_contacts`.
void orient(std::vector<Ring>& rings, const Grid& grid) {
  std::vector<std::vector<GridPoint>> points;
  for (const Ring& ring : rings) {
    points.emplace_back();
    for (const PlanePoint& p : ring) points.back().push_back(grid(p));
  }
  const auto surrounds = [](const std::vector<GridPoint>& ring, GridPoint p) {
    bool inside = false;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const GridPoint a = ring[i], b = ring[i + 1 < ring.size() ? i + 1 : 0];
      if ((a.y <= p.y) != (b.y <= p.y) && turn(a, b, p) == (b.y > a.y ? 1 : -1)) inside = !inside;
    }
    return inside;
  };
  std::vector<char> reverse;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const Ring& ring = rings[r];
    bool is_hole = false;
    double area = 0;
    for (std::size_t other = 0; other < rings.size(); ++other)
      if (other != r && surrounds(points[other], points[r][0])) is_hole = !is_hole;
    for (std::size_t i = 2; i < ring.size(); ++i)
      area += (ring[i - 1].x - ring[0].x) * (ring[i].y - ring[0].y) -
              (ring[i - 1].y - ring[0].y) * (ring[i].x - ring[0].x);
    reverse.push_back((area < 0) != is_hole);
  }
  for (std::size_t r = 0; r < rings.size(); ++r)
    if (reverse[r]) std::reverse(rings[r].begin(), rings[r].end());
}

/// Returns the area by the even-odd rule, summed over the rows between the heights of all vertices and
/// crossings.
double even_odd_area(const std::vector<Ring>& rings, std::vector<double> heights) {
  for (const Ring& ring : rings)
    for (const PlanePoint& p : ring) heights.push_back(p.y);
  std::sort(heights.begin(), heights.end());
  std::vector<double> crossings;
  double area = 0;
  for (std::size_t k = 0; k + 1 < heights.size(); ++k) {
    const double y = 0.5 * (heights[k] + heights[k + 1]);
    if (!(heights[k + 1] > heights[k])) continue;
    crossings.clear();
    for (const Ring& ring : rings)
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const PlanePoint a = ring[i], b = ring[i + 1 < ring.size() ? i + 1 : 0];
        if ((a.y <= y) != (b.y <= y)) crossings.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
      }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
      area += (heights[k + 1] - heights[k]) * (crossings[i + 1] - crossings[i]);
  }
  return area;
}

/// Returns the even-odd union by Clipper, which is given the rings rotated by an angle.
std::vector<Ring> clipped(const std::vector<Ring>& rings, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  std::vector<Ring> turned = rings;
  for (Ring& ring : turned)
    for (PlanePoint& p : ring) p = {c * p.x - s * p.y, s * p.x + c * p.y};
  PlanePoint lower, upper;
  bound(turned, lower, upper);
  const Grid grid(lower, upper);
  ClipperLib::Clipper clipper;
  for (const Ring& ring : turned) {
    ClipperLib::Path path;
    for (const PlanePoint& p : ring) {
      const GridPoint g = grid(p);
      path.emplace_back(g.x, g.y);
    }
    clipper.AddPath(path, ClipperLib::ptSubject, true);
  }
  ClipperLib::Paths parts;
  clipper.Execute(ClipperLib::ctUnion, parts, ClipperLib::pftEvenOdd);
  std::vector<Ring> result;
  for (const ClipperLib::Path& path : parts) {
    Ring ring;
    for (const ClipperLib::IntPoint& g : path) {
      const PlanePoint p = grid(g);
      ring.push_back({c * p.x + s * p.y, c * p.y - s * p.x});
    }
    if (ring.size() > 2) result.push_back(std::move(ring));
  }
  return result;
}

}  // namespace

PolygonRegion::PolygonRegion(std::vector<Ring> rings) : rings_(std::move(rings)) {
  bound(rings_, lower_, upper_);
  // Coordinates relative to the centre of the region avoid cancellation far from the origin.
  const PlanePoint middle{0.5 * (lower_.x + upper_.x), 0.5 * (lower_.y + upper_.y)};
  double moment_x = 0, moment_y = 0;
  for (const Ring& ring : rings_)
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const PlanePoint &p = ring[i], &next = ring[i + 1 < ring.size() ? i + 1 : 0];
      const double ax = p.x - middle.x, ay = p.y - middle.y, bx = next.x - middle.x, by = next.y - middle.y;
      const double cross = ax * by - ay * bx;
      area_ += cross / 2;
      moment_x += cross * (ax + bx) / 6;
      moment_y += cross * (ay + by) / 6;
    }
  centroid_ = {middle.x + moment_x / area_, middle.y + moment_y / area_};
}

PolygonRegion PolygonRegion::even_odd(std::vector<Ring> rings) {
  std::size_t count = 0;
  for (const Ring& ring : rings) {
    count += ring.size();
    for (const PlanePoint& p : ring)
      if (!(std::abs(p.x) < 1e100 && std::abs(p.y) < 1e100))
        throw std::domain_error("a coordinate is not a number below 1e100");
  }
  if (count > kMaxVertices)
    throw std::domain_error("has " + std::to_string(count) + " vertices; the limit is " +
                            std::to_string(kMaxVertices));
  if (count == 0) throw std::domain_error("has no vertices");
  PlanePoint lower, upper;
  bound(rings, lower, upper);
  const Grid grid(lower, upper);
  if (!(grid.cell > 1e-100)) throw std::domain_error("all its vertices are in one place");
  for (std::size_t r = 0; r < rings.size(); ++r) {
    Ring& ring = rings[r];
    const auto same = [&](PlanePoint a, PlanePoint b) { return grid(a) == grid(b); };
    ring.erase(std::unique(ring.begin(), ring.end(), same), ring.end());
    while (ring.size() > 1 && same(ring.front(), ring.back())) ring.pop_back();
    if (ring.size() < 3)
      throw std::domain_error("ring " + std::to_string(r + 1) + " has fewer than 3 different vertices");
  }
  const std::vector<double> contacts = find_contacts(rings, grid, kMaxVertices);
  if (contacts.size() > kMaxVertices)
    throw std::domain_error("its rings cross each other more than " + std::to_string(kMaxVertices) +
                            " times");
  const double box = std::max(upper.x - lower.x, upper.y - lower.y), negligible = 1e-10 * box * box;
  const auto checked = [&](std::vector<Ring> parts) {
    if (parts.empty()) throw std::domain_error("has no area");
    PolygonRegion region(std::move(parts));
    if (!(region.area_ > negligible)) throw std::domain_error("has no area");
    return region;
  };
  if (contacts.empty()) {
    // The rings have no contacts, so that their coordinates stay bitwise equal.
    orient(rings, grid);
    return checked(std::move(rings));
  }
  // If many edges of several rings coincide, Clipper sometimes returns a wrong union, and rarely for more
  // than one orientation.
  const double area = even_odd_area(rings, contacts);
  if (!(area > negligible)) throw std::domain_error("has no area");
  for (double angle : {0.0, 0.7, 2.0, 4.4}) {
    std::vector<Ring> parts = clipped(rings, angle);
    if (parts.empty()) continue;
    PolygonRegion region(std::move(parts));
    if (std::abs(region.area_ - area) <= negligible) return region;
  }
  throw std::domain_error("its rings overlap in a way that cannot be resolved; draw it without overlaps");
}

PolygonRegion PolygonRegion::placed(PlanePoint origin, double scale) const {
  std::vector<Ring> rings = rings_;
  for (Ring& ring : rings)
    for (PlanePoint& p : ring) p = {scale * (p.x - origin.x), scale * (p.y - origin.y)};
  return PolygonRegion(std::move(rings));
}

}  // namespace aureole::optics
