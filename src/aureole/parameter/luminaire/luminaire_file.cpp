// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/luminaire/luminaire_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "aureole/parameter/luminaire/luminaire_reader.h"
#include "aureole/pigment/text_table.h"

namespace aureole {

double projected_area(const LuminousOpening& opening, const optics::LuminaireVector& direction) {
  const auto& s = opening.size_m;
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  const double d[3] = {std::abs(direction[0]) / length, std::abs(direction[1]) / length,
                       std::abs(direction[2]) / length};
  switch (opening.shape) {
    case LuminousOpening::Shape::box:
      return s[1] * s[2] * d[0] + s[0] * s[2] * d[1] + s[0] * s[1] * d[2];
    case LuminousOpening::Shape::cylinder: {
      const auto axis = std::size_t(opening.axis), a = (axis + 1) % 3, b = (axis + 2) % 3;
      // The side is seen as a rectangle, as wide as the ellipse of the section is across the direction.
      return M_PI / 4 * s[a] * s[b] * d[axis] + s[axis] * std::hypot(s[a] * d[b], s[b] * d[a]);
    }
    default:
      return M_PI / 4 * std::hypot(s[1] * s[2] * d[0], s[0] * s[2] * d[1], s[0] * s[1] * d[2]);
  }
}

double LampTilt::at(double angle) const {
  if (angles.empty()) return 1;
  const auto above = std::upper_bound(angles.begin(), angles.end(), angle) - angles.begin();
  if (above == 0) return factors.front();
  if (std::size_t(above) == angles.size()) return factors.back();
  const std::size_t j = std::size_t(above), i = j - 1;
  return std::lerp(factors[i], factors[j], (angle - angles[i]) / (angles[j] - angles[i]));
}

namespace {

/// Whether a text has the whole numbers of EULUMDAT in its lines 2 to 4: type, symmetry and number of half-planes. Its
/// other lines may hold any text, also TILT=.
bool has_lines_of_eulumdat(const std::string& text) {
  if (text.starts_with("IES")) return false;
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  for (const double most : {3.0, 4.0, 1e5}) {
    if (!std::getline(lines, line)) return false;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    line.erase(0, std::min(line.find_first_not_of(' '), line.size()));
    const auto value = pigment::finite_number(line);
    if (!value || *value < 0 || *value > most || *value != std::floor(*value)) return false;
  }
  return true;
}

}  // namespace

void luminaire_reader::require_lines(const Luminaire& luminaire) {
  for (const auto& [name, value] : luminaire.keywords)
    if ((name + value).find_first_of("\r\n") != std::string::npos)
      throw Error("the keyword " + name + " has more than one line, which a luminaire's file cannot hold");
}

Luminaire parse_luminaire(std::string text, const std::filesystem::path& file,
                          const LuminaireOptions& options) {
  std::vector<std::string> notes;
  const std::string utf8 = pigment::utf8_text(std::move(text), &notes);
  // A file of LM-63 has a line that begins with TILT=, even where the line with the name of the format is
  // missing.
  Luminaire luminaire = luminaire_reader::find_tilt_line(utf8) && !has_lines_of_eulumdat(utf8)
                            ? luminaire_reader::read_ies(utf8, file, options)
                            : luminaire_reader::read_eulumdat(utf8, file, options);
  luminaire.notes.insert(luminaire.notes.begin(), notes.begin(), notes.end());
  if (options.lamp_flux > 0 && luminaire.format == Luminaire::Format::ies) {
    LampSet& lamps = luminaire.lamps[0];
    if (luminaire.is_absolute || !(lamps.flux > 0))
      throw Error(
          {file.string(), 0, 0},
          "the intensities do not refer to the flux of lamps, so that \"lamp_flux\" cannot change them: give "
          "\"flux\", the flux of the luminaire");
    luminaire.distribution.scale(options.lamp_flux / lamps.flux);
    lamps.flux = options.lamp_flux;
  }
  return luminaire;
}

Luminaire read_luminaire(const std::filesystem::path& file, const LuminaireOptions& options) {
  return parse_luminaire(read_text_file(file, luminaire_reader::kMaxLuminaireBytes), file, options);
}

FluxBalance flux_balance(const Luminaire& luminaire) {
  FluxBalance b;
  b.flux = luminaire.distribution.flux();
  b.lamp_flux = luminaire.lamp_flux();
  if (b.lamp_flux > 0) b.output_ratio = b.flux / b.lamp_flux;
  b.stated_ratio = luminaire.output_ratio;
  return b;
}

std::string FluxBalance::text() const {
  std::string s = fmt::format("the intensities integrate to {:.5g} lm", flux);
  if (lamp_flux > 0)
    s += fmt::format(", {:.2f} % of the {:.5g} lm of the lamps", 100 * output_ratio, lamp_flux);
  else
    s += " and do not refer to the flux of lamps";
  if (stated_ratio > 0 && lamp_flux > 0)
    s += fmt::format("; the file states {:.2f} %, {:+.2f} points from that", 100 * stated_ratio,
                     100 * (stated_ratio - output_ratio));
  return s;
}

namespace luminaire_reader {

Error fault(const std::filesystem::path& file, int line, int column, const std::string& message) {
  return Error({file.string(), line, column}, message);
}

optics::IntensityDistribution make_distribution(const MeasuredTable& table,
                                                const optics::PhotometricAxes& axes) {
  const std::vector<double>&horizontal = table.horizontal, &vertical = table.vertical,
        &candela = table.candela;
  const std::size_t columns = horizontal.size(), rows = vertical.size();
  if (table.type == optics::PhotometricType::c) return {axes, horizontal, vertical, candela};
  // The polar angle is 90 degrees minus the angle from the plane across the pole, so that the order of the
  // angles is reversed.
  std::vector<double> polar, cd(columns * rows);
  const bool is_a = table.type == optics::PhotometricType::a;
  const std::vector<double>&azimuth = is_a ? horizontal : vertical, &elevation = is_a ? vertical : horizontal;
  for (auto e = elevation.rbegin(); e != elevation.rend(); ++e) polar.push_back(90 - *e);
  for (std::size_t i = 0; i < azimuth.size(); ++i)
    for (std::size_t j = 0; j < polar.size(); ++j) {
      const std::size_t k = polar.size() - 1 - j;
      cd[i * polar.size() + j] = candela[is_a ? i * rows + k : k * rows + i];
    }
  return {axes, azimuth, polar, cd};
}

void mirror(MeasuredTable& table, double about) {
  const std::size_t rows = table.vertical.size(), columns = table.horizontal.size();
  // pairs of an angle and the half-plane that is copied to it
  std::vector<std::pair<double, std::size_t>> all;
  for (std::size_t i = 0; i < columns; ++i) {
    all.emplace_back(table.horizontal[i], i);
    const double image = 2 * about - table.horizontal[i];
    if (image != table.horizontal[i]) all.emplace_back(image, i);
  }
  std::sort(all.begin(), all.end());
  // An angle that duplicates another one at the end of a full circle is kept once.
  all.erase(
      std::unique(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first == b.first; }),
      all.end());
  std::vector<double> horizontal, candela;
  candela.reserve(all.size() * rows);
  for (const auto& [angle, from] : all) {
    horizontal.push_back(angle);
    const auto row = table.candela.begin() + std::ptrdiff_t(from * rows);
    candela.insert(candela.end(), row, row + std::ptrdiff_t(rows));
  }
  table.horizontal = std::move(horizontal), table.candela = std::move(candela);
}

std::vector<double> turned_half_planes(const std::vector<double>& azimuths, double angle) {
  if (azimuths.size() == 1) return azimuths;
  std::vector<double> all{0, 360};
  for (const double a : azimuths) {
    const double turned = a + angle - 360 * std::floor((a + angle) / 360);
    if (turned > 1e-9 && turned < 360 - 1e-9) all.push_back(turned);
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end(), [](double a, double b) { return b - a < 1e-9; }), all.end());
  return all;
}

optics::PhotometricAxes axes_of(optics::PhotometricType type, bool zero_is_across) {
  optics::PhotometricAxes axes = optics::photometric_axes(type);
  // Where C = 0 runs across the luminaire, it is the half-plane C = 90 of a luminaire whose C = 0 runs along
  // it.
  if (zero_is_across) axes.zero = {0, -1, 0}, axes.quarter = {-1, 0, 0};
  return axes;
}

}  // namespace luminaire_reader

}  // namespace aureole
