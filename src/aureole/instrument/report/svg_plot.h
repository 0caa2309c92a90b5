// SPDX-License-Identifier: Apache-2.0
// Plain SVG: one plot with axes, and polygons to scale.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace aureole {

struct PlotSeries {
  enum class Kind { bars, line, points } kind = Kind::line;
  std::vector<double> x, y;
  std::vector<double> low, high;  ///< ends of error bars, or empty; of a line they are a band
  double bar_width = 0;
  std::string label = {};  ///< in the legend, where there is one
  std::string color = {};  ///< of lines and points; empty: the usual one
};

struct Plot {
  std::string title, x_label, y_label;
  std::vector<PlotSeries> series;
  bool logarithmic = false;  ///< the y axis, over the decades of the values; 0 and less are left out
};

/// Axes from 0 (or the least value, where negative) to the largest, with round ticks; decades where
/// logarithmic.
std::string svg_plot(const Plot& plot);

/// One closed path in micrometres, y up, with a viewBox that fits it and its width as the document's.
std::string svg_outline(const std::vector<std::array<double, 2>>& outline_m, const std::string& comment);

/// Steps of 1, 2 or 5 times a power of ten that divide [low, high] into about `count`.
double round_step(double low, double high, int count);

}  // namespace aureole
