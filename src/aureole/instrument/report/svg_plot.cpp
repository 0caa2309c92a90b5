// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/report/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace aureole {
namespace {

constexpr double kWidth = 640, kHeight = 420, kLeft = 70, kRight = 20, kTop = 40, kBottom = 55;

struct Axes {
  double x0, x1, y0, y1;
  double px(double x) const { return kLeft + (x - x0) / (x1 - x0) * (kWidth - kLeft - kRight); }
  double py(double y) const { return kHeight - kBottom - (y - y0) / (y1 - y0) * (kHeight - kTop - kBottom); }
};

Axes fit_axes(const Plot& plot) {
  Axes a{INFINITY, -INFINITY, plot.logarithmic ? INFINITY : plot.y_from, -INFINITY};
  for (const PlotSeries& s : plot.series) {
    for (const double x : s.x)
      a.x0 = std::min(a.x0, x - s.bar_width / 2), a.x1 = std::max(a.x1, x + s.bar_width / 2);
    for (const auto* v : {&s.y, &s.low})
      for (const double y : *v) a.y0 = std::min(a.y0, y);
    for (const auto* v : {&s.y, &s.high})
      for (const double y : *v) a.y1 = std::max(a.y1, y);
  }
  if (!(a.x1 > a.x0)) a.x0 = 0, a.x1 = 1;
  if (a.x0 > 0 && a.x0 < 0.3 * a.x1) a.x0 = 0;
  if (!plot.names.empty()) a.x0 = 0.5, a.x1 = double(plot.names.size()) + 0.5;
  if (!(a.y1 > a.y0)) a.y1 = a.y0 + 1;
  a.y1 += 0.05 * (a.y1 - a.y0);
  if (plot.logarithmic) a.y0 = std::floor(a.y0), a.y1 = std::ceil(a.y1 - 0.05);
  return a;
}

/// Returns the plot with logarithms of its values; values without a logarithm are replaced by the smallest
/// value that has one.
Plot logarithms(Plot plot) {
  double least = INFINITY;
  for (const PlotSeries& s : plot.series)
    for (const double y : s.y)
      if (y > 0) least = std::min(least, y);
  if (!std::isfinite(least)) least = 1;
  for (PlotSeries& s : plot.series)
    for (auto* v : {&s.y, &s.low, &s.high})
      for (double& y : *v) y = std::log10(std::max(y, least));
  return plot;
}

std::string color_of(const PlotSeries& s) {
  return !s.color.empty() ? s.color : s.kind == PlotSeries::Kind::points ? "#b0413e" : "#2b5d8f";
}

/// Text of an SVG; powers such as "m^2" and "nm^-1" get raised digits.
std::string escaped(const std::string& text) {
  constexpr const char* kRaised[] = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                     "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  const auto is_digit = [&](size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool is_negative = c == '^' && i + 1 < text.size() && text[i + 1] == '-';
    if (c == '^' && is_digit(i + 1 + is_negative)) {
      if (is_negative) out += "\u207b", ++i;
      for (; is_digit(i + 1); ++i) out += kRaised[text[i + 1] - '0'];
      continue;
    }
    out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  }
  return out;
}

void add_ticks(std::string& out, const Axes& a, const Plot& plot) {
  const bool logarithmic = plot.logarithmic;
  const double sx = round_step(a.x0, a.x1, 8);
  const double sy = logarithmic ? std::max(1.0, round_step(a.y0, a.y1, 9)) : round_step(a.y0, a.y1, 6);
  const auto add_x = [&](double x, const std::string& text) {
    out += fmt::format(
        "<path d=\"M{:.1f} {:.1f}v5\" stroke=\"black\"/><text x=\"{:.1f}\" y=\"{:.1f}\" "
        "text-anchor=\"middle\">{}</text>\n",
        a.px(x), a.py(a.y0), a.px(x), a.py(a.y0) + 19, text);
  };
  for (std::size_t i = 0; i < plot.names.size(); ++i) add_x(double(i + 1), escaped(plot.names[i]));
  if (plot.names.empty())
    for (double x = std::ceil(a.x0 / sx) * sx; x <= a.x1 * (1 + 1e-9); x += sx)
      add_x(x, fmt::format("{:g}", std::abs(x) < 1e-9 * sx ? 0 : x));
  for (double y = std::ceil(a.y0 / sy) * sy; y <= a.y1 * (1 + 1e-9); y += sy)
    out += fmt::format(
        "<path d=\"M{:.1f} {:.1f}h-5\" stroke=\"black\"/><text x=\"{:.1f}\" y=\"{:.1f}\" "
        "text-anchor=\"end\">{}</text>\n",
        a.px(a.x0), a.py(y), a.px(a.x0) - 8, a.py(y) + 4,
        logarithmic ? fmt::format("1e{:g}", std::round(y))
                    : fmt::format("{:g}", std::abs(y) < 1e-9 * sy ? 0 : y));
}

