// SPDX-License-Identifier: Apache-2.0
#include "aureole/aperture/svg/svg_path.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "aureole/core/error.h"

namespace aureole {

using optics::PlanePoint;

namespace {

PlanePoint operator+(PlanePoint a, PlanePoint b) { return {a.x + b.x, a.y + b.y}; }
PlanePoint operator-(PlanePoint a, PlanePoint b) { return {a.x - b.x, a.y - b.y}; }
PlanePoint operator*(double s, PlanePoint p) { return {s * p.x, s * p.y}; }

/// Reads numbers and letters of attributes, one after the other.
class Reader {
public:
  explicit Reader(std::string_view text) : text_(text) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(what + " at character " + std::to_string(at_ + 1) + " of \"" +
                std::string(text_.substr(0, 40)) + (text_.size() > 40 ? "...\"" : "\""));
  }
  /// Skips separators; returns false at the end of the text.
  bool skip(std::string_view separators = " \t\r\n") {
    while (at_ < text_.size() && separators.find(text_[at_]) != std::string_view::npos) ++at_;
    return at_ < text_.size();
  }
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  char take() { return text_[at_++]; }
  std::size_t at() const { return at_; }

  bool number_follows() {
    skip(kSeparators);
    std::size_t i = at_;
    if (i < text_.size() && (text_[i] == '+' || text_[i] == '-')) ++i;
    if (i < text_.size() && text_[i] == '.') ++i;
    return i < text_.size() && text_[i] >= '0' && text_[i] <= '9';
  }
  double number() {
    if (!number_follows()) fail("expected a number");
    if (text_[at_] == '+') ++at_;
    double value = 0;
    const auto [end, problem] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    // The bound is far beyond any drawing and avoids overflow below.
    if (problem != std::errc() || !(std::abs(value) <= 1e9)) fail("a number is out of range");
    at_ = std::size_t(end - text_.data());
    return value;
  }
  PlanePoint point() {
    const double x = number();
    return {x, number()};
  }
  /// Reads a flag of an arc; flags need no separator.
  bool flag() {
    skip(kSeparators);
    if (peek() != '0' && peek() != '1') fail("expected 0 or 1");
    return take() == '1';
  }

private:
  static constexpr std::string_view kSeparators = " \t\r\n,";
  std::string_view text_;
  std::size_t at_ = 0;
};

double extent(const std::vector<PlanePoint>& points) {
  PlanePoint lower = points.front(), upper = lower;
  for (const PlanePoint& p : points) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
  }
  return std::max(upper.x - lower.x, upper.y - lower.y);
}

}  // namespace

SvgTransform SvgTransform::operator*(const SvgTransform& r) const {
  return {a * r.a + c * r.b, b * r.a + d * r.b,     a * r.c + c * r.d,
          b * r.c + d * r.d, a * r.e + c * r.f + e, b * r.e + d * r.f + f};
}

SvgTransform SvgTransform::parse(std::string_view list) {
  Reader in(list);
  SvgTransform all;
  while (in.skip(" \t\r\n,")) {
    std::string name;
    while (std::isalpha(static_cast<unsigned char>(in.peek()))) name += in.take();
    in.skip();
    if (name.empty() || in.peek() != '(') in.fail("expected a transform such as scale(2)");
    in.take();
    std::vector<double> v;
    while (v.size() <= 6 && in.number_follows()) v.push_back(in.number());
    in.skip();
    const auto takes = [&](const char* which, std::size_t a, std::size_t b) {
      return name == which && (v.size() == a || v.size() == b);
    };
    if (in.peek() != ')') in.fail("expected )");
    SvgTransform t;
    if (takes("matrix", 6, 6))
      t = {v[0], v[1], v[2], v[3], v[4], v[5]};
    else if (takes("translate", 1, 2))
      t.e = v[0], t.f = v.size() > 1 ? v[1] : 0;
    else if (takes("scale", 1, 2))
      t.a = v[0], t.d = v.size() > 1 ? v[1] : v[0];
    else if (takes("rotate", 1, 3)) {
      const double angle = v[0] * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
      t = {c, s, -s, c, 0, 0};
      if (v.size() == 3)
        t = SvgTransform{1, 0, 0, 1, v[1], v[2]} * t * SvgTransform{1, 0, 0, 1, -v[1], -v[2]};
    } else if (takes("skewX", 1, 1))
      t.c = std::tan(v[0] * std::numbers::pi / 180);
    else if (takes("skewY", 1, 1))
      t.b = std::tan(v[0] * std::numbers::pi / 180);
    else
      in.fail("\"" + name + "\" with " + std::to_string(v.size()) + " numbers is not a transform");
    in.take();
    all = all * t;
    for (double x : {all.a, all.b, all.c, all.d, all.e, all.f})
      if (!(std::abs(x) <= 1e12)) in.fail("the transform is out of range");
  }
  return all;
}

void SvgOutline::move_to(PlanePoint p) {
  start_ = current_ = p;
  open_ = false;
}

