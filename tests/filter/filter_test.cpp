// SPDX-License-Identifier: Apache-2.0
// Reconstruction filters against the formulas of their sources, and the table that films use.
#include "aureole/filter/filter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "aureole/plugin/registry.h"
#include "tests/harness/properties_builder.h"

namespace aureole::testing {
namespace {

std::shared_ptr<Filter> make(const std::string& type, const std::string& parameters = "") {
  return build<Filter>("<rfilter type=\"" + type + "\">" + parameters + "</rfilter>");
}
std::string number(const std::string& name, double value) {
  return "<float name=\"" + name + "\" value=\"" + std::to_string(value) + "\"/>";
}

/// The cubic of Mitchell & Netravali by its two pieces in the Bernstein form of a spline: B-spline and
/// cardinal parts.
double bc_spline(double x, double b, double c) {
  x = std::abs(x);
  const double b_spline = x < 1 ? 2.0 / 3 - x * x + x * x * x / 2 : x < 2 ? std::pow(2 - x, 3) / 6 : 0;
  // The cardinal cubic with a = -1/2 (Catmull-Rom) and its derivative by `a` (Keys 1981).
  const auto keys = [&](double a) {
    return x < 1   ? (a + 2) * x * x * x - (a + 3) * x * x + 1
           : x < 2 ? a * (x * x * x - 5 * x * x + 8 * x - 4)
                   : 0;
  };
  // B = 1, C = 0 is the B-spline and B = 0 gives Keys's a = -C; the family is linear in B and C.
  return b * b_spline + (1 - b) * keys(0) + (keys(-c) - keys(0));
}

TEST(Filter, Values) {
  for (double x = -3.5; x <= 3.5; x += 0.0173) {
    const double a = std::abs(x);
    const auto at = [&](const std::shared_ptr<Filter>& f) { return double(f->eval(float(x))); };
    EXPECT_EQ(at(make("box")), a <= 0.5 ? 1 : 0);
    EXPECT_NEAR(at(make("tent")), std::max(0.0, 1 - a), 1e-6);
    EXPECT_NEAR(at(make("tent", number("radius", 2.5))), std::max(0.0, 1 - a / 2.5), 1e-6);
    EXPECT_NEAR(at(make("gaussian")), a < 2 ? std::exp(-2 * x * x) - std::exp(-8) : 0, 1e-6);
    EXPECT_NEAR(at(make("gaussian", number("stddev", 0.8))),
                a < 3.2 ? std::exp(-x * x / 1.28) - std::exp(-8) : 0, 1e-6);
    EXPECT_NEAR(at(make("mitchell")), bc_spline(x, 1.0 / 3, 1.0 / 3), 1e-5);
    EXPECT_NEAR(at(make("mitchell", number("B", 1) + number("C", 0))), bc_spline(x, 1, 0), 1e-5);
    EXPECT_NEAR(at(make("mitchell", number("B", 0.2) + number("C", 0.7))), bc_spline(x, 0.2, 0.7), 1e-5);
    EXPECT_NEAR(at(make("catmullrom")), bc_spline(x, 0, 0.5), 1e-5);
    for (int lobes : {1, 2, 3}) {
      const auto sinc = [](double t) { return t == 0 ? 1 : std::sin(M_PI * t) / (M_PI * t); };
      EXPECT_NEAR(at(make("lanczos", "<integer name=\"lobes\" value=\"" + std::to_string(lobes) + "\"/>")),
                  a < lobes ? sinc(x) * sinc(x / lobes) : 0, 1e-5)
          << x;
    }
  }
}

TEST(Filter, Errors) {
  EXPECT_THROW(make("tent", number("radius", 0.1)), Error);
  EXPECT_THROW(make("gaussian", number("stddev", 0)), Error);
  EXPECT_THROW(make("gaussian", number("stddev", 100)), Error);
  EXPECT_THROW(make("lanczos", "<integer name=\"lobes\" value=\"0\"/>"), Error);
  EXPECT_THROW(make("mitchell", number("B", 3)), Error);
}

std::vector<std::string> all_filters() {
  std::vector<std::string> names;
  for (const PluginInfo& p : Registry::instance().all())
    if (p.family == "rfilter" && !p.name.starts_with("test_")) names.push_back(p.name);
  return names;
}

class EveryFilter : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryFilter, SupportAndSymmetry) {
  const auto f = make(GetParam());
  ASSERT_GT(f->radius(), 0);
  float outermost = 0;
  for (float x = 0; x < f->radius() + 3; x += 0.001f) {
    ASSERT_EQ(f->eval(x), f->eval(-x));
    if (f->eval(x) != 0) outermost = x;
    if (x > f->radius() + 1e-6f) {
      ASSERT_EQ(f->eval(x), 0) << x;
    }
  }
  EXPECT_GT(outermost, f->radius() - 0.002f) << "the support is stated too wide";
  EXPECT_LE(std::abs(f->eval(0)), 1.01f);
}

TEST_P(EveryFilter, TableIsTheFilter) {
  const auto f = make(GetParam());
  const FilterTable table(*f);
  EXPECT_EQ(table.radius(), f->radius());
  double largest = 0;
  for (int k = -200000; k <= 200000; ++k) {
    const float x = float(k) * 1.03e-5f * f->radius();
    // A box ends at its radius; there the table may give either side.
    if (GetParam() == "box" && std::abs(std::abs(x) - 0.5f) < 1e-6f) continue;
    largest = std::max(largest, double(std::abs(table.eval(x) - f->eval(x))));
  }
  EXPECT_LT(largest, 1e-5 * std::abs(f->eval(0)));
  RecordProperty("largest_error", std::to_string(largest));
}

TEST_P(EveryFilter, BorderReachesEveryPixelOfTheSupport) {
  const auto f = make(GetParam());
  const FilterTable table(*f);
  // A sample anywhere in pixel 0; pixel k has its centre at k + 1/2.
  int reach = 0;
  for (float s = 0; s <= 1; s += 1.f / 4096)
    for (int k = -20; k <= 20; ++k)
      if (std::abs(f->eval(float(k) + 0.5f - s)) > 1e-6f && !(k != 0 && GetParam() == "box"))
        reach = std::max(reach, std::abs(k));
  EXPECT_EQ(table.border(), reach);
  EXPECT_EQ(table.is_box(), GetParam() == "box");
}

INSTANTIATE_TEST_SUITE_P(Filters, EveryFilter, ::testing::ValuesIn(all_filters()),
                         [](const auto& info) { return info.param; });

TEST(Filter, WideOnesKeepTheirBorder) {
  EXPECT_EQ(FilterTable(*make("gaussian")).border(), 2);
  EXPECT_EQ(FilterTable(*make("box")).border(), 0);
  EXPECT_EQ(FilterTable(*make("tent", number("radius", 0.6))).border(), 1);
  EXPECT_EQ(FilterTable(*make("tent", number("radius", 32))).border(), 32);
  EXPECT_EQ(FilterTable(*make("lanczos", "<integer name=\"lobes\" value=\"16\"/>")).border(), 16);
  EXPECT_EQ(FilterTable(*make("gaussian", number("stddev", 8))).border(), 32);
}

}  // namespace
}  // namespace aureole::testing
