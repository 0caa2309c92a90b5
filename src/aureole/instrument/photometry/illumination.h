// SPDX-License-Identifier: Apache-2.0
// Local illumination, by light that was scattered once, beside global illumination, by all light.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/instrument/photometry/photometric_picture.h"
#include "aureole/loading/load.h"

namespace aureole {

/// The options that load a scene for local illumination, by the integrator "direct", or for all of its light, by "path".
LoadOptions illumination_options(LoadOptions load, bool is_local);
/// Whether the sensor is irradiated itself. Paths of one segment then lead from it to the lights, and local illumination is
/// that of `receiver_options`.
bool measures_on_receivers(const Scene& scene);
LoadOptions receiver_options(LoadOptions load);

/// Sum of values of independent runs, for their mean and its standard error.
struct RunStatistics {
  double sum = 0, squares = 0;
  int runs = 0;
  void add(double x) { sum += x, squares += x * x, ++runs; }
  double mean() const { return sum / runs; }
  double error() const;  ///< standard error; 0 for a single run
};

/// Means over runs of one scene with seeds of their own.
class IlluminationRuns {
public:
  /// `meanings` are those of the film's channels (`channels_attribute`), and `name` begins error messages. Without regions
  /// the whole picture is one. Throws Error for a region that leaves the picture.
  IlluminationRuns(std::string name, std::string meanings, int width, int height,
                   std::vector<MapRegion> regions);
  /// Adds the picture of a run, and that in linear sRGB or one channel.
  void add(const Image& picture, const Image& colors);

  PhotometricMap map() const;  ///< in the unit of the film, or the relative luminance
  Image colors() const;        ///< linear
  const std::vector<MapRegion>& regions() const { return regions_; }
  const std::vector<RunStatistics>& statistics() const { return statistics_; }
  int runs() const { return runs_; }

private:
  std::string name_, meanings_;
  bool is_absolute_;
  std::vector<MapRegion> regions_;
  std::vector<RunStatistics> statistics_;
  PhotometricMap map_;
  Image colors_;
  int runs_ = 0;
};

/// The share of light that was scattered more than once, in %, by the maps of both.
PhotometricMap repeated_share(const PhotometricMap& local, const PhotometricMap& global);

}  // namespace aureole
