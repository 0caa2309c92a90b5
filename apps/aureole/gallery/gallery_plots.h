// SPDX-License-Identifier: Apache-2.0
// The plots of galleries: most are computed with `optics`, some from pictures of a scene.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include "gallery/gallery_file.h"

namespace aureole {

/// A file of a plot, in the folder of the page.
struct PlotFile {
  std::string file, caption;
};

struct PlotResult {
  int columns = 1;
  std::vector<PlotFile> files;
};

/// Checks a plot. Throws Error if its kind or its parameters are invalid.
void check_plot(const GalleryPlot& plot);

/// Writes the plot's files, named after it, into `folder`. Returns nothing if interrupted.
std::optional<PlotResult> make_plot(const GalleryPlot& plot, GallerySize size,
                                    const std::filesystem::path& folder, const std::atomic<bool>& stop);

}  // namespace aureole
