// SPDX-License-Identifier: Apache-2.0
// One field of view of a microscope: grey values, the size of a pixel, and which pixels count.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "aureole/core/image.h"

namespace aureole {

struct Micrograph {
  std::string name;
  int width = 0, height = 0;
  std::vector<float> grey;
  std::vector<std::uint8_t> seen;  ///< 1 where a pixel counts; empty if all do
  double pixel_m = 0;
};

struct MicrographOptions {
  double pixel_m = 0;          ///< 0: from the file's metadata
  bool srgb = false;           ///< values are encoded by the sRGB curve; otherwise proportional to the light
  std::filesystem::path mask;  ///< black pixels are left out; empty: none
  std::vector<std::array<int, 4>> exclude;  ///< rectangles to leave out: x, y, width, height in pixels
};

/// Smallest side of a field, pixels.
inline constexpr int kSmallestField = 32;

/// Throws Error located in the file.
Micrograph read_micrograph(const std::filesystem::path& file, const MicrographOptions& options);

/// Size of a pixel in metres from a TIFF's metadata: OME's PhysicalSizeX, ImageJ's unit with
/// XResolution, or XResolution per inch or centimetre. 0 where there are none, or where the resolution is
/// that of a printer or a screen (pixels above 20 um). Throws Error where pixels are not square or the text
/// contradicts itself.
double pixel_size_m(const ExrAttributes& attributes);

}  // namespace aureole