void SvgOutline::add(const Segment& s, PlanePoint end) {
  if (++count_ > kMaxSegments)
    throw Error("the picture has more than " + std::to_string(kMaxSegments) + " lines and curves");
  if (!open_) {
    // A segment after a closed subpath starts at that subpath's starting point.
    subpaths_.push_back({transform_(start_), {}});
    open_ = true;
  }
  subpaths_.back().segments.push_back(s);
  current_ = end;
}

void SvgOutline::line_to(PlanePoint p) {
  const PlanePoint t = transform_(p);
  add({t, t, t, false}, p);
}

void SvgOutline::cubic_to(PlanePoint control1, PlanePoint control2, PlanePoint end) {
  add({transform_(control1), transform_(control2), transform_(end), true}, end);
}

void SvgOutline::arc_to(double rx, double ry, double degrees, bool large, bool positive, PlanePoint end) {
  const PlanePoint start = current_;
  if (start.x == end.x && start.y == end.y) return;
  rx = std::abs(rx), ry = std::abs(ry);
  if (!(rx > 1e-9 && ry > 1e-9)) return line_to(end);
  // From end points to the centre: SVG 1.1, appendix F.6.5 and, for radii that are too small, F.6.6.
  const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
  const PlanePoint half = 0.5 * (start - end), middle = 0.5 * (start + end);
  const double x = (c * half.x + s * half.y) / rx, y = (-s * half.x + c * half.y) / ry;
  const double length2 = x * x + y * y;
  if (!(length2 > 1e-20)) return line_to(end);
  const double stretch = std::sqrt(std::max(1.0, length2));
  rx *= stretch, ry *= stretch;
  const double off = std::sqrt(std::max(0.0, 1 / length2 - 1)) * (large == positive ? -1 : 1);
  // The centre in units of the half axes: it is at (off y, -off x), the start at (x, y) from the middle of
  // the chord.
  const PlanePoint center{off * y, -off * x};
  const PlanePoint unit{x / stretch, y / stretch};
  const double from = std::atan2(unit.y - center.y, unit.x - center.x),
               to = std::atan2(-unit.y - center.y, -unit.x - center.x);
  double sweep = to - from;
  if (positive && sweep < 0) sweep += 2 * std::numbers::pi;
  if (!positive && sweep > 0) sweep -= 2 * std::numbers::pi;
  // For so short a chord, rounding would decide the direction of the arc.
  if (!large && std::abs(sweep) > 1.001 * std::numbers::pi) return line_to(end);
  const auto place = [&](double u, double v) {
    u = (u + center.x) * rx, v = (v + center.y) * ry;
    return middle + PlanePoint{c * u - s * v, s * u + c * v};
  };
  // A cubic for 45 degrees deviates from its arc by 5e-6 of the radius.
  const int pieces = std::clamp(int(std::ceil(std::abs(sweep) / (std::numbers::pi / 4) - 1e-6)), 1, 8);
  const double step = sweep / pieces, arm = 4.0 / 3 * std::tan(step / 4);
  for (int i = 0; i < pieces; ++i) {
    const double t0 = from + i * step, t1 = t0 + step;
    const double c0 = std::cos(t0), s0 = std::sin(t0), c1 = std::cos(t1), s1 = std::sin(t1);
    cubic_to(place(c0 - arm * s0, s0 + arm * c0), place(c1 + arm * s1, s1 - arm * c1),
             i + 1 == pieces ? end : place(c1, s1));
  }
}

void SvgOutline::add_ellipse(PlanePoint center, double rx, double ry) {
  const PlanePoint right{center.x + rx, center.y};
  move_to(right);
  arc_to(rx, ry, 0, false, true, {center.x - rx, center.y});
  arc_to(rx, ry, 0, false, true, right);
  close();
}

void SvgOutline::add_rectangle(double x, double y, double width, double height, double rx, double ry) {
  rx = std::clamp(rx, 0.0, width / 2), ry = std::clamp(ry, 0.0, height / 2);
  const auto corner = [&](PlanePoint p) {
    if (rx > 0 && ry > 0) arc_to(rx, ry, 0, false, true, p);
  };
  move_to({x + rx, y});
  line_to({x + width - rx, y});
  corner({x + width, y + ry});
  line_to({x + width, y + height - ry});
  corner({x + width - rx, y + height});
  line_to({x + rx, y + height});
  corner({x, y + height - ry});
  line_to({x, y + ry});
  corner({x + rx, y});
  close();
}

void SvgOutline::add_polygon(std::string_view points) {
  Reader in(points);
  for (bool first = true; in.number_follows(); first = false) {
    const PlanePoint p = in.point();
    first ? move_to(p) : line_to(p);
  }
  if (in.skip()) in.fail("expected a number");
  close();
}

