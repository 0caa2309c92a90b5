// SPDX-License-Identifier: Apache-2.0
// Writes a job's pictures: EXR with metadata in the header, and a PNG for display.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

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

/// Writes `picture`, which was developed from `state`, with the state's metadata and without a PNG.
void write_picture(const RenderState& state, const Image& picture, const std::filesystem::path& file);

/// The string attribute of an EXR header that says what its channels hold: a line "name: meaning" for each.
inline constexpr const char* kChannelsAttribute = "aureole:channels";
std::string channels_attribute(const std::vector<std::string>& names,
                               const std::vector<std::string>& meanings);
/// Returns the meaning of a channel from that attribute; empty if it has none.
std::string channel_meaning(const std::string& attribute, const std::string& channel);

/// Writes only the PNG.
void write_preview(const RenderState& state, const std::filesystem::path& exr_file,
                   const std::optional<Tone>& tone = {});

}  // namespace aureole
