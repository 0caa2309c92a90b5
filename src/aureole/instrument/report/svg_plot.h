// SPDX-License-Identifier: Apache-2.0
// Plain SVG: a plot with axes, and polygons to scale.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace aureole {

struct PlotSeries {
  enum class Kind { bars, line, points } kind = Kind::line;
  std::vector<double> x, y;
  std::vector<double> low, high;  ///< ends of error bars, or empty; for a line they form a band
  double bar_width = 0;
  std::string label = {};  ///< legend entry, if any
  std::string color = {};  ///< color of lines and points; empty: the default colour
};

struct Plot {
  std::string title, x_label, y_label;
  std::vector<PlotSeries> series;
  bool logarithmic = false;  ///< logarithmic y axis over the decades of the values; values <= 0 are omitted
  std::vector<std::string> names = {};  ///< names of x = 1, 2 and so on, which replace its ticks; or empty
  double y_from = 0;  ///< lower end of a linear y axis, where it is positive and below all values
};

/// Plots with axes from 0 (or the least value, if negative, or `y_from`) to the largest, with round ticks; decades if
/// logarithmic.
std::string svg_plot(const Plot& plot);

/// Draws one closed path in micrometres, y up, with a viewBox that fits it and its actual width as document
/// width.
std::string svg_outline(const std::vector<std::array<double, 2>>& outline_m, const std::string& comment);

/// Returns a step of 1, 2 or 5 times a power of ten that divides [low, high] into about `count` steps.
double round_step(double low, double high, int count);

}  // namespace aureole
