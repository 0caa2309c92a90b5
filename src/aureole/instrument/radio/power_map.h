// SPDX-License-Identifier: Apache-2.0
// Maps of received power: what the picture of a power map (sensor/powermap.cpp) says in the units of radio.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/scene/scene.h"

namespace aureole {

/// One channel of the film: a band of wavelengths.
struct PowerMap {
  std::string channel;
  int width = 0, height = 0;
  double min_nm = 0, max_nm = 0;  ///< where the channel responds
  double wavelength_m = 0;        ///< mean of the band, by the response
  double power_w = 0;             ///< of all emitters in the band
  std::vector<double> density;    ///< power per area [W/m^2], row by row from the top
  std::vector<double> error;      ///< its standard error; empty where the picture has no variances
  std::vector<double> free;       ///< the density if nothing stood in the way of the emitters' light

  /// 10 lg of the density over that of free space; -infinity where nothing arrives, NaN where something does and nothing
  /// would in free space: light of beams, or from behind, that came by mirrors and walls only.
  std::vector<double> relative_db() const;
  /// 10 lg of the power received by an antenna of gain 1, whose aperture is lambda^2/(4 pi) (Friis 1946, "A note on a
  /// simple transmission formula"), over 1 mW.
  std::vector<double> received_dbm() const;
  /// The standard error of either in dB, 10/ln 10 of the relative one; empty where there is none.
  std::vector<double> error_db() const;
};

/// Throws Error where the scene's sensor measures at no points, its film measures colours, or no emitter shines into a
/// channel's band.
void require_power_map(const Scene& scene);

/// The maps of a picture of the scene's sensor, one per channel. `power_w`: all emitters together radiate this much in
/// each channel's band; by default as much as the scene states. `free_samples`: places per cell at which free space is
/// computed. The preview of a spectral film is left out. Throws Error as `require_power_map`.
std::vector<PowerMap> power_maps(const Scene& scene, const Image& picture, std::optional<double> power_w = {},
                                 int free_samples = 16);

/// Watts from "2", "2W", "500mW" or "33dBm". Throws Error.
double parse_power_w(const std::string& text);

/// The colour scale of a map, and its lines of equal value.
struct DecibelScale {
  double min_db = 0, max_db = 0, contour_db = 10;
  std::string title;

  /// Round limits that hold all but the lowest and highest hundredth of the values, over 60 dB at most.
  static DecibelScale of(const std::vector<double>& values, std::string title);

  static constexpr double kWidest = 1000, kNarrowest = 10;  ///< dB
  /// Moves the ends that are given. One that is not keeps a distance between these two from the other.
  void set_ends(std::optional<double> min, std::optional<double> max);
};

/// A picture of a map with a bar of colours, its numbers, and lines of equal value (of the median over 3 x 3 cells): 8-bit
/// sRGB. Cells without power are dark grey. Throws Error where the scale's ends are no two numbers that rise by
/// `DecibelScale::kWidest` at most.
Image decibel_picture(const std::vector<double>& values, int width, int height, const DecibelScale& scale);

}  // namespace aureole
