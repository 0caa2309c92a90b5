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

/// Changes with everything that a picture of this size depends on but the tone: version, content of the scene
/// and of its files, defines, samples. Throws ErrorList where the scene cannot be read.
std::string picture_key(const GalleryPicture& picture, GallerySize size);

struct RenderedPicture {
  Image image;
  bool complete = false;  ///< false: stopped
  std::int64_t samples = 0;
  std::uint64_t invalid_samples = 0;
  double seconds = 0, load_seconds = 0;
};

/// Goes on from `state`, which a run that was stopped left there; for the caller to remove once the picture
/// is safe. `report` and `tables` are told how far it is.
RenderedPicture render_picture(const GalleryPicture& picture, GallerySize size, int threads,
                               const std::filesystem::path& state, const std::atomic<bool>& stop,
                               const std::function<void(const Progress&)>& report,
                               const TableProgress& tables);

/// The `aureole render` command that makes the same picture.
std::string render_command(const GalleryPicture& picture, GallerySize size);

}  // namespace aureole
