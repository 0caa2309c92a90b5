// SPDX-License-Identifier: Apache-2.0
// Writes a job's pictures: EXR with metadata in the header, and a PNG for display.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "aureole/core/channel_meanings.h"
#include "aureole/render/state.h"
#include "aureole/render/tone.h"

namespace aureole {

/// Throws Error if a file of this name cannot hold the picture. EXR holds everything; .hdr (or .rgbe) and
/// .pfm hold R, G, B or Y.
void require_format(const Development& development, int replicates, const std::filesystem::path& file);

/// Writes `file` and a PNG of the same name beside it. EXR headers contain scene, hash, seed, samples,
/// version and wall time; the extension selects HDR or PFM. The PNG is tone-mapped by `tone`, or by
/// `display_picture` without one.
void write_pictures(const RenderState& state, const std::filesystem::path& file,
                    const std::optional<Tone>& tone = {});

/// Returns the header of a picture: scene, seed, samples, version, wall time and what its channels hold.
ExrAttributes picture_attributes(const RenderState& state);

/// Writes `picture`, which was developed from `state`, with the state's metadata and without a PNG.
void write_picture(const RenderState& state, const Image& picture, const std::filesystem::path& file);

/// Writes only the PNG.
void write_preview(const RenderState& state, const std::filesystem::path& exr_file,
                   const std::optional<Tone>& tone = {});

}  // namespace aureole
