// SPDX-License-Identifier: Apache-2.0
// Figures of light in its units: what is measured in traced scenes, with what closed forms say.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include "aureole/core/image.h"

namespace aureole {

struct LightCurves {
  std::string svg, caption;
};
struct LightPicture {
  Image picture;  ///< encoded for display
  std::string caption;
};

/// How a figure is rendered.
struct LightEffort {
  int divisor = 1;  ///< of width and height of the film, which the scene takes by $width and $height
  std::int64_t spp = 16;
};

/// A film in its unit in false colours, with means and, where `threshold` [cd/m^2] is positive, its glare (UGR).
LightPicture measured_picture(const std::filesystem::path& scene, const std::vector<double>& isolines,
                              double threshold, const LightEffort& effort, const std::atomic<bool>& stop);
/// One scene by cameras (rows) at exposures [s] (columns): the mosaics of their sensors, averaged over cells of colour filters.
LightPicture exposed_pictures(const std::filesystem::path& scene,
                              const std::vector<std::filesystem::path>& cameras,
                              const std::vector<double>& exposures, const LightEffort& effort,
                              const std::atomic<bool>& stop);
/// A light field by a synthetic aperture at distances of focus, side by side.
LightPicture refocused_pictures(const std::filesystem::path& scene, double diameter,
                                const std::vector<double>& focus, const LightEffort& effort,
                                const std::atomic<bool>& stop);
/// A scene by local illumination, at the left, and by all light, with the share of light that was scattered more than once.
LightPicture local_and_global(const std::filesystem::path& scene, const LightEffort& effort,
                              const std::atomic<bool>& stop);

/// The irradiance of a detector in a beam over its tilt, and that over the cosine.
LightCurves tilted_detector(std::int64_t spp, const std::atomic<bool>& stop);
/// The mean radiance that a detector sees through black tubes towards the zenith of an overcast sky, over their half-angles.
LightCurves baffled_detector(std::int64_t spp, const std::atomic<bool>& stop);
/// Radiance and intensity of a Lambertian disc over the direction.
LightCurves lambertian_disc(std::int64_t spp, const std::atomic<bool>& stop);
/// The fraction that grains cover, over the side of the square in which it is counted, at several places.
LightCurves coverage_by_scale(int grains, std::uint64_t seed);

}  // namespace aureole
