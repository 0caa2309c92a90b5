// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/radio/power_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "aureole/core/error.h"
#include "aureole/core/parallel.h"
#include "aureole/core/random.h"
#include "aureole/core/units.h"
#include "aureole/film/film.h"

namespace aureole {

namespace {

/// Whether a channel is a bin of a spectral film, as opposed to its preview.
bool is_bin(const std::string& channel) { return channel.starts_with("S0."); }

std::vector<double> decibels(const std::vector<double>& values, const auto& reference) {
  std::vector<double> db(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!(values[i] > 0))
      db[i] = -std::numeric_limits<double>::infinity();
    else if (const double of = reference(i); of > 0)
      db[i] = 10 * std::log10(values[i] / of);
    else
      db[i] = std::numeric_limits<double>::quiet_NaN();
  return db;
}

/// For each channel of the film, the film's measurement of the light that would arrive at the cells in free
/// space.
std::vector<double> free_space(const Scene& scene, int samples) {
  const PlacedSensor& sensor = scene.sensor();
  const Film& film = sensor.film();
  const int width = film.crop_width(), height = film.crop_height(), channels = film.measured_channels();
  std::vector<double> sums(std::size_t(width) * std::size_t(height) * std::size_t(channels));
  const int side = std::max(1, int(std::lround(std::sqrt(samples))));
  // Up to this number delta emitters are summed, which has no noise; more of them, and other emitters, are
  // sampled.
  constexpr std::size_t kMaxSummed = 64;
  std::vector<const Light*> summed;
  for (const Light& light : scene.emitters())
    if (light.is_delta() && !light.shape && light.sampling_weight() > 0) summed.push_back(&light);
  if (summed.size() > kMaxSummed) summed.clear();
  const auto is_summed = [&](const Light& light) {
    return std::find(summed.begin(), summed.end(), &light) != summed.end();
  };
  const bool all_summed = std::all_of(scene.emitters().begin(), scene.emitters().end(), is_summed);
  const auto compute_row = [&](std::size_t y) {
    std::vector<float> measured(std::size_t(channels), 0.f);
    for (int x = 0; x < width; ++x) {
      std::uint64_t state = mix_bits(combine_bits(y, std::uint64_t(x)));
      const auto next = [&] {
        return unit_float(std::uint32_t(mix_bits(state += 0x9e3779b97f4a7c15u) >> 32));
      };
      for (int k = 0; k < side * side; ++k) {
        const Vec2 place{float(x + film.crop_x()) + (float(k % side) + 0.5f) / float(side),
                         float(y) + float(film.crop_y()) + (float(k / side) + 0.5f) / float(side)};
        const auto receiver = sensor.receiver(place);
        // Wavelengths form a lattice over the positions in a cell.
        const Wavelengths w = scene.wavelengths().sample((float(k) + 0.5f) / float(side * side), next());
        if (!receiver) continue;
        const auto add = [&](const Light& light, std::size_t part, Vec2 u, float probability) {
          const auto direct = light.sample_direct(receiver->p, part, u, w);
          if (!direct || !(direct->pdf > 0)) return;
          const float factor = receiver->response(direct->wo) / (probability * direct->pdf * kWavelengths);
          film.measure(direct->radiance * factor / w.pdf, w, measured.data());
          double* sum = &sums[(y * std::size_t(width) + std::size_t(x)) * std::size_t(channels)];
          for (int c = 0; c < channels; ++c) sum[c] += measured[std::size_t(c)] / double(side * side);
        };
        for (const Light* light : summed) add(*light, 0, {}, 1);
        if (all_summed) continue;
        const auto choice = scene.lights().choose(receiver->p, receiver->facing(), next());
        if (!choice || !(choice->probability > 0)) continue;
        const Vec2 u{next(), next()};
        if (!is_summed(*choice->light)) add(*choice->light, choice->part, u, choice->probability);
      }
    }
  };
  for_ranges(
      std::size_t(height),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y) compute_row(y);
      },
      1);
  return sums;
}

/// A channel of the film for which a map is made.
struct Band {
  std::size_t channel;
  double min_nm, max_nm, mean_nm;  ///< range and mean wavelength of the channel's response
  double power, seen;              ///< power of all emitters: total, and weighted by the channel's response
};

/// Returns the bands of the film. Throws Error if no emitter has power in one of them.
std::vector<Band> bands(const Scene& scene) {
  const Film& film = scene.sensor().film();
  const SpectralGrid& grid = scene.wavelengths().grid();
  const std::vector<SampledSpectrum> responses = channel_responses(film, grid);
  const std::vector<std::string> names = film.channel_names();
  const bool has_bins = std::any_of(names.begin(), names.end(), is_bin);
  std::vector<Band> result;
  for (std::size_t c = 0; c < responses.size(); ++c) {
    if (has_bins && !is_bin(names[c])) continue;
    Band band{c, grid.max_nm, grid.min_nm, 0, 0, 0};
    const auto nodes = responses[c].nodes();
    double weight = 0, mean = 0;
    std::vector<float> inside(nodes.size(), 0.f);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!(nodes[i] > 0)) continue;
      const double nm = grid.node(int(i));
      weight += nodes[i], mean += nodes[i] * nm, inside[i] = 1;
      band.min_nm = std::min(band.min_nm, nm), band.max_nm = std::max(band.max_nm, nm);
    }
    const SampledSpectrum within(grid, std::move(inside));
    for (const Light& light : scene.emitters()) {
      const SampledSpectrum power = light.power_spectrum();
      band.power += product(within, power).integral();
      band.seen += product(responses[c], power).integral();
    }
    if (!(weight > 0 && band.seen > 0))
      throw Error(film.properties().where(), "no emitter shines where the channel \"" + names[c] + "\" sees");
    band.mean_nm = mean / weight;
    result.push_back(band);
  }
  return result;
}

}  // namespace

