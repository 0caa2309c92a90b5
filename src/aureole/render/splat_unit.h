// SPDX-License-Identifier: Apache-2.0
// Work units of light tracing. Every (pixel, sample) owns one path, whose light may fall anywhere on the
// film:
//     I_k = integral(h_k L) / integral(h_k)
// over the film's sample area, for the reconstruction filter h_k of pixel k, is the sum over paths of
// h_k x splat over (paths x integral(h_k)). That is the mean of what the sensor's own samples give at pixel
// k, at the borders, too.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "aureole/integrator/integrator.h"
#include "aureole/render/state.h"

namespace aureole {

/// What the paths of one unit leave on the film. Buffers are kept between units.
struct SplatUnit {
  int replicate = 0;
  std::vector<Vec2> positions;         ///< relative to the crop's corner
  std::vector<float> measured;         ///< the film's channels of each
  std::vector<InvalidSample> invalid;  ///< relative to the crop's corner
  std::vector<Splat> path;
  std::vector<std::uint32_t> band_begin, in_band;  ///< splats that reach each band of rows
};

class SplatRenderer {
public:
  SplatRenderer(const Scene& scene, const SplatIntegrator& integrator, const FilterTable& filter,
                std::uint64_t seed);

  /// Traces the paths of a unit of `layout`.
  void trace(const RenderState& layout, std::int64_t unit, SplatUnit& result) const;
  /// Traces the path of one pixel and sample, appends what it leaves. False where a number of it is invalid:
  /// then nothing of it counts. Pixel coordinates are relative to the crop's corner.
  bool trace_path(int x, int y, std::int64_t sample, int replicate, SplatUnit& result,
                  const PathLog& log) const;
  /// Adds a unit to its film, each number as fixed point: order does not matter. May be called from several
  /// threads at once, but not while others read the films.
  void add(const SplatUnit& unit, std::vector<FilmBuffer>& films) const;
  /// Sets the weights, and alpha 1, of the films to those of the units done.
  void set_weights(RenderState& state) const;

private:
  void sort_into_bands(SplatUnit& unit) const;
  void append(Vec2 position, const Spectrum& estimate, const Wavelengths& w, SplatUnit& unit,
              bool& valid) const;

  const Scene* scene_;
  const SplatIntegrator* integrator_;
  FilterTable filter_;
  std::uint64_t seed_;
  FilmPart area_;      ///< where light counts
  float sample_area_;  ///< pixels^2: paths for each sample number
  int band_height_;
  std::unique_ptr<std::mutex[]> band_locks_;  ///< one per band of rows, so that threads add side by side
  std::vector<float> weights_x_, weights_y_;  ///< integrals of the filter of each column and row
};

}  // namespace aureole
