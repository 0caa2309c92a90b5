// SPDX-License-Identifier: Apache-2.0
// One field of view of a microscope: grey values, the pixel size, and a mask of usable pixels.
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
  std::vector<std::uint8_t> seen;  ///< 1 for usable pixels; empty if all are usable
  double pixel_m = 0;
  std::vector<std::string> notes;  ///< how the file was understood
};

struct MicrographOptions {
  double pixel_m = 0;          ///< pixel size [m]; 0: from the file's metadata
  bool srgb = false;           ///< values are sRGB-encoded; otherwise they are proportional to the light
  std::filesystem::path mask;  ///< picture whose black pixels are excluded; empty: none
  std::vector<std::array<int, 4>> exclude;  ///< excluded rectangles: x, y, width, height in pixels
};

/// Smallest allowed side of a field [pixels].
inline constexpr int kSmallestField = 32;

/// Reads a micrograph. Throws Error located in the file.
Micrograph read_micrograph(const std::filesystem::path& file, const MicrographOptions& options);

/// Returns the pixel size in metres from a TIFF's metadata: OME's PhysicalSizeX, ImageJ's unit with
/// XResolution, or XResolution per inch or centimetre. Returns 0 if there is none, or if the resolution is a
/// printer's or a screen's (pixels above 20 um). Throws Error if pixels are not square or the metadata
/// contradicts itself.
double pixel_size_m(const ExrAttributes& attributes);

}  // namespace aureole
