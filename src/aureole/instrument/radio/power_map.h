// SPDX-License-Identifier: Apache-2.0
// Maps of received power: converts the picture of a power map (sensor/powermap.cpp) to the units of radio
// engineering.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/scene/scene.h"

namespace aureole {

/// The map of one channel of the film: a band of wavelengths.
struct PowerMap {
  std::string channel;
  int width = 0, height = 0;
  double min_nm = 0, max_nm = 0;  ///< range of the channel's response
  double wavelength_m = 0;        ///< mean over the band, weighted by the response
  double power_w = 0;             ///< power of all emitters in the band
  std::vector<double> density;    ///< power per area [W/m^2], row by row from the top
  std::vector<double> error;      ///< standard error of `density`; empty if the picture has no variances
  std::vector<double> free;       ///< the density in free space, without any objects

  /// Returns 10 lg of the density over the density in free space. It is -infinity without received power. It
  /// is NaN if power arrives only where free space would give none, such as light of beams that came by
  /// reflections.
  std::vector<double> relative_db() const;
  /// Returns 10 lg of the power received by an isotropic antenna of gain 1, whose aperture is lambda^2/(4 pi)
  /// (Friis 1946, "A note on a simple transmission formula"), over 1 mW.
  std::vector<double> received_dbm() const;
  /// Returns the standard error of both maps in dB, 10/ln 10 times the relative error; empty if there is
  /// none.
  std::vector<double> error_db() const;
};

/// Throws Error if the scene's sensor does not measure at points, if its film measures colours, or if no
/// emitter has power in a channel's band.
void require_power_map(const Scene& scene);

/// Returns the maps of a picture of the scene's sensor, one per channel, without the preview of a spectral
/// film. `power_w` is the total power of all emitters in each channel's band, by default the power stated in
/// the scene. `free_samples` is the number of positions per cell at which free space is computed. Throws
/// Error as `require_power_map`.
std::vector<PowerMap> power_maps(const Scene& scene, const Image& picture, std::optional<double> power_w = {},
                                 int free_samples = 16);

/// Parses watts from "2", "2W", "500mW" or "33dBm". Throws Error.
double parse_power_w(const std::string& text);

/// The colour scale of a map and its contour interval.
struct DecibelScale {
  double min_db = 0, max_db = 0, contour_db = 10;
  std::string title;

  /// Returns a scale with round limits that contain all but the lowest and highest 1 % of the values, over at
  /// most 60 dB.
  static DecibelScale of(const std::vector<double>& values, std::string title);

  static constexpr double kWidest = 1000, kNarrowest = 10;  ///< upper and lower bound of max_db - min_db [dB]
  /// Sets the given limits. A limit that is not given keeps a distance from the other one within these
  /// bounds.
  void set_ends(std::optional<double> min, std::optional<double> max);
};

/// Draws a map with a colour bar, its numbers, and contour lines (of the median over 3 x 3 cells): 8-bit
/// sRGB. Cells without power are dark grey. Throws Error unless the scale's limits increase by at most
/// `DecibelScale::kWidest`.
Image decibel_picture(const std::vector<double>& values, int width, int height, const DecibelScale& scale);

}  // namespace aureole
