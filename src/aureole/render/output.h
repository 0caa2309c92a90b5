// SPDX-License-Identifier: Apache-2.0
// Writing a job's pictures: EXR with its origin in the header, and a PNG to look at.
#pragma once

#include <filesystem>
#include <optional>

#include "aureole/render/state.h"
#include "aureole/render/tone.h"

namespace aureole {

/// Throws Error where a file of this name cannot hold the picture: .exr holds everything, .hdr (or .rgbe) and
/// .pfm hold R, G, B or Y.
void require_format(const Development& development, int replicates, const std::filesystem::path& file);

/// Writes `file` (EXR: scene, hash, seed, samples, version, wall time in the header; HDR or PFM by its
/// extension) and a PNG of the same name beside it, tone-mapped by `tone` or by `display_picture`.
void write_pictures(const RenderState& state, const std::filesystem::path& file,
                    const std::optional<Tone>& tone = {});

/// The same for a picture that was made of the state before, without the PNG.
void write_picture(const RenderState& state, const Image& picture, const std::filesystem::path& file);

/// Only the PNG.
void write_preview(const RenderState& state, const std::filesystem::path& exr_file,
                   const std::optional<Tone>& tone = {});

/// Throws Error if a file of this name could not be written: asked before hours are spent on its content.
void require_writable(const std::filesystem::path& file);

}  // namespace aureole
