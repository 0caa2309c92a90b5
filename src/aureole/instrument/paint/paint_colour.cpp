// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/paint/paint_colour.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/core/input_file.h"
#include "aureole/core/letter_case.h"
#include "aureole/instrument/paint/paint_files.h"
#include "aureole/pigment/measured_paints.h"
#include "aureole/pigment/text_table.h"
#include "aureole/pigment/wavelength_interpolation.h"
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
  const MeasuredReflectance mean = mean_reflectance(file, name);
  ColourTarget result;
  pigment::Palette& cut = result.palette;
  cut = palette;
  cut.nm.clear();
  for (pigment::Pigment& p : cut.pigments) p.k.clear(), p.s.clear(), p.k_error.clear(), p.s_error.clear();
  for (std::size_t i = 0; i < palette.nm.size(); ++i) {
    const double nm = palette.nm[i];
    if (nm < mean.nm.front() || nm > mean.nm.back()) continue;
    cut.nm.push_back(nm);
    for (std::size_t p = 0; p < cut.pigments.size(); ++p) {
      cut.pigments[p].k.push_back(palette.pigments[p].k[i]);
      cut.pigments[p].s.push_back(palette.pigments[p].s[i]);
    }
  }
  if (cut.nm.size() < 2)
    throw Error(
        {file, 0, 0},
        fmt::format(
            "its wavelengths, {:g} to {:g} nm, and those of the palette, {:g} to {:g} nm, do not overlap",
            mean.nm.front(), mean.nm.back(), palette.nm.front(), palette.nm.back()));
  result.target.reflectance = mean.at(cut.nm);
  result.file = file, result.instrument = mean.instrument, result.notes = mean.notes;
  if (!mean.repeats.empty()) result.notes.push_back(mean.repeats);
  if (mean.nm != palette.nm)
    result.notes.push_back(fmt::format(
        "has other wavelengths than the palette; {} of the palette's {} wavelengths are used, and values between the {} "
        "measured ones are interpolated",
        cut.nm.size(), palette.nm.size(), mean.nm.size()));
  if (std::string note = sampling_note(illuminant, mean.nm); !note.empty())
    result.notes.push_back(std::move(note));
  result.target.lab = observe(illuminant, cut.nm).lab(result.target.reflectance);
  return result;
}

using Lamp = LampPower;

/// Reads a measured lamp: two columns, wavelength and power, with or without a line of headings.
Lamp read_lamp(const std::string& file) {
  std::vector<std::pair<double, double>> points;
  double scale = 1;
  try {
    std::string text = pigment::utf8_text(read_table_file(file).str());
    // A comment extends to the end of its line.
    bool is_comment = false;
    std::erase_if(text, [&](char c) {
      is_comment = c == '#' || (is_comment && c != '\n');
      return is_comment;
    });
    const std::vector<pigment::TextRow> rows = pigment::read_pairs(text, true);
    for (const pigment::TextRow& row : rows) {
      const bool is_pair = row.cells.size() == 2;
      // a first line without numbers is a line of headings
      if (points.empty() && !pigment::finite_number(row.cells[0].text)) {
        const std::string heading = lower_case(row.cells[0].text);
        for (const char* micrometre : {"(um)", "[um]", "(µm)", "[µm]", "(μm)", "[μm]", "micron"})
          if (heading.find(micrometre) != heading.npos) scale = 1000;
        continue;
      }
      if (!is_pair)
        throw pigment::TextError(row.line, 0,
                                 "expected two columns, wavelength and power, as in the line\n    400,0.82");
      const double nm = scale * pigment::number_of(row, 0), power = pigment::number_of(row, 1);
      if (power < 0)
        throw pigment::TextError(row.line, row.cells[1].column,
                                 fmt::format("the power at {:g} nm is negative: {:g}", nm, power));
      points.emplace_back(nm, power);
    }
  } catch (const pigment::TextError& e) {
    throw Error({file, e.line(), e.column()}, e.what());
  }
  std::sort(points.begin(), points.end());
  Lamp lamp;
  for (const auto& [nm, power] : points) {
    if (!lamp.nm.empty() && nm == lamp.nm.back())
      throw Error({file, 0, 0}, fmt::format("the wavelength {:g} nm comes twice", nm));
    lamp.nm.push_back(nm), lamp.power.push_back(power);
  }
  if (lamp.nm.empty() || lamp.nm.front() > 420 || lamp.nm.back() < 680)
    throw Error({file, 0, 0},
                "a lamp is measured at least from 420 to 680 nm, in two columns: wavelength and power");
  return lamp;
}

Lamp lamp_called(const std::string& name) {
  if (const auto found = find_illuminant(name))
    return {{found->wavelengths_nm.begin(), found->wavelengths_nm.end()},
            {found->values.begin(), found->values.end()}};
  std::error_code code;
  if (!std::filesystem::is_regular_file(name, code))
    throw Error(
        "unknown illuminant \"" + name + "\"" + did_you_mean(name, illuminant_names()) +
        ", and there is no file of that name; a measured lamp is a file of two columns, wavelength and "
        "power, as in the line\n    400,0.82");
  return read_lamp(name);
}

/// Returns the name of an illuminant as the tables spell it, for a name in any case.
std::string illuminant_called(const std::string& name) {
  for (const std::string& known : illuminant_names())
    if (lower_case(known) == lower_case(name)) return known;
  return name;
}

}  // namespace