void add_series(std::string& out, const PlotSeries& s, const Axes& a) {
  if (s.kind == PlotSeries::Kind::bars)
    for (size_t i = 0; i < s.x.size(); ++i)
      out += fmt::format(
          "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"#8fb3d9\" "
          "stroke=\"#2b5d8f\"/>\n",
          a.px(s.x[i] - s.bar_width / 2), a.py(s.y[i]), a.px(s.bar_width) - a.px(0),
          a.py(a.y0) - a.py(s.y[i]));
  if (s.kind == PlotSeries::Kind::line) {
    if (!s.low.empty()) {
      out += "<path fill=\"#2b5d8f\" fill-opacity=\"0.25\" d=\"M";
      for (size_t i = 0; i < s.x.size(); ++i)
        out += fmt::format("{:.2f} {:.2f} ", a.px(s.x[i]), a.py(s.high[i]));
      for (size_t i = s.x.size(); i-- > 0;)
        out += fmt::format("{:.2f} {:.2f} ", a.px(s.x[i]), a.py(s.low[i]));
      out += "z\"/>\n";
    }
    out += "<polyline fill=\"none\" stroke=\"" + color_of(s) + "\" stroke-width=\"1.5\" points=\"";
    for (size_t i = 0; i < s.x.size(); ++i) out += fmt::format("{:.2f},{:.2f} ", a.px(s.x[i]), a.py(s.y[i]));
    out += "\"/>\n";
  }
  if (s.kind == PlotSeries::Kind::points)
    for (size_t i = 0; i < s.x.size(); ++i) {
      if (!s.low.empty())
        out += fmt::format("<path d=\"M{0:.2f} {1:.2f}V{2:.2f}\" stroke=\"#2b5d8f\"/>", a.px(s.x[i]),
                           a.py(s.low[i]), a.py(s.high[i]));
      out += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"2\" fill=\"{}\"/>\n", a.px(s.x[i]),
                         a.py(s.y[i]), color_of(s));
    }
}

/// Width beside the axes for a legend of many entries, which would hide lines if it were inside; 0 for few
/// entries.
int legend_width(const Plot& plot) {
  constexpr int kMaxWithin = 4;
  const auto named = std::count_if(plot.series.begin(), plot.series.end(),
                                   [](const PlotSeries& s) { return !s.label.empty(); });
  return named > kMaxWithin ? 160 : 0;
}

/// A rectangle of the picture [px], y down.
struct Box {
  double left, top, right, bottom;
  /// Whether any point of a segment lies inside; false where a coordinate is not finite.
  bool is_crossed(double x0, double y0, double x1, double y1) const {
    // Liang & Barsky 1984: the part of the segment between each pair of parallel edges.
    double near = 0, far = 1;
    for (const auto& [from, along, low, high] :
         {std::array{x0, x1 - x0, left, right}, {y0, y1 - y0, top, bottom}}) {
      if (!std::isfinite(from) || !std::isfinite(along)) return false;
      if (along == 0 && (from < low || from > high)) return false;
      if (along == 0) continue;
      const double a = (low - from) / along, b = (high - from) / along;
      near = std::max(near, std::min(a, b)), far = std::min(far, std::max(a, b));
    }
    return near <= far;
  }
};

/// Whether a curve, a point, an error bar or a bar lies in the box.
bool is_drawn_in(const Plot& plot, const Axes& a, const Box& box) {
  for (const PlotSeries& s : plot.series)
    for (size_t i = 0; i < s.x.size(); ++i) {
      const double x = a.px(s.x[i]), y = a.py(s.y[i]);
      if (!s.low.empty() && box.is_crossed(x, a.py(s.low[i]), x, a.py(s.high[i]))) return true;
      if (s.kind == PlotSeries::Kind::points && box.is_crossed(x, y, x, y)) return true;
      if (s.kind == PlotSeries::Kind::line && i > 0 &&
          box.is_crossed(a.px(s.x[i - 1]), a.py(s.y[i - 1]), x, y))
        return true;
      if (s.kind != PlotSeries::Kind::bars) continue;
      const double half = 0.5 * (a.px(s.bar_width) - a.px(0));
      if (x + half > box.left && x - half < box.right && y < box.bottom) return true;
    }
  return false;
}

/// Lines of a legend, and where it stands.
struct Legend {
  static constexpr double kLine = 18;  ///< height of an entry [px]
  double width = 0, height = 0;        ///< of all entries, with a margin [px]
  double x = 0, y = 0;                 ///< end at which the symbols are; middle of the first entry
  bool is_left = false;                ///< the symbols stand before the text

