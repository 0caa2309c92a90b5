// SPDX-License-Identifier: Apache-2.0
// Raw pictures of image sensors: the digital numbers of a mosaic of colour filters.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace aureole {

struct RawImage {
  int width = 0, height = 0;
  std::vector<std::uint16_t> values;  ///< row by row from the top
  double black_level = 0;
  int white_level = 65535;  ///< digital number at which pixels are saturated
  /// The cell of colour filters that repeats (0 red, 1 green, 2 blue), row by row; one filter: a sensor without colours.
  int mosaic_width = 1, mosaic_height = 1;
  std::vector<std::uint8_t> mosaic{0};
  /// For colours: rows of the matrix from CIE 1931 XYZ under D65 to the sensor's R, G, B, and the sensor's R, G, B of a
  /// neutral surface in the light of the picture, the largest being 1.
  std::array<double, 9> color_matrix{1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<double, 3> neutral{1, 1, 1};
  std::string model = "aureole";  ///< name of the camera
  double exposure = 0;            ///< [s]; 0: not stated
  double f_number = 0;            ///< 0: not stated
};

/// Writes a TIFF of 16 bits with the digital numbers as they are, in one channel. The write is atomic. Throws Error.
void write_raw_tiff(const std::filesystem::path& file, const RawImage& raw);

/// Writes a DNG (Adobe, "Digital Negative specification", version 1.4), uncompressed. The write is atomic. Throws Error.
void write_dng(const std::filesystem::path& file, const RawImage& raw);

}  // namespace aureole
