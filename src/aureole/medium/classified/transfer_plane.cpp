// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/classified/transfer_plane.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "aureole/core/image.h"
#include "aureole/plugin/number_list.h"
#include "aureole/plugin/properties.h"
#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

constexpr int kMaxTableSize = 2048;
constexpr const char *kBoxExample = "100 300 0 50 0.9 0.7 0.5 0.2",
                     *kTriangleExample = "200 0 80 60 0 1 0.9 0.8 0.5";

/// Reads two ascending numbers. Throws located Errors.
void read_ends(const Properties& p, const char* name, float ends[2]) {
  if (!p.has(name))
    throw p.error(
        name,
        fmt::format("\"{}\" is missing: the numbers at the first and the last pixel of \"table\", such as "
                    "\"0, 1000\"",
                    name));
  const std::vector<double> list = get_number_list(p, name);
  if (list.size() != 2 || !(float(list[0]) < float(list[1])))
    throw p.error(name, "expected two ascending numbers, such as \"0, 1000\"");
  ends[0] = float(list[0]), ends[1] = float(list[1]);
}

}  // namespace

bool TransferPlane::is_given(const Properties& p) {
  return p.has("table") || p.has("boxes") || p.has("triangles");
}

float TransferPlane::extinction_of(float opacity) const {
  return -std::log1p(-std::min(opacity, float(TransferFunction::kMaxOpacity))) / unit_;
}

void TransferPlane::read_patches(const Properties& p, const char* name, bool are_triangles) {
  if (!p.has(name)) return;
  const std::size_t count = are_triangles ? 9 : 8;
  const std::vector<double> list = get_number_list(p, name);
  if (list.empty() || list.size() % count != 0)
    throw p.error(
        name,
        fmt::format("expected {} for each, such as \"{}\", but found {} numbers",
                    are_triangles ? "the value of the apex, two gradients, half of the width and the lean "
                                    "at the second one, red, green, blue and the opacity"
                                  : "two values, two gradients, red, green, blue and the opacity",
                    are_triangles ? kTriangleExample : kBoxExample, list.size()));
  const bool is_srgb = p.get_choice("color_encoding", "linear", {"linear", "srgb"}) == "srgb";
  bool is_limited = false;
  for (std::size_t i = 0; i < list.size(); i += count) {
    const double* const n = &list[i];
    const auto fail = [&](const std::string& message) {
      return p.error(name, fmt::format("in number {}: {}", i / count + 1, message));
    };
    Patch patch{};
    patch.is_triangle = are_triangles;
    const double from = n[are_triangles ? 1 : 2], to = n[are_triangles ? 2 : 3];
    if (from < 0 || !(float(from) < float(to)))
      throw fail(
          fmt::format("gradients are lengths and must ascend, but {:g} and {:g} were found", from, to));
    patch.from = float(from), patch.to = float(to);
    if (are_triangles) {
      patch.apex = float(n[0]), patch.width = float(n[3]), patch.lean = float(n[4]);
      if (!(patch.width > 0))
        throw fail(fmt::format("half of the width must be positive, but is {:g}", n[3]));
    } else {
      patch.low = float(n[0]), patch.high = float(n[1]);
      if (!(patch.low < patch.high))
        throw fail(fmt::format("values must ascend, but {:g} and {:g} were found", n[0], n[1]));
    }
    const double* const rgba = n + count - 4;
    float rgb[3];
    for (int c = 0; c < 4; ++c)
      if (!(rgba[c] >= 0 && rgba[c] <= 1))
        throw fail(fmt::format("colours and opacities lie between 0 and 1, but {:g} was found", rgba[c]));
    for (int c = 0; c < 3; ++c) rgb[c] = is_srgb ? srgb_decode(float(rgba[c])) : float(rgba[c]);
    patch.color = ColorWeights::of_linear_rgb(rgb[0], rgb[1], rgb[2]);
    patch.opacity = float(rgba[3]);
    is_limited |= rgba[3] > TransferFunction::kMaxOpacity;
    patches_.push_back(patch);
  }
  if (is_limited) note_limited_opacity(p, name);
}

