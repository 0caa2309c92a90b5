// SPDX-License-Identifier: Apache-2.0
// The film of splats: contributions of light paths at arbitrary film positions. Every (pixel, sample) starts
// one path, whose splats may lie anywhere on the film. The value of pixel k with the reconstruction filter
// h_k,
//     I_k = integral(h_k L) / integral(h_k)
// over the film's sample area, is estimated by the sum over paths of h_k x splat, divided by (paths x
// integral(h_k)). This is the expected value of the sensor's own samples at pixel k, also at the borders.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "aureole/integrator/integrator.h"
#include "aureole/render/state.h"

namespace aureole {

/// Splats to be added to the film. Buffers are reused between units.
struct SplatList {
  std::vector<int> paths;       ///< index of each splat's path in its batch
  std::vector<Vec2> positions;  ///< position of each splat relative to the crop's corner [pixels]
  std::vector<float> measured;  ///< the film's channels of each splat
  std::vector<std::uint32_t> band_begin, in_band;  ///< indices of the splats that reach each band of rows

  void clear() { paths.clear(), positions.clear(), measured.clear(); }
};

class SplatFilm {
public:
  /// With `may_be_negative`, negative estimates are valid if they are finite.
  explicit SplatFilm(const Film& film, const FilterTable& filter, bool may_be_negative = false);

  /// Factor that turns the radiance along a ray of the sensor into a splat at the ray's film position.
  float sample_area() const { return sample_area_; }
  /// Measures the splats of a batch. All splats of a path are dropped if the path is not `valid` or if one of
  /// its splats is invalid; `valid` is then set to false.
  void append(std::span<const Splat> splats, std::span<const Path> paths, bool* valid, SplatList& list) const;
  /// Sorts the splats into bands of rows; required before `add`.
  void sort_into_bands(SplatList& list) const;
  /// Adds all splats to a film in fixed point, so that order does not matter. Several threads may call it at
  /// once, but not while others read the film.
  void add(const SplatList& list, FilmBuffer& film) const;
  /// Sets the weights of the films that hold splats, and alpha 1, according to the units done.
  void set_weights(RenderState& state) const;

private:
  const Film* film_;
  FilterTable filter_;
  bool may_be_negative_;
  FilmPart area_;      ///< the part of the film on which splats are counted
  float sample_area_;  ///< [pixels^2]: number of paths per sample index
  int band_height_;
  std::unique_ptr<std::mutex[]> band_locks_;  ///< one per band of rows, so that threads add concurrently
  std::vector<float> weights_x_, weights_y_;  ///< integrals of the filter of each column and row
};

}  // namespace aureole
