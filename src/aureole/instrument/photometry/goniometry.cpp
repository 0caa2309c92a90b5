// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/photometry/goniometry.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"

namespace aureole {

namespace {

using Symmetry = GoniometryOptions::Symmetry;

/// The columns that are averaged with a column. Where a half-plane's mirror image lies between two columns,
/// both columns count.
std::vector<std::size_t> alike(std::size_t column, std::size_t width, Symmetry symmetry) {
  const auto image_about_c0 = [&](std::size_t i) { return (width - i) % width; };
  const auto image_about_c90 = [&](std::size_t i) { return (width + width / 2 - i) % width; };
  switch (symmetry) {
    case Symmetry::about_c0:
      return {column, image_about_c0(column)};
    case Symmetry::about_c90:
      return {column, image_about_c90(column)};
    case Symmetry::quadrants:
      return {column, image_about_c0(column), image_about_c90(column),
              image_about_c90(image_about_c0(column))};
    default:
      return {column};
  }
}

}  // namespace

Luminaire measured_luminaire(const Image& picture, const GoniometryOptions& options) {
  const std::size_t width = std::size_t(picture.width), height = std::size_t(picture.height);
  const auto pixel = [&](std::size_t i, std::size_t j) {
    return std::max(0.0, double(picture.pixels[(j * width + i) * picture.channels.size()]));
  };
  if (width % 2 != 0 && options.symmetry != Symmetry::none && options.symmetry != Symmetry::rotational)
    throw Error("half-planes that mirror each other need an even number of them");
  std::vector<double> gamma, azimuths, candela;
  for (std::size_t j = 0; j < height; ++j) gamma.push_back(180.0 * double(j) / double(height - 1));
  const auto mean_of_row = [&](std::size_t j) {
    double sum = 0;
    for (std::size_t i = 0; i < width; ++i) sum += pixel(i, j);
    return sum / double(width);
  };
  // At gamma = 0 and 180 degrees all half-planes share one direction.
  const auto value = [&](std::size_t i, std::size_t j) {
    if (j == 0 || j + 1 == height || options.symmetry == Symmetry::rotational) return mean_of_row(j);
    const std::vector<std::size_t> columns = alike(i, width, options.symmetry);
    double sum = 0;
    for (const std::size_t c : columns) sum += pixel(c, j);
    return sum / double(columns.size());
  };
  const bool is_rotational = width == 1 || options.symmetry == Symmetry::rotational;
  for (std::size_t i = 0; i < (is_rotational ? 1 : width + 1); ++i) {
    azimuths.push_back(360.0 * double(i) / double(width));
    for (std::size_t j = 0; j < height; ++j) candela.push_back(value(i % width, j));
  }
  Luminaire l{.format = Luminaire::Format::ies,
              .standard = "LM-63-2019",
              .keywords = options.keywords,
              .type = optics::PhotometricType::c,
              .symmetry = {},
              .distribution = optics::IntensityDistribution(
                  optics::photometric_axes(optics::PhotometricType::c), azimuths, gamma, candela),
              .horizontal_count = azimuths.size(),
              .vertical_count = gamma.size(),
              .opening = options.opening.value_or(LuminousOpening{}),
              .lamps = {{.count = 1, .flux = options.lamp_flux, .watts = options.watts}},
              .is_absolute = options.lamp_flux == 0};
  const double flux = l.distribution.flux();
  if (!(flux > 0)) throw Error("the goniophotometer has measured no light");
  if (options.flux > 0) l.distribution.scale(options.flux / flux);
  return l;
}

Luminaire read_changed_luminaire(const std::filesystem::path& file, std::size_t lamp_set,
                                 const GoniometryOptions& options) {
  LuminaireOptions how;
  how.lamp_set = lamp_set, how.lamp_flux = options.lamp_flux;
  Luminaire l = read_luminaire(file, how);
  if (lamp_set > 0 && l.format == Luminaire::Format::ies)
    throw Error("--lamp-set " + std::to_string(lamp_set) + ": " + file.string() +
                " is a file of LM-63, which has one set of lamps");
  if (options.flux > 0) {
    const double flux = l.distribution.flux();
    if (!(flux > 0)) throw Error(file.string() + ": the luminaire emits no light, which no flux can scale");
    l.distribution.scale(options.flux / flux);
  }
  if (options.watts > 0) l.lamps.at(l.lamp_set).watts = options.watts;
  if (options.opening) l.opening = *options.opening;
  for (const auto& [key, value] : options.keywords) {
    const auto same = [&key = key](const auto& pair) { return pair.first == key; };
    const auto found = std::find_if(l.keywords.begin(), l.keywords.end(), same);
    if (found == l.keywords.end())
      l.keywords.emplace_back(key, value);
    else
      found->second = value;
  }
  return l;
}

LuminaireFigures luminaire_figures(const Luminaire& luminaire) {
  const optics::IntensityDistribution& d = luminaire.distribution;
  LuminaireFigures f;
  f.flux = d.flux();
  if (luminaire.type == optics::PhotometricType::c) f.downward_flux = d.flux(0, 90);
  for (std::size_t i = 0; i < d.azimuths().size(); ++i)
    for (std::size_t j = 0; j < d.polar_angles().size(); ++j)
      if (d.value(i, j) > f.peak)
        f.peak = d.value(i, j), f.peak_c = d.azimuths()[i], f.peak_gamma = d.polar_angles()[j];
  constexpr double kStep = 0.05;
  const double half = 0.5 * d.intensity({0, 0, 1});
  for (int plane = 0; plane < 2; ++plane) {
    double width = 0;
    for (const double c : {90.0 * plane, 90.0 * plane + 180}) {
      double gamma = 0;
      while (gamma <= 180 && d.at(c, gamma) >= half) gamma += kStep;
      if (gamma > 180) width = NAN;
      double inside = std::max(gamma - kStep, 0.0), outside = gamma;
      while (outside - inside > 1e-6) {
        const double middle = 0.5 * (inside + outside);
        (d.at(c, middle) >= half ? inside : outside) = middle;
      }
      width += inside;
    }
    f.beam[plane] = std::isfinite(width) && half > 0 ? width : 0;
  }
  return f;
}

}  // namespace aureole
