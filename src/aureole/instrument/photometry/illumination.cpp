// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/photometry/illumination.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/scene/scene.h"

namespace aureole {

namespace {

double mean_of_cells(const PhotometricMap& map, const MapRegion& r) {
  double sum = 0;
  for (int y = r.y; y < r.y + r.height; ++y)
    for (int x = r.x; x < r.x + r.width; ++x) sum += map.at(x, y);
  return sum / (double(r.width) * r.height);
}

PhotometricMap relative_luminance(const Image& colors) {
  PhotometricMap map{colors.width, colors.height, {}, "relative luminance", "1"};
  for (int y = 0; y < colors.height; ++y)
    for (int x = 0; x < colors.width; ++x)
      map.values.push_back(colors.channel_count() == 3
                               ? 0.2126 * double(colors.at(x, y, 0)) + 0.7152 * double(colors.at(x, y, 1)) +
                                     0.0722 * double(colors.at(x, y, 2))
                               : double(colors.at(x, y, 0)));
  return map;
}

}  // namespace

LoadOptions illumination_options(LoadOptions load, bool is_local) {
  load.integrator = is_local ? "direct" : "path";
  return load;
}

bool measures_on_receivers(const Scene& scene) {
  const PlacedSensor& sensor = scene.sensor();
  return sensor.receiver(0.5f * (sensor.part.lower + sensor.part.upper)).has_value();
}

LoadOptions receiver_options(LoadOptions load) {
  load.integrator = "path";
  load.integrator_parameters = {{"integer", "max_depth", "1"}};
  return load;
}

double RunStatistics::error() const {
  return runs > 1 ? std::sqrt(std::max(0.0, squares / runs - mean() * mean()) / (runs - 1)) : 0;
}

IlluminationRuns::IlluminationRuns(std::string name, std::string meanings, int width, int height,
                                   std::vector<MapRegion> regions)
    : name_(std::move(name)), meanings_(std::move(meanings)), regions_(std::move(regions)) {
  is_absolute_ = has_photometric_unit(meanings_);
  if (regions_.empty()) regions_.push_back({0, 0, width, height});
  for (const MapRegion& r : regions_)
    if (r.x < 0 || r.y < 0 || r.width < 1 || r.height < 1 || r.x > width - r.width || r.y > height - r.height)
      throw Error(fmt::format("--region {},{},{},{}: leaves the picture of {} x {} pixels", r.x, r.y, r.width,
                              r.height, width, height));
  statistics_.resize(regions_.size());
}

void IlluminationRuns::add(const Image& picture, const Image& colors) {
  const PhotometricMap map =
      is_absolute_ ? photometric_map(picture, meanings_, name_) : relative_luminance(colors);
  for (std::size_t i = 0; i < regions_.size(); ++i) statistics_[i].add(mean_of_cells(map, regions_[i]));
  if (runs_++ == 0) {
    map_ = map, colors_ = colors;
    return;
  }
  if (map.values.size() != map_.values.size() || colors.pixels.size() != colors_.pixels.size())
    throw Error(name_ + ": the pictures of the runs differ in their sizes");
  for (std::size_t i = 0; i < map.values.size(); ++i) map_.values[i] += map.values[i];
  for (std::size_t i = 0; i < colors.pixels.size(); ++i) colors_.pixels[i] += colors.pixels[i];
}

PhotometricMap IlluminationRuns::map() const {
  PhotometricMap mean = map_;
  for (double& v : mean.values) v /= runs_;
  return mean;
}

Image IlluminationRuns::colors() const {
  Image mean = colors_;
  for (float& v : mean.pixels) v /= float(runs_);
  return mean;
}

PhotometricMap repeated_share(const PhotometricMap& local, const PhotometricMap& global) {
  PhotometricMap share = global;
  share.quantity = "light scattered more than once", share.unit = "%";
  for (std::size_t i = 0; i < share.values.size(); ++i)
    share.values[i] = share.values[i] > 0 ? 100 * (1 - local.values[i] / share.values[i]) : 0;
  return share;
}

}  // namespace aureole
