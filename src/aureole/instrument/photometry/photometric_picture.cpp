// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/photometry/photometric_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "aureole/core/error.h"
#include "aureole/instrument/report/svg_plot.h"
#include "aureole/math/warp.h"
#include "aureole/render/output.h"
#include "aureole/sensor/placed_sensor.h"
#include "aureole/spectrum/photometry.h"

namespace aureole {

namespace {

bool is_photometric_unit(const std::string& unit) {
  static const char* const kUnits[] = {
      "cd/m^2",       "nit",         "kcd/m^2",    "fL",    "lx",      "klx",  "fc",
      "cd",           "kcd",         "W/(m^2 sr)", "W/m^2", "mW/cm^2", "W/sr", "umol/(s m^2 sr)",
      "umol/(s m^2)", "umol/(s sr)", "J/(m^2 sr)", "J/m^2", "J/sr",    "lx s", "cd s/m^2",
      "cd s",         "umol/m^2"};
  return std::find(std::begin(kUnits), std::end(kUnits), unit) != std::end(kUnits) || is_unit_of_flux(unit);
}

}  // namespace

bool has_photometric_unit(const std::string& channels_attribute) {
  std::istringstream lines(channels_attribute);
  for (std::string line; std::getline(lines, line);)
    if (const std::size_t comma = line.rfind(", "); comma != line.npos &&
                                                    is_photometric_unit(line.substr(comma + 2)) &&
                                                    !line.starts_with("X:") && !line.starts_with("Z:"))
      return true;
  return false;
}

PhotometricMap photometric_map(const Image& picture, const std::string& channels_attribute,
                               const std::string& name) {
  for (std::size_t c = 0; c < picture.channels.size(); ++c) {
    const std::string meaning = channel_meaning(channels_attribute, picture.channels[c]);
    const std::size_t comma = meaning.rfind(", ");
    if (comma == std::string::npos || picture.channels[c] == "R" || picture.channels[c] == "X" ||
        picture.channels[c] == "Z")
      continue;
    const std::string unit = meaning.substr(comma + 2);
    if (!is_photometric_unit(unit)) continue;
    // Text of the header before the unit, as in "CIE 1931 XYZ; Y is luminance, cd/m^2".
    constexpr std::string_view kIs = "; Y is ";
    const std::size_t is = meaning.find(kIs), begin = is == std::string::npos ? 0 : is + kIs.size();
    PhotometricMap map{picture.width, picture.height, {}, meaning.substr(begin, comma - begin), unit};
    for (std::size_t i = c; i < picture.pixels.size(); i += picture.channels.size())
      map.values.push_back(double(picture.pixels[i]));
    return map;
  }
  throw Error(
      name +
      ": no channel has a photometric unit: give the film a \"quantity\", such as luminance for a camera "
      "or illuminance for a power map, with pixel_format luminance or xyz");
}

void require_daylight_map(const std::string& quantity, const std::string& unit) {
  if (unit == "lx" && quantity == "illuminance") return;
  if (unit != "lx") throw Error("--daylight: needs a map of the illuminance in lx, not of the " + quantity);
  throw Error("--daylight: needs the illuminance on a surface, not the " + quantity +
              ": give the film the quantity \"illuminance\", and a \"powermap\" the measure \"irradiance\"");
}

bool is_unit_of_flux(const std::string& unit) {
  static const char* const kUnits[] = {"W", "mW", "kW",   "lm",   "klm", "umol/s",
                                       "J", "mJ", "lm s", "lm h", "umol"};
  return std::find(std::begin(kUnits), std::end(kUnits), unit) != std::end(kUnits);
}

std::array<int, 2> place_on_film(const Film& film, int width, int height) {
  if (width == film.crop_width() && height == film.crop_height()) return {film.crop_x(), film.crop_y()};
  if (width == film.width() && height == film.height()) return {0, 0};
  throw Error(fmt::format("a picture of {} x {} pixels is not that of the film, which has {} x {}", width,
                          height, film.crop_width(), film.crop_height()));
}

std::vector<double> cell_areas(const PlacedSensor& sensor, int width, int height) {
  if (!sensor.cell_areas) return {};
  const int columns = int(sensor.part.width), rows = int(sensor.cell_areas->size()) / columns;
  const auto [x0, y0] = place_on_film(sensor.film(), width, height);
  if (x0 < 0 || y0 < 0 || x0 + width > columns || y0 + height > rows) return {};
  std::vector<double> areas;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      areas.push_back(
          double((*sensor.cell_areas)[std::size_t(y0 + y) * std::size_t(columns) + std::size_t(x0 + x)]));
  return areas;
}

MapStatistics map_statistics(const PhotometricMap& map, const MapRegion& r) {
  if (r.x < 0 || r.y < 0 || r.width < 1 || r.height < 1 || r.x + r.width > map.width ||
      r.y + r.height > map.height)
    throw Error(fmt::format("the region {},{},{},{} leaves the picture of {} x {} cells", r.x, r.y, r.width,
                            r.height, map.width, map.height));
  std::vector<std::pair<double, double>> cells;  // value and weight
  MapStatistics s;
  double weights = 0, weighted = 0;
  for (int y = r.y; y < r.y + r.height; ++y)
    for (int x = r.x; x < r.x + r.width; ++x) {
      const double value = map.at(x, y),
                   weight = map.areas.empty()
                                ? 1
                                : map.areas[std::size_t(y) * std::size_t(map.width) + std::size_t(x)];
      if (!std::isfinite(value) || !(weight > 0)) continue;
      cells.emplace_back(value, weight);
      s.sum += value, weights += weight, weighted += weight * value;
    }
  if (cells.empty()) throw Error("the region has no finite values");
  std::sort(cells.begin(), cells.end());
  s.count = cells.size(), s.mean = weighted / weights;
  s.min = cells.front().first, s.max = cells.back().first;
  double below = 0;
  for (const auto& [value, weight] : cells) {
    s.median = value;
    below += weight;
    if (below > 0.5 * weights) break;
  }
  return s;
}

ColorScale map_scale(const PhotometricMap& map, std::optional<double> min, std::optional<double> max,
                     bool logarithmic, std::vector<double> isolines) {
  std::vector<double> finite;
  for (const double v : map.values)
    if (std::isfinite(v) && (!logarithmic || v > 0)) finite.push_back(v);
  std::sort(finite.begin(), finite.end());
  const auto quantile = [&](double q) {
    return finite.empty() ? 1 : finite[std::size_t(q * double(finite.size() - 1))];
  };
  double high = max.value_or(quantile(0.995)),
         low = min.value_or(logarithmic ? std::max(quantile(0.005), 1e-3 * high) : 0);
  if (!(high > low)) {
    if (max && min)
      throw Error(fmt::format("no colours from {:g} to {:g}: the limits must increase", low, high));
    if (max)
      low = logarithmic ? 0.1 * high : high - std::max(1.0, std::abs(high));
    else
      high = logarithmic ? 10 * low : low + 1;
  }
  if (logarithmic && !(low > 0)) throw Error("the lower limit of a logarithmic scale must be positive");
  ColorScale s{.low = low, .high = high, .is_logarithmic = logarithmic};
  s.title = fmt::format("{}, {}", map.quantity, map.unit);
  for (const double v : isolines.empty() ? scale_labels(s) : isolines)
    if (v > low && v < high) s.contours.push_back(v);
  return s;
}

namespace {

/// The direction and solid angle of each pixel of a camera.
struct PixelView {
  std::vector<Vec3> directions;
  std::vector<double> solid_angles;
};

PixelView pixel_view(const PlacedSensor& camera, int width, int height) {
  PixelView view;
  const auto place = place_on_film(camera.film(), width, height);
  const auto ray = [&](double x, double y) {
    return camera.sample_ray({float(place[0] + x), float(place[1] + y)}, {0.5f, 0.5f}).ray;
  };
  const Vec3 first = ray(0.5, 0.5).d, last = ray(width - 0.5, height - 0.5).d;
  if (!(length_squared(first - last) > 0))
    throw Error("glare needs a camera whose rays have different directions");
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      view.directions.push_back(ray(x + 0.5, y + 0.5).d);
      // Solid angle of the pixel, from the cross product of the changes of direction across it.
      const Vec3 across = ray(x + 0.99, y + 0.5).d - ray(x + 0.01, y + 0.5).d,
                 down = ray(x + 0.5, y + 0.99).d - ray(x + 0.5, y + 0.01).d;
      view.solid_angles.push_back(double(length(cross(across, down))) / (0.98 * 0.98));
    }
  return view;
}

}  // namespace