  /// Finds a corner of the axes without curves, of which the upper right one is the first choice. False if there is none.
  bool fit(const Plot& plot, const Axes& a) {
    constexpr double kMargin = 6;
    for (const bool is_low : {false, true})
      for (const bool left : {false, true}) {
        const double right_end = kWidth - kRight - 12, left_end = kLeft + 16;
        x = left ? left_end : right_end, is_left = left;
        y = is_low ? kHeight - kBottom - 8 - height + 0.5 * kLine : kTop + 8;
        const double from = left ? x : x - width, top = y - 0.5 * kLine;
        if (!is_drawn_in(plot, a,
                         {from - kMargin, top - kMargin, from + width + kMargin, top + height + kMargin}))
          return true;
      }
    return false;
  }
};

Legend legend_of(const Plot& plot) {
  Legend l;
  for (const PlotSeries& s : plot.series) {
    if (s.label.empty()) continue;
    constexpr double kCharacter = 6.8;  // mean width of a character at 12 px
    l.width = std::max(l.width, 26 + kCharacter * double(s.label.size()));
    l.height += Legend::kLine;
  }
  return l;
}

/// The legend in a free corner. Where there is none, the y axis is prolonged until the legend fits above all curves.
Legend place_legend(const Plot& plot, Axes& a) {
  Legend l = legend_of(plot);
  if (l.height == 0 || l.fit(plot, a)) return l;
  const double height = kHeight - kTop - kBottom, free = l.height + 16;
  a.y1 = a.y0 + (a.y1 - a.y0) * height / (height - free);
  if (plot.logarithmic) a.y1 = std::ceil(a.y1);
  l.fit(plot, a);
  return l;
}

void add_legend(std::string& out, const Plot& plot, const Legend& l) {
  double y = l.y;
  const double side = l.is_left ? 1 : -1;
  for (const PlotSeries& s : plot.series) {
    if (s.label.empty()) continue;
    out +=
        s.kind == PlotSeries::Kind::points
            ? fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"3\" fill=\"{}\"/>", l.x + 9 * side, y, color_of(s))
            : fmt::format("<path d=\"M{} {}h18\" stroke=\"{}\" stroke-width=\"2\"/>",
                          l.is_left ? l.x : l.x - 18, y, color_of(s));
    out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"{}\">{}</text>\n", l.x + 26 * side, y + 4,
                       l.is_left ? "start" : "end", escaped(s.label));
    y += Legend::kLine;
  }
}

}  // namespace

double round_step(double low, double high, int count) {
  const double rough = (high - low) / count, power = std::pow(10, std::floor(std::log10(rough)));
  for (const double f : {1.0, 2.0, 5.0})
    if (rough <= f * power) return f * power;
  return 10 * power;
}

std::string svg_plot(const Plot& given) {
  const Plot plot = given.logarithmic ? logarithms(given) : given;
  Axes a = fit_axes(plot);
  const int beside = legend_width(plot), width = kWidth + beside;
  Legend legend;
  if (beside > 0)
    legend.x = width - kRight - 12, legend.y = kTop + 8;
  else
    legend = place_legend(plot, a);
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
      width, kHeight);
  out += fmt::format("<text x=\"{}\" y=\"24\" text-anchor=\"middle\" font-size=\"15\">{}</text>\n",
                     kWidth / 2, escaped(plot.title));
  for (const PlotSeries& s : plot.series) add_series(out, s, a);
  out += fmt::format("<path d=\"M{0} {1}V{2}H{3}\" fill=\"none\" stroke=\"black\"/>\n", kLeft, kTop,
                     kHeight - kBottom, kWidth - kRight);
  add_ticks(out, a, plot);
  add_legend(out, plot, legend);
  out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                     (kLeft + kWidth - kRight) / 2, kHeight - 12, escaped(plot.x_label));
  out += fmt::format(
      "<text transform=\"translate(18 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n</svg>\n",
      (kTop + kHeight - kBottom) / 2, escaped(plot.y_label));
  return out;
}

std::string svg_outline(const std::vector<std::array<double, 2>>& outline, const std::string& comment) {
  double left = INFINITY, right = -INFINITY, low = INFINITY, high = -INFINITY;
  for (const auto& p : outline)
    left = std::min(left, p[0]), right = std::max(right, p[0]), low = std::min(low, p[1]),
    high = std::max(high, p[1]);
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{:.5g} {:.5g} {:.5g} {:.5g}\">\n<!-- {}; 1 unit "
      "is 1 um, the width is {:.5g}um -->\n<path fill=\"black\" d=\"M",
      left * 1e6, -high * 1e6, (right - left) * 1e6, (high - low) * 1e6, comment, (right - left) * 1e6);
  for (size_t i = 0; i < outline.size(); ++i)
    out += fmt::format("{}{:.5g} {:.5g}", i ? " L" : "", outline[i][0] * 1e6, -outline[i][1] * 1e6);
  return out + " Z\"/>\n</svg>\n";
}

}  // namespace aureole
