// SPDX-License-Identifier: Apache-2.0
// Outlines of SVG shapes as lines and cubic Bezier curves, and the grammar of its path data (W3C, Scalable
// Vector Graphics 1.1, 2nd ed. 2011, chapter 8).
#pragma once

#include <string_view>
#include <vector>

#include "aureole/optics/aperture/polygon_region.h"

namespace aureole {

/// x' = a x + c y + e, y' = b x + d y + f: SVG's matrix(a b c d e f).
struct SvgTransform {
  double a = 1, b = 0, c = 0, d = 1, e = 0, f = 0;

  optics::PlanePoint operator()(optics::PlanePoint p) const {
    return {a * p.x + c * p.y + e, b * p.x + d * p.y + f};
  }
  /// Returns the transform that applies `right` first, then this one.
  SvgTransform operator*(const SvgTransform& right) const;
  /// Parses the transform list of an attribute, such as "translate(3, 4) rotate(30)". Throws Error.
  static SvgTransform parse(std::string_view list);
};

class SvgOutline {
public:
  static constexpr std::size_t kMaxSegments = 10000;

  /// Sets the transform of everything added afterwards.
  void set_transform(const SvgTransform& t) { transform_ = t; }
  void move_to(optics::PlanePoint p);
  void line_to(optics::PlanePoint p);
  void cubic_to(optics::PlanePoint control1, optics::PlanePoint control2, optics::PlanePoint end);
  /// Adds SVG's elliptical arc: half axes, their rotation in degrees, and flags that select one of the four
  /// arcs.
  void arc_to(double rx, double ry, double degrees, bool large, bool positive, optics::PlanePoint end);
  void close() { open_ = false; }
  /// Returns the current point, before the transform.
  optics::PlanePoint current() const { return current_; }

  /// Adds the outline that the attribute d of a path describes. Throws Error.
  void add_path(std::string_view data);
  /// Adds the points of a polygon. Throws Error.
  void add_polygon(std::string_view points);
  void add_ellipse(optics::PlanePoint center, double rx, double ry);
  void add_rectangle(double x, double y, double width, double height, double rx, double ry);

  /// Returns one ring for every subpath that encloses an area, with y upward. Curves become chords within
  /// `tolerance` times the size of the picture.
  std::vector<optics::Ring> flattened(double tolerance) const;

private:
  struct Segment {
    optics::PlanePoint control1, control2, end;
    bool is_curve;
  };
  struct Subpath {
    optics::PlanePoint start;
    std::vector<Segment> segments;
  };
  void add(const Segment& s, optics::PlanePoint end);

  SvgTransform transform_;
  std::vector<Subpath> subpaths_;
  std::size_t count_ = 0;
  bool open_ = false;
  optics::PlanePoint start_, current_;
};

/// Parses a length in user units, which are px: a number, plain or with one of CSS's absolute units, or a percentage
/// of `whole`. Throws Error.
double parse_svg_length(std::string_view text, double whole);

}  // namespace aureole
