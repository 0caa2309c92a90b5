// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/paint/paint_colour.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/instrument/paint/paint_files.h"
#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/tables.h"

namespace aureole {
namespace {

using pigment::Lab;
using pigment::Xyz;

/// Colour names of HTML 4.01, section 6.5.
constexpr std::pair<const char*, const char*> kNames[] = {
    {"black", "#000000"},  {"silver", "#c0c0c0"}, {"gray", "#808080"},   {"white", "#ffffff"},
    {"maroon", "#800000"}, {"red", "#ff0000"},    {"purple", "#800080"}, {"fuchsia", "#ff00ff"},
    {"green", "#008000"},  {"lime", "#00ff00"},   {"olive", "#808000"},  {"yellow", "#ffff00"},
    {"navy", "#000080"},   {"blue", "#0000ff"},   {"teal", "#008080"},   {"aqua", "#00ffff"}};

/// Converts linear sRGB to XYZ, the inverse of `xyz_to_srgb`, by Cramer's rule.
Xyz xyz_of_srgb(const Xyz& rgb) {
  double m[3][3];
  for (int j = 0; j < 3; ++j) {
    double unit[3]{};
    unit[j] = 1;
    float column[3];
    xyz_to_srgb(unit, column);
    for (int i = 0; i < 3; ++i) m[i][j] = double(column[i]);
  }
  const auto determinant = [](const double a[3][3]) {
    return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
           a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
           a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
  };
  const double whole = determinant(m);
  Xyz xyz{};
  for (std::size_t j = 0; j < 3; ++j) {
    double replaced[3][3];
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t l = 0; l < 3; ++l) replaced[i][l] = l == j ? rgb[i] : m[i][l];
    xyz[j] = determinant(replaced) / whole;
  }
  return xyz;
}

/// Returns the XYZ of "#rrggbb", with Y = 1 for white, or nothing if the text has another form.
std::optional<Xyz> hex_colour(const std::string& text) {
  if (text.size() != 7 || text[0] != '#' || text.find_first_not_of("0123456789abcdefABCDEF", 1) != text.npos)
    return {};
  Xyz rgb{};
  for (std::size_t i = 0; i < 3; ++i)
    rgb[i] = double(srgb_decode(float(std::stoi(text.substr(1 + 2 * i, 2), nullptr, 16)) / 255.f));
  return xyz_of_srgb(rgb);
}

/// Returns the mean reflectance of the samples of that name at the wavelengths common to file and palette.
ColourTarget measured_target(const std::string& file, const std::string& name,
                             const pigment::Palette& palette, const std::string& illuminant) {
  const pigment::SampleTable table = read_sample_file(file);
  std::vector<double> mean(table.nm.size());
  std::vector<std::string> known;
  int count = 0;
  for (const pigment::Sample& s : table.samples) {
    if (std::find(known.begin(), known.end(), s.name) == known.end()) known.push_back(s.name);
    if (s.name != name || s.quantity != pigment::Sample::Quantity::reflectance) continue;
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += s.values[i];
    ++count;
  }
  if (count == 0)
    throw Error({file, 0, 0}, "no sample is called \"" + name + "\"" + did_you_mean(name, known) +
                                  fmt::format("; there are {}", fmt::join(known, ", ")));
  for (double& v : mean) v /= count;

  ColourTarget result;
  pigment::Palette& cut = result.palette;
  cut = palette;
  cut.nm.clear();
  for (pigment::Pigment& p : cut.pigments) p.k.clear(), p.s.clear(), p.k_error.clear(), p.s_error.clear();
  for (std::size_t i = 0; i < palette.nm.size(); ++i) {
    const double nm = palette.nm[i];
    if (nm < table.nm.front() || nm > table.nm.back()) continue;
    cut.nm.push_back(nm);
    for (std::size_t p = 0; p < cut.pigments.size(); ++p) {
      cut.pigments[p].k.push_back(palette.pigments[p].k[i]);
      cut.pigments[p].s.push_back(palette.pigments[p].s[i]);
    }
    result.target.reflectance.push_back(TabulatedSpectrum{table.nm, mean}.at(nm));
  }
  if (cut.nm.size() < 2)
    throw Error(
        {file, 0, 0},
        fmt::format(
            "its wavelengths, {:g} to {:g} nm, and those of the palette, {:g} to {:g} nm, do not overlap",
            table.nm.front(), table.nm.back(), palette.nm.front(), palette.nm.back()));
  result.target.lab = observe(illuminant, cut.nm).lab(result.target.reflectance);
  return result;
}

}  // namespace

pigment::Observation observe(const std::string& illuminant, std::span<const double> nm) {
  const auto lamp = find_illuminant(illuminant);
  if (!lamp)
    throw Error("unknown illuminant \"" + illuminant + "\"" + did_you_mean(illuminant, illuminant_names()));
  const Observer& observer = cie_1931_observer();
  const auto of = [&](std::span<const double> values) {
    return [&observer, values](double l) {
      return values[std::size_t(std::lround((l - observer.start_nm) / observer.step_nm))];
    };
  };
  try {
    return pigment::Observation(illuminant, nm, [&](double l) { return lamp->at(l); },
                                {of(observer.x), of(observer.y), of(observer.z)});
  } catch (const std::domain_error& e) {
    throw Error(e.what());
  }
}

std::string screen_colour(const Xyz& xyz, const Xyz& white) {
  const Xyz screen_white = xyz_of_srgb({1, 1, 1});
  double adapted[3];
  for (std::size_t i = 0; i < 3; ++i) adapted[i] = xyz[i] / white[i] * screen_white[i];
  float rgb[3];
  xyz_to_srgb(adapted, rgb);
  std::string text = "#";
  for (const float v : rgb)
    text += fmt::format("{:02x}", int(std::lround(255 * srgb_encode(std::clamp(v, 0.f, 1.f)))));
  return text;
}

ColourTarget read_colour_target(const std::string& text, const pigment::Palette& palette,
                                const std::string& illuminant, const std::string& option) {
  double l, a, b;
  char end;
  if (std::sscanf(text.c_str(), "lab(%lf,%lf,%lf%c", &l, &a, &b, &end) == 4 && end == ')') {
    if (!(l >= 0 && l <= 100 && std::isfinite(a) && std::isfinite(b)))
      throw Error(option + ": L* must be in [0, 100]");
    return {{.lab = {l, a, b}}, palette};
  }
  std::string hex = text;
  for (const auto& [name, colour] : kNames)
    if (text == name) hex = colour;
  if (const auto xyz = hex_colour(hex)) {
    if (illuminant != "D65")
      throw Error(option + ": a colour of a screen is one under D65; use lab(L, a, b) or a measured sample");
    return {{.lab = pigment::lab_of_xyz(*xyz, xyz_of_srgb({1, 1, 1}))}, palette};
  }
  const auto mark = text.rfind('#');
  if (mark != text.npos && mark > 0)
    return measured_target(text.substr(0, mark), text.substr(mark + 1), palette, illuminant);
  std::vector<std::string> names;
  for (const auto& entry : kNames) names.emplace_back(entry.first);
  throw Error(option + ": \"" + text + "\" is no colour" + did_you_mean(text, names) +
              "; write #rrggbb, lab(L, a, b), a colour name of HTML, or FILE#SAMPLE");
}

}  // namespace aureole