PictureGlare picture_glare(const PhotometricMap& map, const PlacedSensor& camera, const Vec3& up,
                           double threshold) {
  if (map.unit != "cd/m^2" && map.unit != "nit")
    throw Error("glare needs a picture of the luminance in cd/m^2, not of " + map.quantity);
  const PixelView view = pixel_view(camera, map.width, map.height);
  const Film& film = camera.film();
  const Vec3 sight =
      camera.sample_ray({0.5f * float(film.width()), 0.5f * float(film.height())}, {0.5f, 0.5f}).ray.d;
  const Vec3 across = cross(sight, up);
  if (!(length_squared(across) > 1e-6f)) throw Error("the line of sight is vertical: state another \"up\"");
  const Vec3 right = normalize(across), above = cross(right, sight);

  PictureGlare glare;
  double sum = 0, solid = 0;
  const std::size_t n = map.values.size();
  for (std::size_t i = 0; i < n; ++i)
    if (std::isfinite(map.values[i]) && dot(view.directions[i], sight) > 0)
      sum += map.values[i] * view.solid_angles[i], solid += view.solid_angles[i];
  glare.solid_angle = solid;
  if (!(sum > 0)) throw Error("the picture is dark");
  glare.threshold = threshold > 0 ? threshold : 5 * sum / solid;

  cv::Mat bright(map.height, map.width, CV_8UC1), labels;
  double background = 0, weight = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double cosine = double(dot(view.directions[i], sight));
    const bool is_source = cosine > 0 && map.values[i] >= glare.threshold;
    bright.data[i] = is_source ? 255 : 0;
    if (!is_source && cosine > 0 && std::isfinite(map.values[i]))
      background += map.values[i] * view.solid_angles[i] * cosine, weight += view.solid_angles[i] * cosine;
  }
  glare.background = weight > 0 ? background / weight : 0;
  if (!(glare.background > 0))
    throw Error("the background of the sources of glare is black: the rating is not defined");
  const int count = cv::connectedComponents(bright, labels, 8, CV_32S);
  struct Sums {
    double solid = 0, light = 0, square = 0, x = 0, y = 0;
    Vec3 direction;
    std::size_t pixels = 0;
  };
  std::vector<Sums> sums(std::size_t(std::max(count, 1)));
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const int label = labels.at<int>(y, x);
      if (label == 0) continue;
      const std::size_t i = std::size_t(y) * std::size_t(map.width) + std::size_t(x);
      Sums& s = sums[std::size_t(label)];
      const double part = map.values[i] * view.solid_angles[i];
      s.solid += view.solid_angles[i], s.light += part, s.x += x * part, s.y += y * part;
      s.direction = s.direction + view.directions[i] * float(part);
      ++s.pixels;
    }
  std::vector<optics::GlareSource> sources;
  for (std::size_t k = 1; k < sums.size(); ++k) {
    const Sums& s = sums[k];
    const Vec3 d = normalize(s.direction);
    PictureGlareSource g;
    g.source.luminance = s.light / s.solid, g.source.solid_angle = s.solid;
    const double elevation = std::asin(std::clamp(double(dot(d, above)), -1.0, 1.0));
    g.source.position =
        optics::position_index(elevation, std::atan2(double(dot(d, right)), double(dot(d, sight))));
    g.x = s.x / s.light, g.y = s.y / s.light, g.pixels = s.pixels;
    if (s.solid < optics::kSmallestGlareSource || s.solid > optics::kLargestGlareSource) ++glare.outside;
    sources.push_back(g.source);
    glare.sources.push_back(g);
  }
  glare.rating = optics::unified_glare_rating(glare.background, sources);
  const auto contribution = [](const PictureGlareSource& g) {
    return g.source.luminance * g.source.luminance * g.source.solid_angle /
           (g.source.position * g.source.position);
  };
  std::sort(glare.sources.begin(), glare.sources.end(),
            [&](const auto& a, const auto& b) { return contribution(a) > contribution(b); });
  return glare;
}