void SvgOutline::add_path(std::string_view data) {
  Reader in(data);
  char previous = '\0';  // the last command, in upper case
  PlanePoint last_control;
  while (in.skip(" \t\r\n,")) {
    const std::size_t begin = in.at();
    const char letter = in.peek(), command = char(std::toupper(static_cast<unsigned char>(letter)));
    if (std::string_view("MLHVCSQTAZ").find(command) == std::string_view::npos)
      in.fail("expected one of M L H V C S Q T A Z");
    if (previous == '\0' && command != 'M') in.fail("path data must begin with M");
    in.take();
    const bool relative = letter != command;
    if (command == 'Z') {
      close();
      current_ = start_;
      previous = command;
      continue;
    }
    bool first = true;
    do {
      const PlanePoint at = current_, base = relative ? at : PlanePoint{};
      const auto point = [&] { return base + in.point(); };
      switch (command) {
        case 'M':
          first ? move_to(point()) : line_to(point());
          break;
        case 'L':
          line_to(point());
          break;
        case 'H':
          line_to({base.x + in.number(), at.y});
          break;
        case 'V':
          line_to({at.x, base.y + in.number()});
          break;
        case 'C':
        case 'S': {
          PlanePoint control = at;
          if (command == 'C')
            control = point();
          else if (previous == 'C' || previous == 'S')
            control = 2 * at - last_control;
          last_control = point();
          cubic_to(control, last_control, point());
          break;
        }
        case 'Q':
        case 'T': {
          if (command == 'Q')
            last_control = point();
          else
            last_control = previous == 'Q' || previous == 'T' ? 2 * at - last_control : at;
          const PlanePoint end = point();
          cubic_to(at + (2.0 / 3) * (last_control - at), end + (2.0 / 3) * (last_control - end), end);
          break;
        }
        default: {
          const double rx = in.number(), ry = in.number(), degrees = in.number();
          const bool large = in.flag(), positive = in.flag();
          arc_to(rx, ry, degrees, large, positive, point());
        }
      }
      // The bound is checked at each step, since relative steps accumulate.
      if (!(std::abs(current_.x) <= 1e12 && std::abs(current_.y) <= 1e12))
        in.fail("the path leaves the range");
      previous = command;
      first = false;
    } while (in.number_follows());
    if (in.at() == begin) in.fail("path data make no sense");
  }
  open_ = false;
}

std::vector<optics::Ring> SvgOutline::flattened(double tolerance) const {
  const auto at = [](PlanePoint start, const Segment& s, double t) {
    const double u = 1 - t;
    return u * u * u * start + 3 * u * u * t * s.control1 + 3 * u * t * t * s.control2 + t * t * t * s.end;
  };
  const auto each = [&](auto&& begin, auto&& segment) {
    for (const Subpath& path : subpaths_) {
      begin(path.start);
      PlanePoint start = path.start;
      for (const Segment& s : path.segments) segment(start, s), start = s.end;
    }
  };
  std::vector<PlanePoint> probes;
  each([&](PlanePoint p) { probes.push_back(p); },
       [&](PlanePoint start, const Segment& s) {
         for (double t : {0.25, 0.5, 0.75, 1.0})
           if (s.is_curve || t == 1) probes.push_back(at(start, s, t));
       });
  if (probes.empty()) return {};
  const double allowed = tolerance * extent(probes);
  std::vector<optics::Ring> rings;
  const auto add = [&](PlanePoint p) { rings.back().push_back({p.x, -p.y}); };
  std::size_t count = 0;
  each([&](PlanePoint p) { rings.emplace_back(), add(p); },
       [&](PlanePoint start, const Segment& s) {
         int pieces = 1;
         if (s.is_curve && allowed > 0) {
           // A chord over a step dt deviates from the curve by at most dt^2/8 max|p''|; p'' varies linearly
           // between 6 d0 and 6 d1.
           const PlanePoint d0 = start - 2 * s.control1 + s.control2,
                            d1 = s.control1 - 2 * s.control2 + s.end;
           const double bend = std::max(std::hypot(d0.x, d0.y), std::hypot(d1.x, d1.y));
           pieces = int(std::clamp(std::ceil(std::sqrt(0.75 * bend / allowed)), 1.0, 1000.0));
         }
         count += std::size_t(pieces);
         if (count > optics::PolygonRegion::kMaxVertices)
           throw Error("the outlines have more than " + std::to_string(optics::PolygonRegion::kMaxVertices) +
                       " vertices once curves are polygons");
         for (int i = 1; i < pieces; ++i) add(at(start, s, double(i) / pieces));
         add(s.end);
       });
  return rings;
}

double parse_svg_length(std::string_view text, double whole) {
  // CSS Values and Units Module Level 3, section 5.2: an inch is 96 px.
  static constexpr std::pair<std::string_view, double> kUnits[] = {
      {"px", 1},         {"mm", 96 / 25.4}, {"cm", 96 / 2.54}, {"in", 96},
      {"pt", 96 / 72.0}, {"pc", 16},        {"Q", 96 / 101.6}};
  Reader in(text);
  const double value = in.number();
  if (!in.skip()) return value;
  const std::string_view unit = text.substr(in.at(), text.find_last_not_of(" \t\r\n") + 1 - in.at());
  if (unit == "%") {
    if (!(whole > 0)) in.fail("a percentage needs the viewBox or the width and height of the <svg>");
    return value / 100 * whole;
  }
  for (const auto& [name, size] : kUnits)
    if (unit == name) return value * size;
  in.fail("expected px, mm, cm, in, pt, pc, Q, % or no unit");
}

}  // namespace aureole
