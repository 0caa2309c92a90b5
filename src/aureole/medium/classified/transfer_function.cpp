// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/classified/transfer_function.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/image.h"
#include "aureole/medium/classified/color_maps.h"
#include "aureole/plugin/number_list.h"
#include "aureole/plugin/properties.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/upsampled_color.h"

namespace aureole {

namespace {

using Curve = TransferFunction::Curve;

constexpr double kMaxOpacity = TransferFunction::kMaxOpacity;
/// Number of linear pieces that replace a curve between two points where it is not linear.
constexpr int kPieces = 32;

/// Returns the components of a curve at a value. At a jump it is the limit from larger values, or with `from_below`
/// from smaller values.
std::array<double, 3> at_value(const Curve& curve, double value, bool from_below) {
  const auto& v = curve.values;
  const auto next =
      from_below ? std::lower_bound(v.begin(), v.end(), value) : std::upper_bound(v.begin(), v.end(), value);
  if (next == v.begin()) return curve.numbers.front();
  if (next == v.end()) return curve.numbers.back();
  const std::size_t i = std::size_t(next - v.begin());
  const double t = (value - v[i - 1]) / (v[i] - v[i - 1]);
  std::array<double, 3> out;
  for (std::size_t k = 0; k < 3; ++k)
    out[k] = curve.numbers[i - 1][k] + t * (curve.numbers[i][k] - curve.numbers[i - 1][k]);
  return out;
}

/// Returns colours that are linear between points of sRGB-encoded numbers as linear sRGB, with more points between.
Curve decoded(const Curve& curve) {
  Curve out;
  for (std::size_t i = 0; i < curve.values.size(); ++i) {
    const bool goes_on = i + 1 < curve.values.size() && curve.values[i + 1] > curve.values[i];
    for (int k = 0; k < (goes_on ? kPieces : 1); ++k) {
      const std::size_t next = k > 0 ? i + 1 : i;
      const double t = double(k) / kPieces;
      const auto between = [t](double a, double b) { return a + t * (b - a); };
      out.values.push_back(between(curve.values[i], curve.values[next]));
      std::array<double, 3>& numbers = out.numbers.emplace_back();
      for (std::size_t c = 0; c < 3; ++c)
        numbers[c] = double(srgb_decode(float(between(curve.numbers[i][c], curve.numbers[next][c]))));
    }
  }
  return out;
}

/// Returns the extinction of a layer of thickness `unit` by its opacity. Between points it is divided into pieces of equal
/// changes of the extinction, within each of which it is linear.
Curve extinction_of(const Curve& opacity, double unit) {
  const auto thickness = [&](std::size_t i) {
    return -std::log1p(-std::min(opacity.numbers[i][0], kMaxOpacity));
  };
  Curve out;
  for (std::size_t i = 0; i < opacity.values.size(); ++i) {
    out.values.push_back(opacity.values[i]), out.numbers.push_back({thickness(i) / unit, 0, 0});
    if (i + 1 == opacity.values.size() || opacity.values[i] == opacity.values[i + 1] ||
        thickness(i) == thickness(i + 1))
      continue;
    const double from = -std::expm1(-thickness(i)), to = -std::expm1(-thickness(i + 1));
    for (int k = 1; k < kPieces; ++k) {
      const double t = thickness(i) + (thickness(i + 1) - thickness(i)) * k / kPieces,
                   part = (-std::expm1(-t) - from) / (to - from);
      out.values.push_back(opacity.values[i] + part * (opacity.values[i + 1] - opacity.values[i]));
      out.numbers.push_back({t / unit, 0, 0});
    }
  }
  return out;
}

/// The colours of a map, spread over the values from `low` to `high`.
Curve spread(const ColorMap& map, double low, double high) {
  Curve curve;
  for (std::size_t i = 0; i < map.colors.size(); ++i) {
    curve.values.push_back(low + (high - low) * double(i) / double(map.colors.size() - 1));
    curve.numbers.push_back({map.colors[i][0], map.colors[i][1], map.colors[i][2]});
  }
  return curve;
}

Curve pairs_of(std::span<const std::array<double, 2>> points) {
  Curve curve;
  for (const auto& [value, number] : points)
    curve.values.push_back(value), curve.numbers.push_back({number, 0, 0});
  return curve;
}

Curve colors_of(std::span<const std::array<double, 4>> points) {
  Curve curve;
  for (const auto& [value, r, g, b] : points)
    curve.values.push_back(value), curve.numbers.push_back({r, g, b});
  return curve;
}

}  // namespace

ColorWeights ColorWeights::of_linear_rgb(float r, float g, float b) {
  const float white = std::min({r, g, b});
  return {white, r - white, g - white, b - white};
}

ColorBasis::ColorBasis(const Spectrum& nm) {
  static const UpsampledColor red = UpsampledColor::of_rgb(1, 0, 0), green = UpsampledColor::of_rgb(0, 1, 0),
                              blue = UpsampledColor::of_rgb(0, 0, 1);
  const Spectrum in_range = UpsampledColor::model_range(nm);
  red_ = red.eval(in_range), green_ = green.eval(in_range), blue_ = blue.eval(in_range);
}

TransferFunction::Curve TransferFunction::read_curve(const Properties& p, const char* name, std::size_t count,
                                                     double most, const char* example) {
  const std::vector<double> list = get_number_list(p, name);
  if (list.empty() || list.size() % (count + 1) != 0)
    throw p.error(name,
                  fmt::format("expected a value and {} at each point, such as \"{}\", but found {} numbers",
                              count == 1 ? "one number" : "red, green and blue", example, list.size()));
  Curve curve;
  for (std::size_t i = 0; i < list.size(); i += count + 1) {
    std::array<double, 3> numbers{};
    for (std::size_t k = 0; k < count; ++k) {
      numbers[k] = list[i + 1 + k];
      if (!(numbers[k] >= 0 && numbers[k] <= most))
        throw p.error(name, fmt::format("at the value {:g} stands {:g}; numbers from 0 to {:g} are possible",
                                        list[i], numbers[k], most));
    }
    const auto n = curve.values.size();
    if (n > 0 && list[i] < curve.values.back())
      throw p.error(name,
                    fmt::format("values must ascend, but {:g} follows {:g}", list[i], curve.values.back()));
    if (n > 1 && list[i] == curve.values[n - 2])
      throw p.error(name, fmt::format("the value {:g} stands three times; twice makes a jump", list[i]));
    curve.values.push_back(list[i]), curve.numbers.push_back(numbers);
  }
  return curve;
}

TransferFunction::TransferFunction(const Curve& extinction, const Curve& color) {
  std::vector<double> values = extinction.values;
  values.insert(values.end(), color.values.begin(), color.values.end());
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  if (values.size() == 1) values.push_back(values[0] + std::max(1.0, std::abs(values[0])));
  const auto add = [&](double value, bool from_below) {
    Node node;
    node.value = float(value);
    node.extinction = float(at_value(extinction, value, from_below)[0]);
    const auto [r, g, b] = at_value(color, value, from_below);
    node.color = ColorWeights::of_linear_rgb(float(r), float(g), float(b));
    max_extinction_ = std::max(max_extinction_, node.extinction);
    nodes_.push_back(node);
  };
  for (const double value : values) {
    const bool jumps = at_value(extinction, value, true) != at_value(extinction, value, false) ||
                       at_value(color, value, true) != at_value(color, value, false);
    if (jumps) add(value, true);
    add(value, false);
  }
  for (std::size_t i = 0; i + 1 < nodes_.size(); ++i) {
    const float width = nodes_[i + 1].value - nodes_[i].value;
    // An interval so narrow that its inverse overflows counts as a jump.
    if (const float inverse = 1 / width; width > 0 && inverse < kInfinity) nodes_[i].inverse_width = inverse;
  }
  first_ = nodes_.front().value, last_interval_ = nodes_.size() - 2;
  const float last = nodes_.back().value;
  scale_ = last > first_ ? float(kBuckets) / (last - first_) : 0.f;
  starts_.resize(kBuckets);
  std::size_t i = 0;
  for (std::size_t k = 0; k < kBuckets; ++k) {
    // Starts a little early, so that rounding of a value's bucket never skips a node.
    const double begin =
        double(first_) + (double(k) - 0.02) * (double(last) - double(first_)) / double(kBuckets);
    while (i + 2 < nodes_.size() && nodes_[i + 1].value <= begin) ++i;
    starts_[k] = std::uint32_t(i);
  }
  std::vector<float> extinctions;
  for (const Node& node : nodes_) extinctions.push_back(node.extinction);
  extinctions_ = RangeMaximum(std::move(extinctions));
  integrals_.resize(nodes_.size());
  for (std::size_t k = 1; k < nodes_.size(); ++k) {
    integrals_[k] = integrals_[k - 1];
    integrals_[k].add(nodes_[k - 1], nodes_[k], double(nodes_[k].value) - double(nodes_[k - 1].value));
  }
}

void TransferFunction::Integral::add(const Sample& from, const Sample& to, double width) {
  const double a = double(from.extinction), b = double(to.extinction);
  extinction += width * 0.5 * (a + b);
  const float* const c = &from.color.white;
  const float* const d = &to.color.white;
  for (std::size_t k = 0; k < 4; ++k)  // Integral of the product of two linear functions.
    color[k] += width / 6 * (a * (2 * double(c[k]) + double(d[k])) + b * (double(c[k]) + 2 * double(d[k])));
}

TransferFunction::Integral TransferFunction::integral_to(std::size_t i, float value,
                                                         const Sample& end) const {
  // Before the first node and behind the last one the function is constant.
  if (value >= nodes_.back().value) i = nodes_.size() - 1;
  Integral sum = integrals_[i];
  sum.add(nodes_[i], end, double(value) - double(nodes_[i].value));
  return sum;
}

TransferFunction::Sample TransferFunction::mean(float a, float b) const {
  const float low = std::min(a, b), high = std::max(a, b);
  const std::size_t i = interval(low), j = interval(high);
  const Sample first = at_in(i, low), last = at_in(j, high);
  // Differences of integrals lose digits where the values are close; there the function is nearly linear.
  const bool is_linear = i == j && low >= nodes_.front().value && high <= nodes_.back().value;
  if (is_linear || high - low <= 1e-5f * std::max(std::abs(high), std::abs(low))) {
    const float extinction = 0.5f * (first.extinction + last.extinction);
    const float weight = extinction > 0 ? (first.extinction + 2 * last.extinction) / (6 * extinction) : 0.5f;
    return {extinction, mixed(first.color, last.color, weight)};
  }
  // An interval without extinction needs no integrals; many along a ray have none.
  if (first.extinction == 0 && last.extinction == 0 && extinctions_.of(i, j + 1) == 0)
    return {0, first.color};
  const Integral from = integral_to(i, low, first), to = integral_to(j, high, last);
  const double extinction = to.extinction - from.extinction;
  Sample out;
  if (!(extinction > 0)) return {0, first.color};
  out.extinction = float(extinction / (double(high) - double(low)));
  float* c = &out.color.white;
  for (std::size_t k = 0; k < 4; ++k) c[k] = float((to.color[k] - from.color[k]) / extinction);
  return out;
}

float TransferFunction::max_extinction(float low, float high) const {
  float most = std::max(at(low).extinction, at(high).extinction);
  const auto first = std::lower_bound(nodes_.begin(), nodes_.end(), low,
                                      [](const Node&n, float value) { return n.value < value; }),
             last = std::upper_bound(first, nodes_.end(), high,
                                     [](float value, const Node&n) { return value < n.value; });
  if (first < last)
    most = std::max(most,
                    extinctions_.of(std::size_t(first - nodes_.begin()), std::size_t(last - nodes_.begin())));
  return most;
}

void note_limited_opacity(const Properties& p, const char* name) {
  p.note(name, fmt::format("opacities above {:g} in a unit of length count as {:g}, because an opacity of 1 "
                           "needs an infinite extinction",
                           kMaxOpacity, kMaxOpacity));
}

double opacity_unit_length(const Properties& p) {
  constexpr const char* kName = "opacity_unit_length";
  bool has_millimetres = false, has_others = false;
  if (p.has("preset") && !p.has(kName)) {
    const std::string presets = p.get_string("preset");
    for (const std::string& name : transfer_preset_names())
      if (presets.find(name) != presets.npos)
        (find_transfer_preset(name)->is_of_millimetres ? has_millimetres : has_others) = true;
  }
  const double millimetre = 1e-3 / p.context().length_unit_m;
  if (has_millimetres) {
    for (const char* name : {"opacity", "extinction", "boxes", "triangles", "table"})
      has_others |= p.has(name);
    // Without a mask the opacities or extinctions replace those of the preset.
    if (has_others && !p.has("mask")) has_millimetres = false;
    if (has_millimetres && has_others && std::abs(millimetre - 1) > 1e-9)
      throw p.error(
          "preset",
          "the opacities of presets of CT and MR are those of 1 mm, but this volume has others, too, and the "
          "scene's unit of length is another one: state \"opacity_unit_length\" for all");
  }
  return p.get_float(kName, has_millimetres ? millimetre : 1, Range::positive());
}

TransferFunction TransferFunction::read(const Properties& p) {
  const double unit = opacity_unit_length(p);
  const std::string preset_name = p.get_string("preset", ""), map_name = p.get_string("color_map", "");
  const std::string encoding = p.get_choice("color_encoding", "linear", {"linear", "srgb"});
  bool is_srgb = encoding == "srgb";
  Curve color{{0}, {{1, 1, 1}}};
  std::optional<Curve> opacity;
  if (!preset_name.empty()) {
    const TransferPreset* preset = find_transfer_preset(preset_name);
    if (!preset)
      throw p.error("preset", "unknown preset \"" + preset_name + "\"" +
                                  did_you_mean_or_all(preset_name, transfer_preset_names()));
    color = colors_of(preset->colors), opacity = pairs_of(preset->opacities), is_srgb = true;
  }
  if (!map_name.empty()) {
    const ColorMap* map = find_color_map(map_name);
    if (!map)
      throw p.error("color_map", "unknown colour map \"" + map_name + "\"" +
                                     did_you_mean_or_all(map_name, color_map_names()));
    const std::vector<double> range =
        p.has("range") ? get_number_list(p, "range") : std::vector<double>{0, 1};
    if (range.size() != 2 || !(range[0] < range[1]))
      throw p.error("range", "expected two ascending numbers, such as \"-1000, 2000\"");
    color = spread(*map, range[0], range[1]), is_srgb = true;
  } else if (p.has("range")) {
    get_number_list(p, "range");
    throw p.error("range", "is for a colour map, and \"color_map\" is missing");
  }
  if (p.has("colors")) {
    if (!map_name.empty()) throw p.error("colors", "give either \"colors\" or \"color_map\"");
    color = read_curve(p, "colors", 3, 1, "0 0 0 0, 100 1 0.8 0.6"), is_srgb = encoding == "srgb";
  }
  if (is_srgb) color = decoded(color);
  if (p.has("extinction")) {
    if (p.has("opacity")) throw p.error("extinction", "give either \"opacity\" or \"extinction\"");
    return {read_curve(p, "extinction", 1, 1e18, "0 0, 100 2.5"), color};
  }
  if (p.has("opacity")) opacity = read_curve(p, "opacity", 1, 1, "0 0, 100 0.3");
  if (!opacity)
    throw p.error(
        "opacity",
        "is missing: give \"opacity\" as values and opacities (\"0 0, 100 0.3\"), \"extinction\", or a \"preset\"");
  if (p.has("opacity"))
    for (const auto& numbers : opacity->numbers)
      if (numbers[0] > kMaxOpacity) {
        note_limited_opacity(p, "opacity");
        break;
      }
  return {extinction_of(*opacity, unit), color};
}

std::vector<ParameterDoc> TransferFunction::rows() {
  return {
      {"opacity", "string", "", "of the preset",
       "values and the opacity of a layer of `opacity_unit_length` at each, in ascending order, linear between them: "
       "\"VALUE OPACITY, VALUE OPACITY, ...\"; a value that stands twice makes a jump"},
      {"extinction", "string", "1/length", "none", "instead of opacity: values and extinction coefficients"},
      {"opacity_unit_length", "float", "length", "1 mm for presets of CT and MR, else 1",
       "thickness of the layer whose opacity is given"},
      {"colors", "string", "", "white", "values and the red, green and blue of each, from 0 to 1"},
      {"color_encoding", "string", "", "linear",
       "\"linear\": colors are linear sRGB and linear between values; \"srgb\": they are encoded as in picture files, and "
       "interpolated so, as in VTK"},
      {"color_map", "string", "", "none",
       "colours of a map over `range`, instead of colors: viridis, magma, inferno, plasma, gray"},
      {"range", "string", "", "0, 1", "the two values at the ends of the colour map"},
      {"preset", "string", "", "none",
       "colours and opacities by name: ct_bone, ct_soft_tissue (Hounsfield units, unit of length 1 mm), mr (values from 0 to 1000), generic (0 to 1)"}};
}

}  // namespace aureole