namespace {

/// The irradiance of a plane with the normal `up` by a light at infinity. Half of the directions are sampled by the light, which
/// finds the sun in a sky or in a picture of one, the others by the cosine; the balance heuristic combines them
/// (E. Veach and L. J. Guibas, Optimally combining sampling techniques for Monte Carlo rendering, 1995).
Spectrum irradiance_from_infinity(const Light& light, const Vec3& up, const Wavelengths& w) {
  if (light.is_delta()) {
    const auto s = light.sample_direct(light.scene_center, 0, {0.5f, 0.5f}, w);
    return s ? s->radiance * std::max(0.f, dot(s->wo, up)) : Spectrum(0.f);
  }
  constexpr int kSide = 192;
  const Frame frame = Frame::from_normal(up);
  std::array<double, kWavelengths> sum{};
  const auto add = [&](const Vec3& d, const Spectrum& radiance) {
    const float cosine = dot(d, up);
    if (!(cosine > 0)) return;
    const double pdf = double(light.pdf_direct_escaped(light.scene_center, up, d)) + double(cosine) / M_PI;
    for (int k = 0; k < kWavelengths; ++k) sum[std::size_t(k)] += double(radiance[k]) * double(cosine) / pdf;
  };
  for (int i = 0; i < kSide * kSide; ++i) {
    const Vec2 u{(float(i % kSide) + 0.5f) / kSide, (float(i / kSide) + 0.5f) / kSide};
    if (const auto s = light.sample_direct_facing(light.scene_center, up, 0, u, w)) add(s->wo, s->radiance);
    const Vec3 d = normalize(frame.to_world(square_to_cosine_hemisphere(u)));
    add(d, light.eval_escaped(d, w));
  }
  return make_spectrum([&](int k) { return float(sum[std::size_t(k)] / (kSide * kSide)); });
}

}  // namespace

double open_illuminance(const Scene& scene, const Vec3& up) {
  const SpectralGrid& grid = scene.wavelengths().grid();
  const SampledSpectrum weight = photopic_efficacy(grid);
  double total = 0;
  const int nodes = grid.cells + 1;
  for (const Light& light : scene.emitters()) {
    if (!light.is_infinite()) continue;
    for (int first = 0; first < nodes; first += kWavelengths) {
      const auto node = [&](int k) { return std::min(first + k, nodes - 1); };
      const Wavelengths w =
          Wavelengths::at(grid, make_spectrum([&](int k) { return float(grid.node(node(k))); }));
      const Spectrum irradiance = irradiance_from_infinity(light, up, w);
      const double step = (grid.max_nm - grid.min_nm) / grid.cells;
      for (int k = 0; k < kWavelengths && first + k < nodes; ++k) {
        const bool is_end = first + k == 0 || first + k == nodes - 1;
        total += double(irradiance[k]) * double(weight.nodes()[std::size_t(first + k)]) * step *
                 (is_end ? 0.5 : 1);
      }
    }
  }
  return total;
}

}  // namespace aureole
