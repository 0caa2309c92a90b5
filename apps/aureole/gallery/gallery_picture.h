// SPDX-License-Identifier: Apache-2.0
// One picture of a gallery: its inputs, its rendering, and its PNG.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "aureole/core/image.h"
#include "aureole/plugin/table_progress.h"
#include "aureole/render/job.h"
#include "gallery/gallery_file.h"

namespace aureole {

/// Returns a hash of everything on which the picture in this size depends, except the tone: version, content
/// of the scene and of its files, defines, samples. Throws ErrorList if the scene cannot be read.
std::string picture_key(const GalleryPicture& picture, GallerySize size);

struct RenderedPicture {
  Image image;
  bool complete = false;  ///< whether the rendering was completed; false: it was interrupted
  std::int64_t samples = 0;
  std::uint64_t invalid_samples = 0;
  double seconds = 0, load_seconds = 0;
};

/// Renders a picture, continuing from the state file `state` of an interrupted run. The caller removes the
/// file after the picture is written. `report` and `tables` are called with the progress.
RenderedPicture render_picture(const GalleryPicture& picture, GallerySize size, int threads,
                               const std::filesystem::path& state, const std::atomic<bool>& stop,
                               const std::function<void(const Progress&)>& report,
                               const TableProgress& tables);

/// The equivalent `aureole render` command.
std::string render_command(const GalleryPicture& picture, GallerySize size);

}  // namespace aureole
