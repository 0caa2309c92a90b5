// SPDX-License-Identifier: Apache-2.0
// One function for each format of splats, and their common helpers. They throw Error without a location, or
// located at a line of the file; `read_splat_file` adds the file. They return numbers in the axes of the
// file; rotations need not be unit quaternions, and numbers need not be finite.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "aureole/core/error.h"
#include "aureole/core/mapped_file.h"
#include "aureole/parameter/splat/splat_cloud.h"

namespace aureole::splat_reader {

using Path = std::filesystem::path;

SplatCloud read_ply(const Path& file, const SharedBytes& bytes, const SplatFileOptions& options);
SplatCloud read_splat32(const Path& file, const SharedBytes& bytes, const SplatFileOptions& options);
SplatCloud read_spz(const Path& file, const SharedBytes& bytes, const SplatFileOptions& options);
SplatCloud read_gltf(const Path& file, const SharedBytes& bytes, const SplatFileOptions& options);
SplatCloud read_usda(const Path& file, const SharedBytes& bytes, const SplatFileOptions& options);

/// Reads a number from little-endian bytes.
template <class T>
T load(const std::byte* at) {
  static_assert(std::endian::native == std::endian::little);
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

inline float sigmoid(float x) { return 1 / (1 + std::exp(-x)); }

/// Largest number of splats of a file: their indices and twice their number fit into 32 bits.
inline constexpr std::uint64_t kMaxSplats = std::uint64_t(1) << 30;

}  // namespace aureole::splat_reader
