// SPDX-License-Identifier: Apache-2.0
// Light that falls anywhere on the film. Every (pixel, sample) owns one path, whose light may fall anywhere
// on the film:
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

/// Splats that are to be added to the film. Buffers are kept between units.
struct SplatList {
  std::vector<int> paths;                          ///< of their batch
  std::vector<Vec2> positions;                     ///< relative to the crop's corner
  std::vector<float> measured;                     ///< the film's channels of each
  std::vector<std::uint32_t> band_begin, in_band;  ///< splats that reach each band of rows

  void clear() { paths.clear(), positions.clear(), measured.clear(); }
};

class SplatFilm {
public:
  /// `may_be_negative`: estimates are valid as long as they are finite.
  explicit SplatFilm(const Film& film, const FilterTable& filter, bool may_be_negative = false);

  /// Factor that turns the radiance along a ray of the sensor into a splat at the ray's film position.
  float sample_area() const { return sample_area_; }
  /// Measures the splats of a batch. Those of a path that is not `valid`, or that has a splat which is not,
  /// are left out; `valid` is set accordingly.
  void append(std::span<const Splat> splats, std::span<const Path> paths, bool* valid, SplatList& list) const;
  /// To be called before `add`.
  void sort_into_bands(SplatList& list) const;
  /// Adds all to a film, each number as fixed point: order does not matter. May be called from several
  /// threads at once, but not while others read the film.
  void add(const SplatList& list, FilmBuffer& film) const;
  /// Sets the weights, and alpha 1, of the films that hold splats to those of the units done.
  void set_weights(RenderState& state) const;

private:
  const Film* film_;
  FilterTable filter_;
  bool may_be_negative_;
  FilmPart area_;      ///< where light counts
  float sample_area_;  ///< pixels^2: paths for each sample number
  int band_height_;
  std::unique_ptr<std::mutex[]> band_locks_;  ///< one per band of rows, so that threads add side by side
  std::vector<float> weights_x_, weights_y_;  ///< integrals of the filter of each column and row
};

}  // namespace aureole
