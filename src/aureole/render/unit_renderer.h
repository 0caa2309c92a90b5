// SPDX-License-Identifier: Apache-2.0
// Work units: all samples of a tile and a sample block. A sample's own radiance is added to the pixels around
// it by the reconstruction filter; its splats may lie anywhere on the film.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "aureole/integrator/integrator.h"
#include "aureole/render/sample_density.h"
#include "aureole/render/splat_film.h"
#include "aureole/render/state.h"

namespace aureole {

/// Contributions of the paths of one unit to the film. Buffers are reused for the next unit.
struct UnitResult {
  int replicate = 0;
  int x0 = 0, y0 = 0, width = 0, height = 0;  ///< the pixels reached, relative to the crop's corner
  /// The block for FilmBuffer::add, followed by some padding; empty if paths belong to no pixel.
  std::vector<float> sums;
  SplatList splats;
  std::vector<InvalidSample> invalid;  ///< invalid samples; their pixels are relative to the crop's corner
};

/// One sample of a pixel, traced again for inspection.
struct ReplayedSample {
  bool valid = false;           ///< whether no value is NaN, infinite, negative or too large
  std::vector<float> measured;  ///< values for its pixel; empty if paths belong to no pixel
  std::vector<float> splatted;  ///< the film's channels of all its splats, concatenated
};

/// The first kPilotSamples samples of each pixel of replicate 0.
struct Pilot {
  std::vector<PixelNoise> noise;  ///< noise of all pixels, border included, row by row
  /// The sample values, so that they need not be traced again; empty if they would need too much memory.
  std::vector<float> samples;
};

class UnitRenderer {
public:
  /// `measured_channels` is the number of the film's channels plus the integrator's.
  UnitRenderer(const Scene& scene, const Integrator& integrator, const FilterTable& filter,
               std::uint64_t seed, int measured_channels);

  /// Traces the paths of a unit of `layout`, except samples that are stored in `pilot` (which may be null).
  /// The result is the same bit for bit with and without `pilot`.
  void trace(const RenderState& layout, std::int64_t unit, const Pilot* pilot, UnitResult& result) const;
  /// Allocates the pilot of all pixels.
  Pilot make_pilot(const RenderState& layout) const;
  /// Bytes that `make_pilot` allocates for a picture whose samples start at `begin`.
  static double pilot_bytes(double pixels, int measured_channels, std::int64_t begin);
  /// Traces the pilot of the pixels of a tile.
  void trace_pilot(const RenderState& layout, std::int64_t tile, Pilot& pilot) const;
  /// Traces the samples [first, last) of a pixel together, at most kBatch, and logs the events of sample
  /// `logged`. Pixel coordinates are relative to the crop's corner.
  std::vector<ReplayedSample> replay(int x, int y, std::int64_t first, std::int64_t last, int replicate,
                                     const PathLog& log, std::int64_t logged) const;

  /// The film of the splats; null if paths make none.
  const SplatFilm* splat_film() const { return splat_film_ ? &*splat_film_ : nullptr; }

private:
  /// Identifies a sample of a pixel; coordinates are relative to the crop's corner.
  struct SampleId {
    int x, y;
    std::int64_t index;
    float weight;  ///< weight of the sample on the film, besides the filter's
  };
  struct Sample {
    SampleId id;
    Vec2 position;  ///< film position relative to the crop's corner
    float alpha;
    bool valid;
  };
  class Batch;
  class SampleSpread;

  std::uint64_t key_of(int x, int y, int replicate) const;
  /// Writes the film's values to `measured`, which already contains the integrator's values. Returns whether
  /// all are valid.
  bool measure(const Path& path, float sensor_weight, float* measured) const;
  /// Number of floats of the pilot that are kept in memory.
  static double kept_numbers(double pixels, int measured_channels, std::int64_t begin);
  /// Number of floats of one sample of the pilot.
  static size_t record_size(int measured_channels) { return size_t(measured_channels) + 4; }
  /// Index of the record of a pixel's first sample.
  size_t pilot_record(const RenderState& layout, int x, int y) const;

  const Scene* scene_;
  const Integrator* integrator_;
  FilterTable filter_;
  std::uint64_t seed_;
  int channels_;
  bool keeps_pixels_;  ///< whether a path's radiance belongs to its pixel
  std::optional<SplatFilm> splat_film_;
};

}  // namespace aureole
