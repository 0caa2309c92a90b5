// SPDX-License-Identifier: Apache-2.0
// Results of a gallery so far (results.json), and the page that shows them.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gallery/gallery_file.h"
#include "gallery/gallery_plots.h"

namespace aureole {

struct PictureResult {
  std::string key;
  GallerySize size = kPreviewSize;
  std::int64_t samples = 0;
  double seconds = 0, load_seconds = 0;
  std::optional<double> relative_rmse;  ///< relative RMSE against the reference of the picture's table
};

struct PlotRecord {
  std::string key;
  GallerySize size = kPreviewSize;
  double seconds = 0;
  PlotResult plot;
};

/// Results by name; pictures and plots without an entry are not done.
struct GalleryResults {
  std::map<std::string, PictureResult> pictures;
  std::map<std::string, PlotRecord> plots;

  /// Loads the results; empty if the file is missing or of another version, so that everything is rendered
  /// again.
  static GalleryResults load(const std::filesystem::path& file);
  void save(const std::filesystem::path& file) const;
};

/// The whole page as one string, which refers only to files in its folder. `command` is the command line that
/// made it.
std::string gallery_page(const Gallery& gallery, const GalleryResults& results, const std::string& command);

}  // namespace aureole