std::vector<double> PowerMap::relative_db() const {
  return decibels(density, [&](std::size_t i) { return free[i]; });
}

std::vector<double> PowerMap::received_dbm() const {
  const double aperture = wavelength_m * wavelength_m / (4 * M_PI);
  return decibels(density, [&](std::size_t) { return 1e-3 / aperture; });
}

std::vector<double> PowerMap::error_db() const {
  std::vector<double> db(error.size());
  for (std::size_t i = 0; i < error.size(); ++i)
    db[i] = density[i] > 0 ? 10 / std::log(10.0) * error[i] / density[i] : 0;
  return db;
}

void require_power_map(const Scene& scene) {
  const PlacedSensor& sensor = scene.sensor();
  constexpr int kSide = 64;  // side of a grid of points over the film, which may have gaps on a shape
  bool measures = false;
  for (int i = 0; i < kSide * kSide && !measures; ++i) {
    const Vec2 u{(float(i % kSide) + 0.5f) / kSide, (float(i / kSide) + 0.5f) / kSide};
    const Vec2 lower = sensor.part.lower, upper = sensor.part.upper;
    measures = sensor.receiver({lower.x + (upper.x - lower.x) * u.x, lower.y + (upper.y - lower.y) * u.y})
                   .has_value();
  }
  if (!measures)
    throw Error(sensor.properties().where(), "a sensor of type \"" + sensor.properties().type() +
                                                 "\" measures no power at points: \"powermap\" does");
  const Film& film = sensor.film();
  const std::vector<std::string> names = film.channel_names();
  if (std::none_of(names.begin(), names.end(), is_bin))
    for (const SampledSpectrum& response : channel_responses(film, scene.wavelengths().grid()))
      if (response.minimum() < 0)
        throw Error(film.properties().where(),
                    "its channels are colours and no bands of wavelengths: use an hdrfilm with \"response\" "
                    "uniform, or a specfilm");
  (void)bands(scene);
}

std::vector<PowerMap> power_maps(const Scene& scene, const Image& picture, std::optional<double> power_w,
                                 int free_samples) {
  const PlacedSensor& sensor = scene.sensor();
  const Film& film = sensor.film();
  require_power_map(scene);
  const std::vector<double> measured = free_space(scene, free_samples);
  const std::size_t cells = std::size_t(picture.width) * std::size_t(picture.height);
  const std::size_t channels = std::size_t(film.measured_channels());
  const std::vector<std::string> names = film.channel_names();

  std::vector<PowerMap> maps;
  for (const Band& band : bands(scene)) {
    PowerMap& map = maps.emplace_back();
    map.channel = names[band.channel];
    map.width = picture.width, map.height = picture.height;
    map.min_nm = band.min_nm, map.max_nm = band.max_nm, map.wavelength_m = band.mean_nm * 1e-9;
    map.power_w = power_w.value_or(band.power);
    const double unit_m = sensor.properties().context().length_unit_m;
    // factor to W/m^2: areas of the scene are in its unit of length squared
    const double scale = map.power_w / (band.seen * unit_m * unit_m);
    const int value = picture.channel(map.channel), variance = picture.channel("variance." + map.channel);
    std::vector<float> developed(names.size());
    for (std::size_t i = 0; i < cells; ++i) {
      const int x = int(i) % picture.width, y = int(i) / picture.width;
      map.density.push_back(scale * picture.at(x, y, std::size_t(value)));
      if (variance >= 0)
        map.error.push_back(scale * std::sqrt(double(picture.at(x, y, std::size_t(variance)))));
      film.develop(&measured[i * channels], 0, developed.data());
      map.free.push_back(scale * developed[band.channel]);
    }
  }
  return maps;
}

double parse_power_w(const std::string& text) {
  struct Unit {
    const char* name;
    double watts;
  };
  constexpr Unit kUnits[] = {{"mW", 1e-3}, {"kW", 1e3}, {"W", 1}, {"", 1}};
  double watts = 0;
  try {
    if (text.ends_with("dBm")) {
      watts = 1e-3 * std::pow(10, parse_number(text.substr(0, text.size() - 3)) / 10);
    } else {
      for (const auto& [name, factor] : kUnits)
        if (text.ends_with(name)) {
          watts = factor * parse_number(text.substr(0, text.size() - std::string(name).size()));
          break;
        }
    }
  } catch (const Error&) {  // another unit, or no number
    watts = 0;
  }
  if (!(watts > 0 && std::isfinite(watts)))
    throw Error("\"" + text + "\" is no positive power: write \"2\", \"2W\", \"500mW\" or \"33dBm\"");
  return watts;
}

}  // namespace aureole
