// SPDX-License-Identifier: Apache-2.0
// The state of a job: fixed-point films and the list of units done. Checkpoints, separately rendered parts of
// a picture and merged pictures all have this form, in memory and in files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/render/film_buffer.h"
#include "aureole/render/unit_ranges.h"

namespace aureole {

inline constexpr int kTileSize = 16;     ///< side of a tile [pixels]
inline constexpr int kSampleBlock = 16;  ///< samples of a work unit; a block begins at a multiple of it

/// Identifies the picture of a state. Two states can be merged or resumed only if all of this agrees.
struct PictureIdentity {
  std::string scene, version, sampler, integrator;
  std::string adaptive = "none";
  std::uint64_t scene_hash = 0, seed = 0;
  int random_version = 0;  ///< version of the random numbers: kRandomVersion of transport/dimensions.h
  int wavelengths = 0;
  int width = 0, height = 0, border = 0, measured_channels = 0, replicates = 1;
  /// Number of channels of splats that have a film apart from the pixels' own samples; 0 without splats.
  int splat_channels = 0;

  /// Describes the first difference, or returns an empty string.
  std::string difference(const PictureIdentity& other) const;
};

/// The linear map from measured values to the channels of a picture, stored in state files.
struct Development {
  std::vector<std::string> names;     ///< channels, with "A" last if alpha is stored
  std::vector<std::string> meanings;  ///< per channel: the quantity in words; empty in states of old versions
  std::vector<std::vector<float>> rows;      ///< per channel: factors of the measured channels
  std::vector<std::vector<float>> rgb_rows;  ///< linear sRGB for previews
  bool half = true;
};

/// An invalid radiance estimate of one sample, with its index in its pixel, for --pixel to replay.
struct InvalidSample {
  int x, y, replicate;
  std::int64_t sample;
};

/// A tile of pixels, relative to the crop's corner, times a block of samples.
struct WorkUnit {
  int replicate, x0, y0, x1, y1;
  std::int64_t first, last;
  std::int64_t samples() const { return std::int64_t(x1 - x0) * (y1 - y0) * (last - first); }
};

class RenderState {
public:
  RenderState() = default;
  RenderState(PictureIdentity identity, Development development, std::int64_t begin, std::int64_t end);

  PictureIdentity identity;
  Development development;
  std::int64_t begin = 0, end = 0;  ///< requested samples; `begin` is a multiple of kSampleBlock
  std::vector<FilmBuffer> films;    ///< sums of the film, one per replicate
  /// Splats of paths whose own radiance belongs to their pixels, one film per replicate. Splats add to the
  /// first channels of `films`, but are divided by the number of paths.
  std::vector<FilmBuffer> splats;
  UnitRanges done;  ///< the units whose samples are in the films
  /// For adaptive sampling: log2 of each pixel's samples per sample of the picture, row by row, border
  /// included. Empty if all pixels have equally many samples, and until the pilot is done.
  std::vector<std::int8_t> density;
  std::uint64_t invalid_samples = 0;
  double seconds = 0;  ///< wall time spent
  /// errors of the integrator's approximations in words (`Integrator::approximation_errors`)
  std::vector<std::string> approximations;

  /// Width of the sampled area [pixels], border included.
  int sampled_width() const { return identity.width + 2 * identity.border; }
  int sampled_height() const { return identity.height + 2 * identity.border; }
  int tiles_x() const { return (sampled_width() + kTileSize - 1) / kTileSize; }
  int tiles_y() const { return (sampled_height() + kTileSize - 1) / kTileSize; }
  std::int64_t tiles() const { return std::int64_t(tiles_x()) * tiles_y(); }
  std::int64_t blocks() const { return (end - begin + kSampleBlock - 1) / kSampleBlock; }
  std::int64_t units_per_block() const { return tiles() * identity.replicates; }
  std::int64_t units() const { return blocks() * units_per_block(); }
  std::int64_t units_done() const;
  /// The film that holds the splats of a replicate, with or without other light.
  FilmBuffer& splat_film(std::size_t replicate) { return (splats.empty() ? films : splats)[replicate]; }
  /// Means of the measured channels, and of alpha, of one pixel.
  void mean(std::size_t replicate, int x, int y, double* measured, double* alpha) const;
  std::size_t sampled_pixels() const { return std::size_t(sampled_width()) * std::size_t(sampled_height()); }
  /// Index of a sampled pixel, row by row.
  std::size_t pixel_index(int x, int y) const {
    return std::size_t(y + identity.border) * std::size_t(sampled_width()) + std::size_t(x + identity.border);
  }
  int density_exponent(int x, int y) const { return density.empty() ? 0 : density[pixel_index(x, y)]; }
  /// Units are ordered by sample block, then replicate, then tile, so that early pictures are complete.
  WorkUnit unit(std::int64_t index) const;
  /// Number of samples that every pixel has, before scaling by its density if adaptive; blocks partly done do
  /// not count.
  std::int64_t samples_everywhere() const;

  /// Changes the requested samples and keeps the units done. Throws Error if a finished block was cut short
  /// at the old end.
  void set_range(std::int64_t new_begin, std::int64_t new_end);

  /// Adds the units of another state. Throws Error for another picture, overlapping units, or a cut block
  /// that would leave a gap.
  void merge(const RenderState& other);

  void save(const std::filesystem::path& file) const;  ///< Writes the state to a file atomically.
  /// Reads a state file. Throws Error where it is missing, truncated or corrupt.
  static RenderState load(const std::filesystem::path& file);

  /// The content of a state file.
  std::vector<char> to_bytes() const;
  /// Throws Error located at `where` for content that is truncated or corrupt.
  static RenderState from_bytes(std::span<const char> bytes, const SourceLocation& where);

  /// Returns the mean over replicates and, with two replicates or more, the variance of that mean
  /// ("variance.R", ...).
  Image picture() const;
  /// Returns the mean in linear sRGB, for any number of film channels.
  Image rgb_picture() const;
};

/// Linear sRGB encoded for display; highlights above 0.8 are compressed, nothing else is changed.
Image display_picture(Image rgb);

/// Returns the memory of a state in bytes.
double state_bytes(int width, int height, int measured_channels, int replicates);
double state_bytes(const PictureIdentity& identity);

}  // namespace aureole
