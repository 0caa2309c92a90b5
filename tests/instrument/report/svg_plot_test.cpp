// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/report/svg_plot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

namespace aureole::test {
namespace {

int count(const std::string& text, const std::string& what) {
  int n = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++n;
  return n;
}

/// y of the points of the first line, in pixels.
std::vector<double> line_y(const std::string& svg) {
  const std::size_t from = svg.find("points=\"") + 8;
  const std::string points = svg.substr(from, svg.find('"', from) - from);
  std::vector<double> out;
  const std::regex pair("[0-9.]+,([0-9.]+)");
  for (auto i = std::sregex_iterator(points.begin(), points.end(), pair); i != std::sregex_iterator(); ++i)
    out.push_back(std::stod((*i)[1]));
  return out;
}

TEST(SvgPlot, DecadesHaveEqualSteps) {
  PlotSeries s;
  s.x = {0, 1, 2, 3, 4}, s.y = {1e-3, 1e-2, 1e-1, 1, 0};
  const std::string svg = svg_plot({"t", "x", "y", {s}, true});
  const auto y = line_y(svg);
  ASSERT_EQ(y.size(), 5u);
  for (int i = 1; i < 3; ++i) EXPECT_NEAR(y[std::size_t(i)] - y[std::size_t(i) + 1], y[0] - y[1], 0.02);
  EXPECT_GT(y[0], y[3]) << "larger values are higher";
  EXPECT_EQ(y[4], y[0]) << "0 is drawn at the least value";
  for (const char* tick : {">1e-3<", ">1e-2<", ">1e-1<", ">1e0<"}) EXPECT_EQ(count(svg, tick), 1) << tick;
}

TEST(SvgPlot, LegendNamesWhatHasALabelInItsColor) {
  PlotSeries line, points, unnamed;
  for (PlotSeries* s : {&line, &points, &unnamed}) s->x = {0, 1}, s->y = {1, 2};
  line.label = "a < b", line.color = "#123456";
  points.kind = PlotSeries::Kind::points, points.label = "dots";
  const std::string svg = svg_plot({"t", "x", "y", {line, points, unnamed}});
  EXPECT_EQ(count(svg, ">a &lt; b<"), 1);
  EXPECT_EQ(count(svg, ">dots<"), 1);
  EXPECT_EQ(count(svg, "#123456"), 2) << "the line and its sample";
  EXPECT_EQ(count(svg, "<circle"), 3) << "two points and their sample";
}

TEST(SvgPlot, LegendKeepsClearOfCurves) {
  const auto symbol = [](const std::string& svg) {
    std::smatch found;
    EXPECT_TRUE(std::regex_search(svg, found, std::regex("<path d=\"M([0-9.]+) ([0-9.]+)h18")));
    return std::pair(std::stod(found[1]), std::stod(found[2]));
  };
  // A curve in the upper corners and one that falls: the lower left corner is free.
  PlotSeries constant, falling;
  for (int x = 0; x <= 9; ++x) {
    constant.x.push_back(x), constant.y.push_back(9);
    falling.x.push_back(x), falling.y.push_back(9 - x);
  }
  falling.label = "falls in 10 m^2 nm^-1";
  const std::string one = svg_plot({"t", "x", "y", {constant, falling}});
  EXPECT_LT(symbol(one).first, 200);
  EXPECT_GT(symbol(one).second, 300);
  EXPECT_EQ(count(one, "10 m\u00b2 nm\u207b\u00b9<"), 1) << one;
  // Curves in all corners: the legend stands above all of them.
  PlotSeries rising = falling;
  for (double& y : rising.y) y = 9 - y;
  const std::string both = svg_plot({"t", "x", "y", {falling, rising}});
  const std::vector<double> y = line_y(both);
  EXPECT_LT(symbol(both).second + 18 + 5, *std::min_element(y.begin(), y.end()));
}

TEST(SvgPlot, NamesReplaceTicksAndAnAxisMayBeginAboveZero) {
  PlotSeries points{.kind = PlotSeries::Kind::points, .x = {1, 2}, .y = {0.28, 0.31}, .low = {}, .high = {}};
  Plot plot{"t", "x", "y", {points}};
  plot.names = {"45a:0", "de<8"}, plot.y_from = 0.26;
  const std::string svg = svg_plot(plot);
  EXPECT_EQ(count(svg, ">45a:0</text>"), 1);
  EXPECT_EQ(count(svg, ">de&lt;8</text>"), 1);
  EXPECT_EQ(count(svg, ">1.5</text>"), 0);
  EXPECT_EQ(count(svg, ">0.26</text>"), 1);
  EXPECT_EQ(count(svg, ">0</text>"), 0);
  // Points stand a quarter and three quarters of the way along the axis.
  std::smatch found;
  ASSERT_TRUE(std::regex_search(svg, found, std::regex("<circle cx=\"([0-9.]+)\"")));
  EXPECT_NEAR(std::stod(found[1]), 70 + 0.25 * 550, 0.01);
  // Values below the stated end lower it.
  plot.series[0].y[0] = 0.1;
  EXPECT_EQ(count(svg_plot(plot), ">0.26</text>"), 0);
}

}  // namespace
}  // namespace aureole::test