void TransferPlane::read_table(const Properties& p) {
  const std::filesystem::path file = p.get_file("table");
  Image image;
  try {
    image = read_image(file);
  } catch (const Error& problem) {
    throw p.error("table", problem.what());
  }
  if (p.has("color_encoding"))
    throw p.error("color_encoding",
                  "is not for \"table\": a picture's format says how its colours are encoded");
  for (const std::string& note : image.notes) p.note("table", "\"" + file.string() + "\": " + note);
  read_ends(p, "table_values", table_values_);
  read_ends(p, "table_gradients", table_gradients_);
  if (table_gradients_[0] < 0)
    throw p.error("table_gradients",
                  fmt::format("the gradient {:g} is negative, but a length is not", table_gradients_[0]));
  const int a = image.channel("A");
  int rgb[3] = {image.channel("R"), image.channel("G"), image.channel("B")};
  if (image.channel("Y") >= 0) rgb[0] = rgb[1] = rgb[2] = image.channel("Y");
  if (a < 0 || std::min({rgb[0], rgb[1], rgb[2]}) < 0)
    throw p.error("table", "\"" + file.string() + "\" needs the channels R, G, B (or Y) and A, the opacity");
  width_ = image.width, height_ = image.height;
  if (width_ < 2 || height_ < 2 || width_ > kMaxTableSize || height_ > kMaxTableSize)
    throw p.error("table", fmt::format("\"{}\" has {} x {} pixels; from 2 x 2 to {} x {} are possible",
                                       file.string(), width_, height_, kMaxTableSize, kMaxTableSize));
  bool is_limited = false;
  texels_.resize(std::size_t(width_) * std::size_t(height_));
  std::vector<float> columns(std::size_t(width_), 0.f);
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      // The picture has its largest gradient at the top.
      Sample& texel = texels_[std::size_t(height_ - 1 - y) * std::size_t(width_) + std::size_t(x)];
      float n[4];
      for (int c = 0; c < 4; ++c) {
        n[c] = image.at(x, y, std::size_t(c < 3 ? rgb[c] : a));
        if (!(n[c] >= 0 && n[c] <= 1))
          throw p.error(
              "table",
              fmt::format("\"{}\" holds {:g} at x = {}, y = {}; colours and opacities lie between 0 and 1",
                          file.string(), n[c], x, y));
        if (c < 3 && image.srgb_encoded) n[c] = srgb_decode(n[c]);
      }
      is_limited |= double(n[3]) > TransferFunction::kMaxOpacity;
      texel = {extinction_of(n[3]), ColorWeights::of_linear_rgb(n[0], n[1], n[2])};
      columns[std::size_t(x)] = std::max(columns[std::size_t(x)], texel.extinction);
    }
  if (is_limited) note_limited_opacity(p, "table");
  columns_ = RangeMaximum(std::move(columns));
}

TransferPlane TransferPlane::read(const Properties& p) {
  for (const char* name :
       {"opacity", "extinction", "preset", "colors", "color_map", "range", "gradient_opacity"})
    if (p.has(name))
      throw p.error(name,
                    "contradicts the function of value and gradient: \"table\", \"boxes\" and "
                    "\"triangles\" have colours and opacities of their own");
  TransferPlane plane;
  plane.unit_ = float(opacity_unit_length(p));
  if (p.has("table")) {
    for (const char* name : {"boxes", "triangles"})
      if (p.has(name)) throw p.error(name, "give either a \"table\" or \"boxes\" and \"triangles\"");
    plane.read_table(p);
    plane.max_extinction_ = plane.columns_.of(0, std::size_t(plane.width_));
  } else {
    for (const char* name : {"table_values", "table_gradients"})
      if (p.has(name)) throw p.error(name, "is for a \"table\", which is missing");
    plane.read_patches(p, "boxes", false);
    plane.read_patches(p, "triangles", true);
    plane.max_extinction_ = plane.max_extinction(-kInfinity, kInfinity);
  }
  return plane;
}

