// SPDX-License-Identifier: Apache-2.0
// What a gallery has made so far (results.json) and the page that shows it.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gallery_file.h"
#include "gallery_plots.h"

namespace aureole {

struct PictureResult {
  std::string key;
  GallerySize size = kPreviewSize;
  std::int64_t samples = 0;
  double seconds = 0, load_seconds = 0;
  std::optional<double> relative_rmse;  ///< to the reference of its table
};

struct PlotRecord {
  std::string key;
  GallerySize size = kPreviewSize;
  double seconds = 0;
  PlotResult plot;
};

/// By names. What is missing here is not done.
struct GalleryResults {
  std::map<std::string, PictureResult> pictures;
  std::map<std::string, PlotRecord> plots;

  /// Nothing where there is no such file or it is of another version: then all is made again.
  static GalleryResults load(const std::filesystem::path& file);
  void save(const std::filesystem::path& file) const;
};

/// The whole page, one string without references to anything but the files beside it. `command` is how it was
/// made.
std::string gallery_page(const Gallery& gallery, const GalleryResults& results, const std::string& command);

}  // namespace aureole
