// SPDX-License-Identifier: Apache-2.0
// `Gallery`: the validated figures of a gallery.json; every mistake in the file is an error with its line.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aureole/render/tone.h"

namespace aureole {

using Defines = std::vector<std::pair<std::string, std::string>>;

enum GallerySize { kPreviewSize, kFullSize };
inline const char* name_of(GallerySize size) { return size == kFullSize ? "full" : "preview"; }

/// The effort of a picture: samples per pixel, or seconds.
struct PictureEffort {
  int width = 0, height = 0;
  std::int64_t samples = 0;
  double seconds = 0;  ///< seconds of rendering, which replace `samples` if positive
};

struct GalleryPicture {
  std::string name;  ///< name of the picture's files, without extension
  std::filesystem::path scene;
  Defines defines;
  std::array<PictureEffort, 2> effort;
  Tone tone;
};

struct AxisValue {
  std::string label;
  Defines defines;
};
using Axis = std::vector<AxisValue>;

/// Pictures of one scene in a table with nested axes, the outer one first.
struct PictureTable {
  std::string caption;
  std::vector<Axis> rows, columns;
  std::vector<GalleryPicture> pictures;     ///< pictures row by row
  std::optional<GalleryPicture> reference;  ///< reference of the pictures' errors

  static std::size_t count(const std::vector<Axis>& axes);
};

struct GalleryPlot {
  std::string name, kind, caption;
  std::filesystem::path folder;  ///< of the gallery, in which files of the parameters are
  nlohmann::json parameters;
};

struct GalleryFigure {
  std::string id, title, counterpart, caption, agreement;
  std::string
      missing;  ///< where not empty, a file that the repository does not have: its name, and how to get it
  std::vector<PictureTable> tables;
  std::vector<GalleryPlot> plots;
};

struct Gallery {
  std::string title, introduction;
  std::vector<GalleryFigure> figures;
};

/// Reads `folder`/gallery.json; scenes are in the same folder. Throws Error or ErrorList.
Gallery read_gallery(const std::filesystem::path& folder);

}  // namespace aureole