TransferPlane::Sample TransferPlane::table_at(float value, float gradient) const {
  const auto place = [](float at, const float ends[2], int count, int& cell, float& t) {
    const float u = (at - ends[0]) / (ends[1] - ends[0]) * float(count - 1);
    const float c = u > 0 ? std::min(u, float(count - 1)) : 0.f;
    cell = std::min(int(c), count - 2), t = c - float(cell);
  };
  int x, y;
  float tx, ty;
  place(value, table_values_, width_, x, tx);
  place(gradient, table_gradients_, height_, y, ty);
  const Sample* const row = &texels_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
  const Sample* const above = row + width_;
  const auto mix = [&](auto of) {
    const float a = of(row[0]) + tx * (of(row[1]) - of(row[0])),
                b = of(above[0]) + tx * (of(above[1]) - of(above[0]));
    return a + ty * (b - a);
  };
  return {
      mix([](const Sample& s) { return s.extinction; }),
      {mix([](const Sample& s) { return s.color.white; }), mix([](const Sample& s) { return s.color.red; }),
       mix([](const Sample& s) { return s.color.green; }),
       mix([](const Sample& s) { return s.color.blue; })}};
}

TransferPlane::Sample TransferPlane::at(float value, float gradient) const {
  if (!texels_.empty()) return table_at(value, gradient);
  Sample sum;
  for (const Patch& patch : patches_) {
    if (!(gradient >= patch.from && gradient <= patch.to)) continue;
    float opacity = patch.opacity;
    if (patch.is_triangle) {
      const float part = gradient / patch.to, half = patch.width * part;
      const float distance = std::abs(value - (patch.apex + patch.lean * part));
      if (!(distance < half)) continue;
      opacity *= 1 - distance / half;
    } else if (!(value >= patch.low && value <= patch.high)) {
      continue;
    }
    const float extinction = extinction_of(opacity);
    sum.extinction += extinction;
    sum.color.white += extinction * patch.color.white, sum.color.red += extinction * patch.color.red;
    sum.color.green += extinction * patch.color.green, sum.color.blue += extinction * patch.color.blue;
  }
  if (sum.extinction > 0) {
    const float scale = 1 / sum.extinction;
    sum.color = {sum.color.white * scale, sum.color.red * scale, sum.color.green * scale,
                 sum.color.blue * scale};
  }
  return sum;
}

std::array<float, 2> TransferPlane::span_of(const Patch& patch) const {
  if (!patch.is_triangle) return {patch.low, patch.high};
  float low = kInfinity, high = -kInfinity;
  for (const float gradient : {patch.from, patch.to}) {
    const float part = gradient / patch.to, middle = patch.apex + patch.lean * part,
                half = patch.width * part;
    low = std::min(low, middle - half), high = std::max(high, middle + half);
  }
  return {low, high};
}

float TransferPlane::max_extinction(float low, float high) const {
  if (!texels_.empty()) {
    const auto column = [&](float value) {
      const float u = (value - table_values_[0]) / (table_values_[1] - table_values_[0]) * float(width_ - 1);
      return std::clamp(u, 0.f, float(width_ - 1));
    };
    return columns_.of(std::size_t(column(low)), std::size_t(std::ceil(column(high))) + 1);
  }
  float sum = 0;
  for (const Patch& patch : patches_)
    if (const auto span = span_of(patch); span[0] <= high && span[1] >= low) sum += max_of(patch);
  return sum;
}

std::vector<ParameterDoc> TransferPlane::rows() {
  return {
      {"boxes", "string", "", "none",
       "a function of value and length of the gradient, instead of opacity and colors: for each box two values, two gradients "
       "[1/length], red, green, blue and the opacity of a layer of `opacity_unit_length`; where several overlap, their "
       "extinctions add"},
      {"triangles", "string", "", "none",
       "as boxes: for each triangle the value of its apex, at the gradient 0, the smallest and largest gradient, half of its "
       "width and the shift of its middle at the largest one, red, green, blue and the opacity in the middle, which "
       "falls to 0 at both sides"},
      {"table", "file", "", "none",
       "as boxes: a picture of colours and opacities (alpha), values from left to right and gradients from bottom to top, linear "
       "between pixels and continued by the outermost ones; colours are not multiplied by alpha, in EXR either"},
      {"table_values", "string", "", "required with table",
       "values at the centres of the first and last column"},
      {"table_gradients", "string", "", "required with table",
       "lengths of the gradient [1/length] at the centres of the bottom and top row"}};
}

}  // namespace aureole
