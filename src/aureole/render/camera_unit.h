// SPDX-License-Identifier: Apache-2.0
// Work units of paths from the sensor. A sample belongs to a pixel, and the reconstruction filter gives it to
// those around, too.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "aureole/integrator/integrator.h"
#include "aureole/render/sample_density.h"
#include "aureole/render/state.h"

namespace aureole {

/// What the paths of one unit leave on the film. Buffers are kept between units.
struct CameraUnit {
  int replicate = 0;
  int x0 = 0, y0 = 0, width = 0, height = 0;  ///< the pixels reached, relative to the crop's corner
  std::vector<float> sums;                    ///< as FilmBuffer::add takes them
  std::vector<InvalidSample> invalid;         ///< relative to the crop's corner
};

/// The first kPilotSamples of each pixel of replicate 0.
struct Pilot {
  std::vector<PixelNoise> noise;  ///< of all pixels with those of the border, row by row
  /// Their numbers, so that they need not be traced again; empty where they would need too much memory.
  std::vector<float> samples;
};

class CameraRenderer {
public:
  /// `measured_channels` are those of the film and then those of the integrator.
  CameraRenderer(const Scene& scene, const RadianceIntegrator& integrator, const FilterTable& filter,
                 std::uint64_t seed, int measured_channels);

  /// Traces the paths of a unit of `layout`, but for those of `pilot`, which may be null: the numbers are the
  /// same bit for bit.
  void trace(const RenderState& layout, std::int64_t unit, const Pilot* pilot, CameraUnit& result) const;
  /// Room for the pilot of all pixels.
  Pilot make_pilot(const RenderState& layout) const;
  /// Bytes of that room for a picture whose samples start at `begin`.
  static double pilot_bytes(double pixels, int measured_channels, std::int64_t begin);
  /// Traces the pilot of the pixels of a tile.
  void trace_pilot(const RenderState& layout, std::int64_t tile, Pilot& pilot) const;
  /// Traces one path and logs its vertices; returns its measured channels, nothing where one is invalid.
  /// Pixel coordinates are relative to the crop's corner.
  std::optional<std::vector<float>> replay(int x, int y, std::int64_t sample, int replicate,
                                           const PathLog& log) const;

private:
  /// Which sample of which pixel, relative to the crop's corner.
  struct SampleId {
    int x, y;
    std::int64_t index;
    float weight;  ///< on the film, beside the filter's
  };
  struct Sample {
    SampleId id;
    Vec2 position;  ///< relative to the crop's corner
    float alpha;
    bool valid;
  };
  class Batch;

  std::uint64_t key_of(int x, int y, int replicate) const;
  /// Fills the path and the sample's position; returns the sensor's weight of the radiance.
  float begin(std::uint64_t key, CameraPath& path, Sample& sample) const;
  /// `measured` receives the numbers of the film; those of the integrator are there already. Fills the rest
  /// of sample.
  void measure(const CameraPath& path, float sensor_weight, Sample& sample, float* measured) const;
  /// Numbers of the pilot that are kept.
  static double kept_numbers(double pixels, int measured_channels, std::int64_t begin);
  /// Numbers of a sample of the pilot.
  static size_t record_size(int measured_channels) { return size_t(measured_channels) + 4; }
  /// Those of a pixel's first sample.
  size_t pilot_record(const RenderState& layout, int x, int y) const;

  const Scene* scene_;
  const RadianceIntegrator* integrator_;
  FilterTable filter_;
  std::uint64_t seed_;
  int channels_;
};

}  // namespace aureole