LampPower lamp_power(const std::string& name) { return lamp_called(illuminant_called(name)); }

Viewing viewing_of(const std::string& name) {
  for (const auto& [ending, field] :
       {std::pair{std::string("/2"), pigment::Field::two}, {std::string("/10"), pigment::Field::ten}})
    if (name.size() > ending.size() && name.ends_with(ending))
      return {illuminant_called(name.substr(0, name.size() - ending.size())), field};
  return {illuminant_called(name), pigment::Field::two};
}

std::string viewed_at(const std::string& illuminant, const std::string& degrees) {
  const std::string name = viewing_of(illuminant).illuminant;
  const bool states = name.size() != illuminant.size();
  if (states) return name + illuminant.substr(name.size());
  return degrees == "2" ? name : name + "/" + degrees;
}

pigment::Observation observe(const std::string& illuminant, std::span<const double> nm) {
  const Viewing viewing = viewing_of(illuminant);
  const Lamp lamp = lamp_called(viewing.illuminant);
  const Observer& observer = viewing.field == pigment::Field::ten ? cie_1964_observer() : cie_1931_observer();
  const auto of = [&](std::span<const double> values) {
    return [&observer, values](double l) {
      return values[std::size_t(std::lround((l - observer.start_nm) / observer.step_nm))];
    };
  };
  try {
    return pigment::Observation(illuminant, nm,
                                [&](double l) {
                                  return TabulatedSpectrum{lamp.nm, lamp.power}.at(l);
                                },
                                {of(observer.x), of(observer.y), of(observer.z)});
  } catch (const std::domain_error& e) {
    throw Error(e.what());
  }
}

std::vector<double> MeasuredReflectance::at(std::span<const double> wavelengths) const {
  return pigment::interpolated(nm, values, wavelengths);
}

MeasuredReflectance mean_reflectance(const std::string& file, const std::string& sample) {
  const pigment::SampleTable table = read_sample_file(file, pigment::Recipes::optional);
  located_in(file, table, [&] { return pigment::check_not_above_white(table), 0; });
  const std::vector<pigment::Panel> panels = pigment::panels_of(table),
                                    found = pigment::panels_called(panels, sample);
  const auto names = [](const std::vector<pigment::Panel>& of) {
    std::vector<std::string> all;
    for (const pigment::Panel& p : of) all.push_back(p.name);
    return all;
  };
  if (found.empty()) {
    const std::vector<std::string> known = names(panels);
    throw Error({file, 0, 0}, "no sample is called \"" + sample + "\"" + did_you_mean(sample, known) +
                                  fmt::format("; there are {}", fmt::join(known, ", ")));
  }
  if (found.size() > 1)
    throw Error({file, 0, 0},
                fmt::format("{} samples are called \"{}\"; name one of them, as in {}#{}: there are {}",
                            found.size(), sample, file, found[0].name, fmt::join(names(found), ", ")));
  MeasuredReflectance result{table.nm, found[0].values, table.instrument, table.notes};
  if (found[0].count > 1)
    result.repeats = fmt::format("{} measurements of \"{}\" are averaged", found[0].count, found[0].name);
  return result;
}

MeasuredReflectance mean_reflectance_called(const std::string& text, const std::string& option) {
  const auto mark = text.rfind('#');
  if (mark == text.npos || mark == 0 || mark + 1 == text.size())
    throw Error(option + ": expected a file and a sample in it, FILE#SAMPLE, as in cards.csv#master, got \"" +
                text + "\"");
  return mean_reflectance(text.substr(0, mark), text.substr(mark + 1));
}

SamplingError sampling_error(const std::string& illuminant, std::span<const double> nm) {
  SamplingError result;
  for (std::size_t i = 1; i < nm.size(); ++i)
    if (nm[i] > 400 && nm[i - 1] < 700) result.widest_nm = std::max(result.widest_nm, nm[i] - nm[i - 1]);
  const pigment::SampleTable paints = pigment::kimera_samples();
  const pigment::Observation whole = observe(illuminant, paints.nm), few = observe(illuminant, nm);
  int count = 0;
  for (const pigment::Panel& p : pigment::panels_of(paints)) {
    if (p.first->paints.size() != 1) continue;
    const double difference =
        pigment::ciede2000(whole.lab(p.values), few.lab(pigment::interpolated(paints.nm, p.values, nm)));
    result.mean += difference, result.largest = std::max(result.largest, difference);
    ++count;
  }
  result.mean /= std::max(count, 1);
  return result;
}

std::string sampling_note(const std::string& illuminant, std::span<const double> nm) {
  const SamplingError error = sampling_error(illuminant, nm);
  if (error.widest_nm <= pigment::kWidestCubicStep) return {};
  return fmt::format(
      "wavelengths are up to {:g} nm apart; colours of 13 measured paints, taken at these wavelengths only, are off by "
      "a CIEDE2000 of {:.1f} on average and {:.1f} at most",
      error.widest_nm, error.mean, error.largest);
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
    if (illuminant != "D65" && illuminant != "D65/2")
      throw Error(option +
                  ": a colour of a screen is one under D65 for the 2-degree observer; use lab(L, a, b) or a "
                  "measured sample");
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
