// SPDX-License-Identifier: Apache-2.0
// Changes a picture's file format, exposure, size and colours, so that a brighter PNG needs no new rendering.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "aureole/instrument/report/false_color.h"
#include "aureole/render/tone.h"

namespace aureole {

enum class PictureDifference { plain, absolute, relative };

/// Steps of a conversion, taken in this order.
struct ConvertSettings {
  /// The picture that is subtracted; none if empty. `absolute` is |a - b|, `relative` (a - b)/b.
  std::filesystem::path subtrahend;
  PictureDifference difference = PictureDifference::absolute;
  /// A layer ("albedo" for albedo.R, albedo.G, albedo.B) or a channel ("depth.Y"); empty: all channels for an EXR, else the
  /// colours.
  std::string channel;
  /// Rectangle to which the picture is cropped: x, y, width and height in pixels from the upper left corner.
  std::optional<std::array<int, 4>> crop;
  double exposure = 0;  ///< exposure [stops]
  /// Tone mapping of pictures that are written with integers; without one, they are encoded as `aureole
  /// render` does.
  std::optional<Tone> tone;

  /// Whether the luminance, or the single channel, is shown in colours of a map with a scale.
  bool is_false_color = false;
  std::string map = "viridis";
  std::optional<double> low, high;  ///< ends of the scale; by default the extremes of the picture
  bool is_logarithmic = false;
  int contours = 0;  ///< number of contours between the ends of the scale

  /// Bits of a channel: PNG 8 or 16, TIFF 8, 16 (integers) or 32 (linear floats), EXR 16 or 32 (floats); 0: the format's
  /// usual number, 8 for PNG, 16 for TIFF and 32 for EXR.
  int bits = 0;
  int quality = 95;  ///< quality of a JPEG, 1 to 100
};

/// Result of a conversion.
struct Converted {
  int width = 0, height = 0;
  std::vector<std::string> channels;
  std::vector<std::string> notes;
};

/// Reads `file`, which may be EXR, HDR, PFM, PNG, JPEG, TIFF, TGA or BMP, and writes `output`, whose extension tells the
/// format: .exr, .hdr or .rgbe, .pfm, .png, .jpg or .jpeg, .tif or .tiff. Formats with integers hold colours encoded as
/// sRGB; when they are read, they are decoded to linear values. Alpha is multiplied into the colours of floats (as OpenEXR
/// defines) and not into those of integers. Throws Error for pictures that do not fit together, channels that are not
/// there (with the names of those that are), and settings that the format does not have.
Converted convert_picture(const std::filesystem::path& file, const std::filesystem::path& output,
                          const ConvertSettings& settings);

}  // namespace aureole
